"""Walk a profile outward from nadir with one running horizon; put what is heard into the bins it spans.

Each heard piece of a segment spreads its energy evenly over the slant range it covers: a density that steps up where the
piece begins and down where it ends. The steps go into a difference array of integers, one event per knot, and a
prefix sum turns them into bins. Integers cancel exactly, so what no piece touches is exactly zero and the sum is
the same in any order. Spreading and absorption depend on range alone and multiply afterwards.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from insonify.kernels.bins import FIXED_POINT, accumulate, step
from insonify.kernels.jit import kernel
from insonify.kernels.pieces import FINE
from insonify.kernels.scatter import INVERSE_PI, gloss
from insonify.kernels.slice import Profile, slice_bed
from insonify.kernels.solids import Covers, View, deposit_cut, deposit_solids, find_covers, hidden_slopes
from insonify.kernels.types import LIGHT, PORT
from insonify.kernels.wedge import Wedge, beam_share, strip_width

NADIR = -1e30  # slope of a ray straight down
SHORTEST = 1e-9  # m of slant range that a density may be spread over


class Planes(NamedTuple):
    """The planes of a beam, one entry each, mirrored to both sides."""

    azimuth: NDArray[np.float64]  # from athwart towards the bow, rad
    s_low: NDArray[np.float64]
    s_high: NDArray[np.float64]
    angle: NDArray[np.float64]
    stretched_beyond: NDArray[np.float64]
    reach: NDArray[np.float64]  # ground range to which the beam hears anything of the plane, m


class Heard(NamedTuple):
    """Work space of one profile; one entry a knot, or a segment."""

    r: NDArray[np.float64]  # slant range of the knots, m
    slope: NDArray[np.float64]  # tan of the launch angle above the horizontal, knots
    horizon: NDArray[np.float64]  # greatest slope so far, knots
    energy: NDArray[np.float64]  # per bin, fixed-point units, of segments heard whole
    cos_squared: NDArray[np.float64]  # of the incidence, segments
    scale: NDArray[np.float64]  # what turns a scattering strength into energy, segments heard whole
    cut: NDArray[np.bool_]  # segments heard in part, or too long for one density


@kernel
def hear(profile, count, reflectivity, wedge, law, bin_length, hidden_from, hidden_to, heard):
    """Tell which segments of a profile are heard whole, and how loud, and which must be cut first.

    Targets may hide the bed between the slopes ``hidden_from`` and ``hidden_to``; segments that meet them are cut.
    """
    x, z = profile.x, profile.z
    _launch(x, z, count, heard)
    unit = FIXED_POINT * (1.0 if law == LIGHT else bin_length)
    for i in range(count - 1):
        x0, x1, z0, z1, r0, r1 = x[i], x[i + 1], z[i], z[i + 1], heard.r[i], heard.r[i + 1]
        dx = x1 - x0
        offset = (z0 * x1 - z1 * x0) / dx  # height of the segment's line over nadir, negative if it faces the sonar
        middle = 0.5 * (r0 + r1)
        area = 1.0 + profile.gradient_squared[i]
        cos_squared = offset * offset / (middle * middle * area)
        if law == LIGHT:
            scale = unit * beam_share(0.5 * (x0 + x1), middle, wedge)
            scale = math.copysign(scale, r1 - r0)
            energy = math.sqrt(cos_squared) * scale
        else:
            # Area over slant range; a segment that comes nearer outwards has both signs turned.
            scale = unit * math.sqrt(area) * strip_width(0.5 * (x0 + x1), middle, wedge) * dx / (r1 - r0)
            energy = cos_squared * INVERSE_PI * scale
        slope0, slope1, horizon = heard.slope[i], heard.slope[i + 1], heard.horizon[i]
        up = (offset < 0.0) & (slope1 > horizon)
        foot_within = (x0 * dx + z0 * (z1 - z0)) * (x1 * dx + z1 * (z1 - z0)) <= 0.0
        coarse = dx * dx + (z1 - z0) * (z1 - z0) > FINE * FINE * middle * middle
        covered = (slope1 > hidden_from) & (slope0 < hidden_to)
        cut = up & (foot_within | coarse | covered | (horizon > slope0) | (abs(r1 - r0) < SHORTEST))
        whole = up & ~cut
        heard.cut[i] = cut
        heard.cos_squared[i] = cos_squared
        heard.scale[i] = scale if whole else 0.0
        heard.energy[i] = energy * reflectivity[profile.material[i], 0] if whole else 0.0
    _add_gloss(profile, count, reflectivity, law, heard)


@kernel
def _launch(x, z, count, heard):
    """Slant range, launch slope and running horizon at the knots."""
    for i in range(count):
        heard.slope[i] = z[i] / x[i]
        heard.r[i] = math.sqrt(x[i] * x[i] + z[i] * z[i])
    if x[0] <= 0.0:
        heard.slope[0] = NADIR  # straight down, whatever the knot's height
    horizon = NADIR
    for i in range(count):
        # NaN, a hole in the bed, compares false and hides nothing.
        if heard.slope[i] > horizon:
            horizon = heard.slope[i]
        heard.horizon[i] = horizon


@kernel
def _add_gloss(profile, count, reflectivity, law, heard):
    """Add the Phong lobe; it is gone past 45 degrees of incidence, so few segments need it."""
    for i in range(count - 1):
        if heard.cos_squared[i] > 0.5 and heard.scale[i] != 0.0:
            material = reflectivity[profile.material[i]]
            heard.energy[i] += heard.scale[i] * gloss(heard.cos_squared[i], material[1], material[2], law)


@kernel
def deposit(profile, count, reflectivity, wedge, law, bin_length, solids, view, covers, covering, heard, bins):
    """Put the energy of all heard pieces of a profile into the difference array ``bins``.

    Neighbours heard whole share one event at their common knot.
    """
    per_bin = 1.0 / bin_length
    last = bins.size - 2
    before = np.int64(0)
    for i in range(count - 1):
        now = np.int64(heard.energy[i])
        if now != before:
            step(bins, heard.r[i] * per_bin, now - before, last)
            before = now
        if heard.cut[i]:
            deposit_cut(
                profile, i, heard.horizon[i], reflectivity, wedge, law, bin_length, solids, view, covers, covering, bins
            )
    if before != 0:
        step(bins, heard.r[count - 1] * per_bin, -before, last)


@kernel
def sweep_plane(problem, view, wedge, reach, profile, scratch, covers, heard, bins):
    """Slice one plane, hear it, deposit it; return 0, or -1 - k if the sonar is inside body k."""
    covering = find_covers(problem.solids, view, reach, covers)
    if covering < 0:
        return covering
    hidden_from, hidden_to = hidden_slopes(covers, covering)
    count = slice_bed(problem.bed, view.x, view.y, view.z, view.ex, view.ey, reach, profile, scratch)
    if count > 1:
        hear(
            profile, count, problem.reflectivity, wedge, problem.law, problem.bin_length, hidden_from, hidden_to, heard
        )
        deposit(
            profile,
            count,
            problem.reflectivity,
            wedge,
            problem.law,
            problem.bin_length,
            problem.solids,
            view,
            covers,
            covering,
            heard,
            bins,
        )
    if covering > 0:
        deposit_solids(
            profile,
            count,
            heard.horizon,
            problem.reflectivity,
            wedge,
            problem.law,
            problem.bin_length,
            problem.solids,
            view,
            covers,
            covering,
            bins,
        )
    return 0


@kernel
def sweep_pings(problem, poses, planes, capacity, out):
    """Sweep every plane of every ping into ``out`` (pings, 2, bins); return a status and the ping it belongs to."""
    profile = Profile(np.empty(capacity), np.empty(capacity), np.empty(capacity), np.empty(capacity, np.int64))
    scratch = np.empty(capacity)
    heard = Heard(
        np.empty(capacity),
        np.empty(capacity),
        np.empty(capacity),
        np.empty(capacity),
        np.empty(capacity),
        np.empty(capacity),
        np.empty(capacity, np.bool_),
    )
    solids = problem.solids.shape.size
    covers = Covers(np.empty(solids), np.empty(solids), np.empty(solids, np.int64), np.empty(solids, np.bool_))
    bins = np.zeros(problem.bins + 2, np.int64)
    for ping in range(poses.x.size):
        ahead_x, ahead_y = on_grid(math.cos(poses.heading[ping])), on_grid(math.sin(poses.heading[ping]))
        for side in range(2):
            abeam = 1.0 if side == PORT else -1.0
            for plane in range(planes.azimuth.size):
                c, s = math.cos(planes.azimuth[plane]), math.sin(planes.azimuth[plane])
                # Abeam, turned towards the bow by the plane's azimuth.
                view = View(
                    poses.x[ping],
                    poses.y[ping],
                    poses.z[ping],
                    ahead_x * s - abeam * ahead_y * c,
                    ahead_y * s + abeam * ahead_x * c,
                )
                wedge = Wedge(
                    planes.s_low[plane],
                    planes.s_high[plane],
                    planes.angle[plane],
                    planes.stretched_beyond[plane],
                    math.sin(problem.half_width),
                    2.0 * problem.half_width,
                )
                status = sweep_plane(problem, view, wedge, planes.reach[plane], profile, scratch, covers, heard, bins)
                if status < 0:
                    return status, ping
            accumulate(bins, problem.range_factor, out[ping, side])
    return 0, -1


@kernel
def on_grid(component):
    """Direction component with rounding dust removed, so that a track along the grid stays on it."""
    return 0.0 if abs(component) < 1e-12 else component
