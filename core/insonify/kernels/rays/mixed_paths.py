"""Mixed paths: echoes that go out by one refracted ray and come back by another.

Each ray that lands gives one path. For each other elevation at which a probe ray comes down near there, Newton's steps
find the ray to the same spot, which is then traced to see whether anything obstructs it. Of two paths A and B
with slant ranges r_A and r_B the echo comes at R = (r_A + r_B) / 2. The landings of each path bring one half of it:
out by A, on which dΩ lands as on every path, and back by B. It enters as σ(d_A, d_B) dΩ R⁴ / (cos α_A q_B x / cosθ_B),
and for a knife as σ dθ R⁴ / ((x / cosθ_A) cos α_A q_B x / cosθ_B).

Theory: docs/theory/refraction.md.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from insonify.compiler.jit import inlined, kernel
from insonify.kernels.beam.pattern import two_way_response
from insonify.kernels.common.scattering import bistatic_strength
from insonify.kernels.rays.caustics import follow_to_place
from insonify.kernels.rays.cell_walk import NO_HIT, RayBundle, empty_bundle, empty_hits
from insonify.kernels.rays.refracted_hits import LandedRays, empty_arrivals, find_refracted_hits
from insonify.kernels.rays.specular_paths import pair_sensitivity

MOST_WAYS = 4  # other paths to one place
TRIES = 12  # Newton's steps
FLATTEST = 20.0  # ground range over height by which a fold above the bed may reach nearer than on it
CLOSE = 1e-5  # m by which a ray may miss its place
SAME = 1e-5  # rad, closer than which two rays are one
SEEN = 0.02  # m by which the landings of two paths may lie apart: chords leave their arcs by less


class MixedEchoes(NamedTuple):
    """Echoes out along one path and back along another, (m,) each; all paths back of one ray follow one another."""

    ray: NDArray[np.int64]  # number of the ray out
    way: NDArray[np.int64]  # number of the path back among those of that ray, by ascending elevation
    bin: NDArray[np.int64]  # -1 where nothing comes back
    value: NDArray[np.float64]  # but for the factor that depends on range alone
    distance: NDArray[np.float64]  # slant range, m
    growth: NDArray[np.float64]  # of slant range, m per radian of elevation of the ray out
    back: RayBundle  # rays back, launched from the sonar


@kernel
def empty_mixed_echoes():
    """No mixed echoes."""
    none, number = np.empty(0), np.empty(0, np.int64)
    return MixedEchoes(number, number, number, none, none, none, empty_bundle(0))


@kernel
def find_mixed_echoes(arrays, beam, waveguide, landings, weight, rays):
    """Mixed echoes of one side's rays: out along one path and back along another to the same place."""
    bundle, arrivals = rays.bundle, rays.arrivals
    pairs, ways, angles = _pair_paths(waveguide, beam.z, landings, rays, weight)
    n = angles.size
    others, met, back = empty_bundle(n), empty_hits(n), empty_arrivals(n)
    for m in range(n):
        k = pairs[m]
        level = math.sqrt(bundle.dx[k] * bundle.dx[k] + bundle.dy[k] * bundle.dy[k])
        others.x[m], others.y[m], others.z[m] = bundle.x[k], bundle.y[k], bundle.z[k]
        c = math.cos(angles[m]) / level
        others.dx[m], others.dy[m], others.dz[m] = c * bundle.dx[k], c * bundle.dy[k], math.sin(angles[m])
    find_refracted_hits(arrays, others, 2.0 * waveguide.reach, 0.0, met, back)
    other_rays = LandedRays(others, met, back)
    bins, values, distance, growth = np.full(n, -1), np.zeros(n), np.full(n, math.inf), np.zeros(n)
    for m in range(n):
        k = pairs[m]
        apart = max(abs(back.x[m] - arrivals.x[k]), abs(back.z[m] - arrivals.z[k]))
        if met.body[m] != NO_HIT and apart < SEEN:
            bins[m], values[m], growth[m] = _mixed_echo(arrays, beam, weight[k], rays, k, other_rays, m)
            distance[m] = 0.5 * (rays.hits.distance[k] + met.distance[m])
    return MixedEchoes(pairs, ways, bins, values, distance, growth, others)


@kernel
def _pair_paths(waveguide, z, landings, rays, weight):
    """Numbers of the rays that have landed, and numbers and elevations of other rays to the same places."""
    bundle, hits, arrivals = rays.bundle, rays.hits, rays.arrivals
    pairs, numbers = np.empty(weight.size, np.int64), np.empty(weight.size, np.int64)
    angles = np.empty(weight.size)
    found = np.empty(MOST_WAYS + 1)
    count = 0
    for k in range(weight.size):
        if hits.body[k] == NO_HIT or weight[k] == 0.0:
            continue
        found[0], ways = math.asin(bundle.dz[k]), 1
        x, height = arrivals.x[k], arrivals.z[k]
        if x + FLATTEST * max(height, 0.0) < landings.fold:
            continue
        for i in range(landings.angle.size - 1):
            # Ground ranges at which probe rays pass this height on their way down.
            low = landings.x[i] - height * landings.flat[i] - x
            high = landings.x[i + 1] - height * landings.flat[i + 1] - x
            if not low * high <= 0.0 or ways > MOST_WAYS:
                continue
            share = low / (low - high) if low != high else 0.5
            guess = landings.angle[i] + share * (landings.angle[i + 1] - landings.angle[i])
            angle = _find_other_path(waveguide, z, guess, x, height)
            if angle == angle and _is_new(found, ways, angle):
                found[ways] = angle
                ways += 1
        if arrivals.dark[k] > 0.0 and ways <= MOST_WAYS:
            # Nearer to a caustic than any probe ray: the other path is as far beyond it.
            for beyond in (-2.0, 2.0):
                guess = found[0] + beyond * arrivals.shift[k] / arrivals.tube[k]
                angle = _find_other_path(waveguide, z, guess, x, height)
                if angle == angle and _is_new(found, ways, angle) and ways <= MOST_WAYS:
                    found[ways] = angle
                    ways += 1
        if count + ways > pairs.size:
            pairs, numbers, angles = _enlarge_row(pairs), _enlarge_row(numbers), _enlarge_row(angles)
        found[1:ways].sort()
        for way in range(1, ways):
            pairs[count], numbers[count], angles[count] = k, way - 1, found[way]
            count += 1
    return pairs[:count], numbers[:count], angles[:count]


@kernel
def _find_other_path(waveguide, z, angle, x, height):
    """Elevation of a ray to a given place, from an initial guess; NaN if Newton's steps do not converge."""
    for _ in range(TRIES):
        there, ray = follow_to_place(waveguide.water, waveguide.plane, z, math.cos(angle), math.sin(angle), x)
        if not there:
            return math.nan
        miss = ray.z - height
        if abs(miss) < CLOSE:
            return angle
        # A step up of dθ lifts the ray there by q dθ / cosθ.
        angle -= miss * ray.cosine / ray.q
        if not abs(angle) < 0.5 * math.pi:
            return math.nan
    return math.nan


@inlined
def _is_new(found, ways, angle):
    """Whether a ray differs from all rays found so far."""
    for way in range(ways):
        if abs(found[way] - angle) < SAME:
            return False
    return True


@kernel
def _enlarge_row(row):
    """Copy a row into room for twice as many, and some more."""
    more = np.empty(2 * row.size + MOST_WAYS, row.dtype)
    more[: row.size] = row
    return more


@inlined
def _mixed_echo(arrays, beam, weight, rays, k, other_rays, m):
    """Bin, value and growth of the echo out along ray k and back along another ray m to the same place."""
    bundle, hits, arrivals = rays.bundle, rays.hits, rays.arrivals
    others, met, back = other_rays.bundle, other_rays.hits, other_rays.arrivals
    fan, law = arrays.half_width > 0.0, arrays.law
    distance = 0.5 * (hits.distance[k] + met.distance[m])
    b = int(distance / arrays.bin_length)
    dx, dy, dz = arrivals.dx[k], arrivals.dy[k], arrivals.dz[k]
    ex, ey, ez = back.dx[m], back.dy[m], back.dz[m]
    nx, ny, nz = hits.nx[k], hits.ny[k], hits.nz[k]
    cosine, other = -(nx * dx + ny * dy + nz * dz), -(nx * ex + ny * ey + nz * ez)
    if b >= arrays.bins or cosine <= 0.0 or other <= 0.0:
        return -1, 0.0, 0.0
    out = 1.0
    if arrays.pattern.tabulated:
        out = two_way_response(
            arrays.pattern, beam, fan, law, bundle.dx[k], bundle.dy[k], bundle.dz[k], hits.distance[k]
        )
    passed = pair_sensitivity(arrays, beam, fan, out, others.dx[m], others.dy[m], others.dz[m], met.distance[m])
    row = arrays.reflectivity[hits.material[k]]
    mirrored = 2.0 * cosine * other - (dx * ex + dy * ey + dz * ez)
    value = bistatic_strength(cosine, other, mirrored, row[0], row[1], row[2], law)
    if met.distance[m] >= beam.reach:
        # The same pair in reverse order has no ray of its own: rays end at the reach.
        value += bistatic_strength(other, cosine, mirrored, row[0], row[1], row[2], law)
    value *= passed * weight
    growth = arrivals.tube[k] * _pair_growth(dx, dy, dz, ex, ey, ez, nx, ny, nz)
    growth *= 0.5 * arrays.water.reference / arrivals.speed[k]
    value *= distance**4 / (cosine * back.tube[m] * back.spread[m]) * arrivals.focus[k] * back.focus[m]
    if not fan:
        value /= arrivals.spread[k]
    return b, value, growth


@inlined
def _pair_growth(dx, dy, dz, ex, ey, ez, nx, ny, nz):
    """Growth of the lengths of two ways to a landing as it moves with a tube 1 m wide that comes by the first."""
    level = max(math.sqrt(dx * dx + dy * dy), 1e-300)
    ux, uy, uz = -dz * dx / level, -dz * dy / level, level
    on = (nx * ux + ny * uy + nz * uz) / (nx * dx + ny * dy + nz * dz)
    px, py, pz = ux - on * dx, uy - on * dy, uz - on * dz
    return abs(px * (dx + ex) + py * (dy + ey) + pz * (dz + ez))
