"""What targets send back, and what they leave open of the bed behind them."""

from __future__ import annotations

import math

import numpy as np

from insonify.kernels.bins import FIXED_POINT, spread
from insonify.kernels.jit import fused, kernel
from insonify.kernels.pieces import FINE, deposit_piece
from insonify.kernels.scatter import strength
from insonify.kernels.screen import NOBODY, meet_part, next_open
from insonify.kernels.sections import NEVER
from insonify.kernels.types import LIGHT
from insonify.kernels.wedge import weight

MOST_FACETS = 64


@kernel
def deposit_open(surface, x_from, x_to, screen, cells, law, bin_length, bins):
    """Deposit what no body hides of a segment of the bed, between two ground ranges."""
    low, high = launch_angle(surface, x_from), launch_angle(surface, x_to)
    while low < high:
        opened, closed = next_open(screen, cells, surface, low, high)
        if opened >= high:
            return
        start = x_from if opened <= low else range_at(surface, opened)
        stop = x_to if closed >= high else range_at(surface, closed)
        deposit_piece(surface, max(start, x_from), min(stop, x_to), law, bin_length, bins)
        low, x_from = closed, stop


@fused
def launch_angle(surface, x):
    """Launch angle to a segment at ground range x."""
    return math.atan2(surface.offset + surface.slope * x, x)


@fused
def range_at(surface, angle):
    """Ground range at which a launch angle meets a segment's line."""
    return surface.offset / (math.tan(angle) - surface.slope)


@kernel
def deposit_bodies(profile, knots, horizon, problem, wedge, view, screen, cells, bins):
    """Deposit what the nearest body in every cell sends back, less what the bed hides."""
    last, per_bin = bins.size - 2, 1.0 / problem.bin_length
    for cell in range(cells):
        p = screen.part[cell]
        if p == NOBODY:
            continue
        facets, start, step = divide_cell(profile, knots, horizon, problem, view, screen, cell)
        for facet in range(facets):
            low = start + facet * step
            near, centre, far, cos_incidence = meet_facet(problem, view, screen, p, low, low + step)
            if near < NEVER and far < NEVER and centre < NEVER:
                first, second = facet_energies(
                    part_material(problem, screen, p), low, low + step, near, centre, far, cos_incidence, problem, wedge
                )
                spread(bins, near * per_bin, centre * per_bin, first, last)
                spread(bins, centre * per_bin, far * per_bin, second, last)


@fused
def divide_cell(profile, knots, horizon, problem, view, screen, cell):
    """Facets that a cell is divided into, where they begin and how wide each is; none where the bed hides it all.

    A triangle can be long against its range, and then not one density will do.
    """
    start, stop = screen.edge[cell], screen.edge[cell + 1]
    middle = 0.5 * (start + stop)
    ridge = horizon_at(profile, knots, horizon, screen.distance[cell] * math.cos(middle))
    if ridge > -NEVER:
        start = max(start, math.atan(ridge))
    if start >= stop:
        return 0, start, 0.0
    facets = 1
    p = screen.part[cell]
    if screen.body[p] >= problem.solids.shape.size:
        near, _ = meet_part(problem, view, screen, p, start)
        far, _ = meet_part(problem, view, screen, p, stop)
        nearest = min(near, far)
        # Sides and angle between them give the length.
        squared = (far - near) * (far - near) + near * far * (stop - start) * (stop - start)
        if nearest < NEVER and squared > (FINE * nearest) * (FINE * nearest):
            facets = int(min(math.sqrt(squared) / (FINE * nearest) + 1.0, float(MOST_FACETS)))
    return facets, start, (stop - start) / facets


@fused
def meet_facet(problem, view, screen, p, start, stop):
    """Distances to a part at the beginning, the middle and the end of a facet, and the cosine of the incidence."""
    near, _ = meet_part(problem, view, screen, p, start)
    centre, cos_incidence = meet_part(problem, view, screen, p, 0.5 * (start + stop))
    far, _ = meet_part(problem, view, screen, p, stop)
    return near, centre, far, cos_incidence


@fused
def part_material(problem, screen, p):
    """Row of the reflectivity table that a part is made of."""
    body, bodies = screen.body[p], problem.solids.shape.size
    return problem.solids.material[body] if body < bodies else problem.mesh.material[body - bodies]


@fused
def facet_energies(row, start, stop, near, centre, far, cos_incidence, problem, wedge):
    """Energies of a facet, in fixed-point units, on either hand of its middle."""
    diffuse, specular = problem.reflectivity[row, 0], problem.reflectivity[row, 1]
    value = strength(cos_incidence, diffuse, specular, problem.reflectivity[row, 2], problem.law)
    angle = 0.5 * (start + stop)
    x, z = centre * math.cos(angle), centre * math.sin(angle)
    value *= weight(x, z, centre, wedge, problem.pattern, problem.law)
    if problem.law == LIGHT:
        density = value / problem.bin_length * FIXED_POINT
        return density * abs(centre - near), density * abs(far - centre)
    # The strip seen along the ray: width · r dθ, laid out on the surface: / cos of the incidence.
    half = 0.5 * value * centre * (stop - start) / max(cos_incidence, 1e-6) * FIXED_POINT
    return half, half


@fused
def horizon_at(profile, knots, horizon, x):
    """Greatest slope of the bed up to ground range x."""
    if knots == 0 or x < profile.x[0]:
        return -NEVER
    i = np.searchsorted(profile.x[:knots], x, side="right") - 1
    ridge = horizon[i]
    if i + 1 < knots and x > 0.0:
        share = (x - profile.x[i]) / (profile.x[i + 1] - profile.x[i])
        slope = (profile.z[i] + share * (profile.z[i + 1] - profile.z[i])) / x
        if slope > ridge:
            ridge = slope
    return ridge
