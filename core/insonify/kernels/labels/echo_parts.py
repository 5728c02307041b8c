"""Parts of which the echo in some range bins is made: stretches of the bed and facets of targets, visible or hidden.

The planes of the sweep are walked once more. Every segment and facet near the bins is deposited by the sweep's own
functions into bins of its own, so that the parts add up to the sweep's record. Bed that the horizon or a target hides
is deposited likewise, as if nothing hid it. Where refraction folds, the parts are single rays.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from insonify.compiler.jit import INTEGER, TWO_INTEGERS, inlined, kernel, kernel_separate
from insonify.kernels.beam.azimuth_sector import AzimuthSector, in_plane_response, is_whole_beam, sector_weight
from insonify.kernels.bed.grid import is_oblique
from insonify.kernels.bed.profile import Profile
from insonify.kernels.bed.slice import slice_bed
from insonify.kernels.common.range_bins import FIXED_POINT, RangeBins, range_weight, step_density, tilt_density
from insonify.kernels.common.scattering import backscatter_strength
from insonify.kernels.common.types import BED, LIGHT, SceneArrays
from insonify.kernels.geometry.cross_sections import HalfPlane
from insonify.kernels.rays.cast import aim_refracted, cast_refracted, unaimed
from insonify.kernels.rays.launch import orient_beam
from insonify.kernels.refraction.apparent_positions import TableGrid, look_up_position, prepare_table
from insonify.kernels.sweep.bed_stretches import (
    NO_TARGET,
    echo_range,
    ground_range_at_slant,
    list_bed_stretch,
    load_segment,
    nearest_ground_range,
    split_segment,
    visible_from,
)
from insonify.kernels.sweep.facets import is_facet_met, span_of_sector
from insonify.kernels.sweep.image_paths import DIRECT, ImagePath, direct_path
from insonify.kernels.sweep.stretches import StretchSink, sink_stretches
from insonify.kernels.sweep.sweep import SweepWorkspace, aim_plane, view_plane
from insonify.kernels.sweep.target_stretches import (
    BedHorizon,
    cell_facet,
    facet_count,
    list_facet,
    load_surface,
    view_from_higher,
    visible_facet,
)
from insonify.kernels.targets.angular_zbuffer import NO_PRIMITIVE
from insonify.kernels.targets.apparent_targets import load_apparent_source
from insonify.kernels.targets.occlusion import occlusion_of
from insonify.kernels.targets.primitives import load_primitive, target_of

VISIBLE, BEHIND_BED, BEHIND_TARGET = 0, 1, 2
# Columns of a row: its state; azimuth of its plane, rad; target, -1 for the bed; row of its material; target that hides
# it, -2 for none; ground range and height of the crest of the bed before it, m
STATE, AZIMUTH, TARGET, MATERIAL, HIDER, CREST_X, CREST_Z = 0, 1, 2, 3, 4, 5, 6
# true ground range and height of its ends, m; slant range of its ends, m; launch angle, rad; cosine of the incidence
X_FROM, Z_FROM, X_TO, Z_TO, NEAR, FAR, LAUNCH, COSINE = 7, 8, 9, 10, 11, 12, 13, 14
# scattering strength; factor of the beam; width along the track, m; vertical response; gain of refraction
STRENGTH, WEIGHT, WIDTH, VERTICAL, GAIN = 15, 16, 17, 18, 19
# echo weighed by each of the window's three weights
ECHO, SPREAD, VALUE, COLUMNS = 20, 21, 22, 23
RISES = 4  # repetitions that find the true height of an apparent place


class Window(NamedTuple):
    """Neighbouring range bins, with weights by which their energy is summed."""

    first: int
    weights: NDArray[np.float64]  # (3, n) factors of the energy of each bin, for the columns ECHO, SPREAD and VALUE


class PartList(NamedTuple):
    """Where parts are listed, and work space."""

    rows: NDArray[np.float64]  # (room, COLUMNS)
    bins: RangeBins  # zero between parts
    knots: Profile  # the profile where it is, beside the workspace's where it seems to be


class PlaneView(NamedTuple):
    """One plane of a beam, and where its parts are listed."""

    arrays: SceneArrays
    path: ImagePath
    sector: AzimuthSector
    plane: HalfPlane
    grid: TableGrid
    azimuth: float
    workspace: SweepWorkspace
    window: Window
    parts: PartList
    sink: StretchSink  # the bins of the parts
    near: float  # slant ranges between which parts are listed, m
    far: float


@kernel
def list_echo_parts(arrays, poses, ping, side, fan, apparent, workspace, window, parts):
    """List the parts of the echo in some range bins of one side of one ping by the direct path.

    Returns
    -------
    int
        Parts there are, of which as many are listed as there is room for.
    """
    grid, n = prepare_table(apparent, poses.z[ping], workspace.table), 0
    path, sink = (
        direct_path(arrays.law, arrays.bin_length, False),
        StretchSink(parts.bins, workspace.contributions, False),
    )
    near = window.first * arrays.bin_length
    far = near + window.weights.shape[1] * arrays.bin_length
    for k in range(fan.azimuth.size):
        plane, sector, reach = aim_plane(arrays, poses, ping, side, fan, k, grid)
        azimuth = fan.azimuth[k]
        view = PlaneView(arrays, path, sector, plane, grid, azimuth, workspace, window, parts, sink, near, far)
        cells, count = _view_plane(arrays, plane, sector, reach, grid, workspace, parts.knots)
        if count > 1:
            n = _list_bed_parts(view, cells, count, n)
        if cells > 0:
            n = _list_target_parts(view, cells, count, n)
    return n


@kernel_separate(TWO_INTEGERS)
def _view_plane(arrays, plane, sector, reach, grid, workspace, knots):
    """Fill a workspace as the sweep does, and ``knots`` with the same slice before apparent positions."""
    cells, count = view_plane(arrays, plane, sector, reach, grid, workspace)
    slice_bed(arrays.bed, arrays.limits, plane.x, plane.y, plane.z, plane.ex, plane.ey, reach, knots)
    return cells, count


@kernel
def _list_bed_parts(view, cells, count, n):
    """List the parts of a profile's segments; return the number of parts."""
    arrays, workspace, table, sink, crest = view.arrays, view.workspace, view.arrays.reflectivity, view.sink, 0
    profile, echoes, zbuffer, pieces = workspace.profile, workspace.echoes, workspace.zbuffer, workspace.pieces
    x, r, launch, horizon, rows = profile.x, echoes.r, echoes.launch, echoes.horizon, workspace.rows
    occlusion, oblique = occlusion_of(zbuffer, cells), is_oblique(view.plane.ex, view.plane.ey)
    owners = zbuffer.nearest, zbuffer.body, arrays.solids.target, arrays.mesh.target
    bending = profile.facing, profile.range_ratio
    for i in range(count - 1):
        if launch[i] >= horizon[i]:
            crest = i
        # A segment comes nearer than its ends by its run at most. NaN, a hole in the bed, compares false.
        nearest, farthest = min(r[i], r[i + 1]) - (x[i + 1] - x[i]), max(r[i], r[i + 1])
        if not (profile.area[i] == profile.area[i] and nearest < view.far and farthest > view.near):
            continue
        segment = load_segment(
            i, x, profile.z, profile.slope, profile.area, profile.material, bending, echoes.weight, table, view.sector
        )
        seen = launch[i + 1] > horizon[i]
        if seen and not echoes.cut[i]:
            _deposit_whole_segment(i, echoes, oblique, arrays.bin_length, sink.bins)
            n = _list_bed_part(view, segment, i, crest, x[i], x[i + 1], VISIBLE, NO_TARGET, n)
            continue
        offset, slope, risen = segment.offset, segment.slope, x[i + 1]
        if seen:
            risen = visible_from(offset, slope, x[i], x[i + 1], launch[i], horizon[i])
        found = split_segment(segment, risen, x[i + 1], occlusion, owners, True, pieces) if seen else 0
        for k in range(-1, found):
            start, stop, hider, state = x[i], risen, NO_TARGET, BEHIND_BED
            if k >= 0:
                start, stop, hider = pieces.x_from[k], pieces.x_to[k], pieces.hider[k]
                state = VISIBLE if hider == NO_TARGET else BEHIND_TARGET
            if stop > start:
                listed = list_bed_stretch(segment, view.path, start, stop, 0, rows, 0)
                sink_stretches(rows, listed, workspace.calm, arrays.bin_length, DIRECT, sink)
                n = _list_bed_part(view, segment, i, crest, start, stop, state, hider, n)
    return n


@inlined
def _deposit_whole_segment(i, echoes, oblique, bin_length, bins):
    """Spread the energy of a segment that is visible whole over the range bins."""
    r, energy = echoes.r, np.int64(abs(echoes.energy[i]))
    a, b = min(r[i], r[i + 1]) / bin_length, max(r[i], r[i + 1]) / bin_length
    step_density(bins, a, energy)
    step_density(bins, b, -energy)
    if oblique and b > a:
        tilt_density(bins, a, b, echoes.energy[i], echoes.change[i])


@kernel
def _list_bed_part(view, segment, i, crest, x_from, x_to, state, hider, n):
    """List a stretch of segment i, the only echo in the bins; clear these and return the number of parts."""
    arrays, sector, profile, parts = view.arrays, view.sector, view.workspace.profile, view.parts
    nearest = echo_range(segment, 0.0, nearest_ground_range(segment, 0.0, x_from, x_to))
    near, far = echo_range(segment, 0.0, x_from), echo_range(segment, 0.0, x_to)
    sums = _take_bins(parts.bins.steps, nearest, max(near, far), arrays.bin_length, view.window)
    if max(near, far) <= view.near or nearest >= view.far:
        return n
    if n >= parts.rows.shape[0]:
        return n + 1
    row, knots, up = parts.rows[n], parts.knots, view.plane.z
    a, b = _inside(segment, x_from, x_to, nearest < min(near, far), view)
    middle = 0.5 * (a + b)
    height = segment.offset + segment.slope * middle
    r = math.sqrt(middle * middle + height * height)
    gain = 0.5 * (profile.gain[i] + profile.gain[i + 1]) if sector.bent and arrays.law != LIGHT else 1.0
    weight = segment.weight + segment.weight_rate * middle
    cosine = -segment.facing / (r * math.sqrt(segment.area))
    row[STATE], row[AZIMUTH], row[TARGET], row[HIDER] = state, view.azimuth, BED, hider
    row[MATERIAL] = profile.material[i]
    row[CREST_X], row[CREST_Z] = knots.x[crest], knots.z[crest] + up
    run = profile.x[i + 1] - profile.x[i]
    for end, x in ((0, a), (1, b)):
        share = (x - profile.x[i]) / run
        row[X_FROM + 2 * end] = knots.x[i] + share * (knots.x[i + 1] - knots.x[i])
        row[Z_FROM + 2 * end] = up + knots.z[i] + share * (knots.z[i + 1] - knots.z[i])
    row[NEAR], row[FAR] = echo_range(segment, 0.0, a), echo_range(segment, 0.0, b)
    row[LAUNCH], row[COSINE] = math.atan2(height, middle), cosine
    row[STRENGTH] = backscatter_strength(cosine, segment.diffuse, segment.specular, segment.shininess, arrays.law)
    _enter_beam(arrays, sector, row, middle, height, r, weight, gain)
    row[ECHO], row[SPREAD], row[VALUE] = sums
    return n + 1


@inlined
def _inside(segment, x_from, x_to, turns, view):
    """Ground ranges between which a stretch lies in the bins; all of it if its slant range falls and grows again."""
    outward = echo_range(segment, 0.0, x_to) >= echo_range(segment, 0.0, x_from)
    if turns or not x_to > x_from:
        return x_from, x_to
    one = min(max(ground_range_at_slant(segment, view.near, outward), x_from), x_to)
    other = min(max(ground_range_at_slant(segment, view.far, outward), x_from), x_to)
    return min(one, other), max(one, other)


@inlined
def _enter_beam(arrays, sector, row, x, z, r, weight, gain):
    """Enter the factor of the beam and of what it is made: width, vertical response, gain of refraction."""
    vertical = in_plane_response(x / r, z / r, sector, arrays.pattern) if sector.tabulated else 1.0
    row[WEIGHT], row[VERTICAL], row[GAIN] = weight, vertical, gain
    row[WIDTH] = x * sector.angle
    if arrays.law == LIGHT or sector.angle == 0.0 or not sector.tabulated or is_whole_beam(sector):
        row[WIDTH] = weight / (gain * vertical) if gain * vertical > 0.0 else 0.0


@kernel
def _take_bins(bins, near, far, bin_length, window):
    """Sum what a part deposited with the window's weights, and clear it."""
    first = min(max(int(near / bin_length) - 1, 0), bins.size - 1)
    last = min(int(min(far / bin_length, bins.size - 2.0)) + 2, bins.size)
    running, echo, spread, value = np.int64(0), 0.0, 0.0, 0.0
    for b in range(first, last):
        running += bins[b]
        bins[b] = 0
        k = b - window.first
        if 0 <= k < window.weights.shape[1]:
            energy = max(running, np.int64(0)) * (1.0 / FIXED_POINT)
            echo += window.weights[0, k] * energy
            spread += window.weights[1, k] * energy
            value += window.weights[2, k] * energy
    return echo, spread, value


@kernel_separate(INTEGER, counting=True)
def _list_target_parts(view, cells, count, n):
    """List the facets of the nearest target in every cell of the z-buffer; return the number of parts."""
    arrays, sector, plane, workspace, path = view.arrays, view.sector, view.plane, view.workspace, view.path
    profile, zbuffer, rows, horizon = workspace.profile, workspace.zbuffer, workspace.rows, workspace.echoes.horizon
    owners, knot = (arrays.solids.material, arrays.mesh.material, arrays.solids.target, arrays.mesh.target), -1
    measured = zbuffer.near, zbuffer.distance, zbuffer.far, zbuffer.incidence
    bed = BedHorizon(profile.x, profile.z, horizon, count)
    higher = view_from_higher(bed, zbuffer, cells)
    for c in range(cells):
        if zbuffer.nearest[c] == NO_PRIMITIVE:
            continue
        p, bounds = zbuffer.nearest[c], (zbuffer.least[zbuffer.nearest[c]], zbuffer.most[zbuffer.nearest[c]])
        source, line = load_apparent_source(sector.bent, zbuffer.source[p]), zbuffer.line[p]
        surface = load_surface(zbuffer.body[p], owners, arrays.reflectivity, source, bounds)
        primitive = load_primitive(arrays.solids, arrays.mesh, plane, surface.body, line, surface.source)
        facets = facet_count(cell_facet(c, zbuffer.edge, zbuffer.cosine, zbuffer.sine, measured, source))
        for k in range(facets):
            facet = visible_facet(primitive, zbuffer.edge[c], zbuffer.edge[c + 1], k, facets, bed, knot)
            if not is_facet_met(facet):
                continue
            half = 0.5 * span_of_sector(facet, surface.bounds, sector, arrays.pattern).across
            nearest = max(min(facet.near, facet.centre, facet.far) - half, 0.0)
            farthest = max(facet.near, facet.centre, facet.far) + half
            if nearest < view.far and farthest > view.near:
                listed = list_facet(facet, 0.0, surface, arrays.pattern, path, (sector, sector), higher, knot, rows, 0)
                sink_stretches(rows, listed, workspace.calm, arrays.bin_length, DIRECT, view.sink)
                bins = view.sink.bins.steps
                sums = _take_bins(bins, 0.9 * nearest, 1.1 * farthest, arrays.bin_length, view.window)
                n = _list_target_part(view, surface, facet, sums, n)
    return n


@kernel
def _list_target_part(view, surface, facet, sums, n):
    """List a facet of a target; return the number of parts."""
    arrays, sector, source, numbers = view.arrays, view.sector, surface.source, surface.numbers
    if n >= view.parts.rows.shape[0]:
        return n + 1
    row, r = view.parts.rows[n], facet.centre
    row[STATE], row[AZIMUTH], row[HIDER] = VISIBLE, view.azimuth, NO_TARGET
    row[TARGET], row[MATERIAL] = surface.owner - arrays.reflectivity.shape[0], surface.material
    row[CREST_X] = row[CREST_Z] = math.nan
    for end, angle, distance in ((0, facet.low, facet.near), (1, facet.high, facet.far)):
        row[X_FROM + 2 * end], row[Z_FROM + 2 * end] = _true_place(view, source, angle, distance)
    row[NEAR], row[FAR], row[LAUNCH] = facet.near, facet.far, 0.5 * (facet.low + facet.high)
    row[COSINE] = facet.incidence
    row[STRENGTH] = backscatter_strength(facet.incidence, numbers[0], numbers[1], numbers[2], arrays.law)
    x, z = r * facet.cosine, r * facet.sine
    weight = source.gain * sector_weight(x, z, r, sector, arrays.pattern, arrays.law)
    _enter_beam(arrays, sector, row, x, z, r, weight, source.gain)
    row[ECHO], row[SPREAD], row[VALUE] = sums
    return n + 1


@inlined
def _true_place(view, source, angle, distance):
    """Ground range and height above the datum of a place, from its launch angle and its slant range."""
    x, z = distance * math.cos(angle), distance * math.sin(angle)
    if not view.sector.bent:
        return x, z + view.plane.z
    apparent, x = z, x / source.level
    for _ in range(RISES):
        _, rise, _, _ = look_up_position(view.workspace.table, view.grid, x, z)
        z = apparent - rise
    return x, z + view.plane.z


@kernel
def list_refracted_parts(arrays, bare, poses, ping, side, rays, window, rows):
    """List the rays of one side of one ping that echo in some range bins, and those that targets keep from the bed.

    Parameters
    ----------
    arrays, bare : SceneArrays
        The scene, and the same without targets.
    poses, ping, side, rays, window : Poses, int, int, int, Window
    rows : ndarray of float64, shape (room, COLUMNS)
        Filled; unknown columns of a ray are NaN.

    Returns
    -------
    int
        Parts there are, of which as many are listed as there is room for.
    """
    beam, n = orient_beam(arrays, poses, ping, side), 0
    ahead = math.cos(poses.heading[ping]), math.sin(poses.heading[ping])
    waveguide, aim = aim_refracted(arrays, beam, poses.pitch[ping], unaimed(rays))
    cast = cast_refracted(arrays, beam, waveguide, aim, 0.0)
    for m in range(cast.echoes.ray.size):
        n = _list_echo(arrays, cast, ahead, m, VISIBLE, NO_TARGET, window, rows, n)
    if arrays.solids.shape.size + arrays.mesh.target.size > 0:
        # The bed's echoes of the rays that meet a target first.
        hidden, body = cast_refracted(bare, beam, waveguide, aim, 0.0), cast.rays.hits.body
        for k in range(rays):
            if body[k] >= 0:
                hider = target_of(arrays.solids.target, arrays.mesh.target, body[k])
                n = _list_echo(arrays, hidden, ahead, k, BEHIND_TARGET, hider, window, rows, n)
    return n


@inlined
def _list_echo(arrays, cast, ahead, m, state, hider, window, rows, n):
    """List echo m of a cast if it lies in the window; return the number of parts."""
    echoes = cast.echoes
    k, b, value, cosine = echoes.ray[m], echoes.bin[m], echoes.value[m], echoes.cosine[m]
    inside = b - window.first
    if b < 0 or not 0 <= inside < window.weights.shape[1] or not value > 0.0:
        return n
    if n >= rows.shape[0]:
        return n + 1
    nearness = range_weight(arrays.range_decay, b, echoes.distance[m] / arrays.bin_length, 0.0)
    row, bundle, hits, arrivals = rows[n], cast.rays.bundle, cast.rays.hits, cast.rays.arrivals
    row[:] = math.nan
    body, material = hits.body[k], hits.material[k]
    row[STATE], row[HIDER], row[MATERIAL], row[TARGET] = state, hider, material, BED
    if body != BED:
        row[TARGET] = target_of(arrays.solids.target, arrays.mesh.target, body)
    forward = bundle.dx[k] * ahead[0] + bundle.dy[k] * ahead[1]
    level = math.sqrt(bundle.dx[k] * bundle.dx[k] + bundle.dy[k] * bundle.dy[k])
    row[AZIMUTH] = math.asin(min(max(forward / level, -1.0), 1.0)) if level > 0.0 else 0.0
    row[X_FROM], row[Z_FROM], row[X_TO], row[Z_TO] = arrivals.x[k], arrivals.z[k], arrivals.x[k], arrivals.z[k]
    row[NEAR], row[FAR], row[LAUNCH] = hits.distance[k], hits.distance[k], math.asin(bundle.dz[k])
    row[COSINE] = cosine
    numbers = arrays.reflectivity[material]
    row[STRENGTH] = backscatter_strength(cosine, numbers[0], numbers[1], numbers[2], arrays.law)
    for what in range(3):
        row[ECHO + what] = window.weights[what, inside] * value * nearness
    return n + 1
