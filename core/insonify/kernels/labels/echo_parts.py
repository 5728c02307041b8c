"""Parts of which the echo in some range bins is made: stretches of the bed and facets of targets, heard or hidden.

The planes of the sweep are walked once more. Every segment and facet near the bins is deposited by the sweep's own
functions into bins of its own, so that the parts add up to the sweep's record. Bed that the horizon or a target hides
is deposited likewise, as if nothing hid it.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from insonify.compiler.jit import INTEGER, TWO_INTEGERS, inlined, kernel, kernel_separate
from insonify.kernels.beam.azimuth_sector import in_plane_response, is_whole_beam, sector_weight
from insonify.kernels.bed.grid import is_oblique
from insonify.kernels.bed.profile import Profile
from insonify.kernels.bed.slice import slice_bed
from insonify.kernels.common.range_bins import FIXED_POINT, step_density, tilt_density
from insonify.kernels.common.scattering import backscatter_strength
from insonify.kernels.common.search import last_not_above
from insonify.kernels.common.types import BED, LIGHT
from insonify.kernels.geometry.cross_sections import HalfPlane
from insonify.kernels.labels.bed_labels import ground_range_at_slant
from insonify.kernels.labels.shadows import NO_TARGET, target_of_body
from insonify.kernels.refraction.apparent_positions import (
    TableGrid,
    apply_apparent_positions,
    look_up_position,
    prepare_table,
)
from insonify.kernels.sweep.facets import deposit_facet, is_facet_met
from insonify.kernels.sweep.partial_segments import deposit_partial_segment, slant_range
from insonify.kernels.sweep.sweep import aim_plane, load_segment, visible_from
from insonify.kernels.sweep.target_echoes import (
    BedHorizon,
    count_facets,
    ground_range_at,
    knot_before,
    launch_angle,
    primitive_material,
    visible_facet,
)
from insonify.kernels.sweep.visibility import find_visible_echoes
from insonify.kernels.targets.angular_zbuffer import NO_PRIMITIVE, fill_zbuffer
from insonify.kernels.targets.apparent_targets import load_apparent_source
from insonify.kernels.targets.occlusion import next_visible, occluded_slopes, occlusion_of
from insonify.kernels.targets.primitives import load_primitive

HEARD, BEHIND_BED, BEHIND_TARGET = 0, 1, 2
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
    """Neighbouring range bins whose echo is looked at."""

    first: int
    weights: NDArray[np.float64]  # (3, n) factors of the energy of each bin, for the columns ECHO, SPREAD and VALUE


class PartList(NamedTuple):
    """Where parts are listed, and work space."""

    rows: NDArray[np.float64]  # (room, COLUMNS)
    bins: NDArray[np.int64]  # (bins + 2,) difference array, zero between parts
    knots: Profile  # the profile where it is, beside the workspace's where it seems to be


class PlaneView(NamedTuple):
    """One plane of a beam as its parts need it."""

    azimuth: float
    plane: HalfPlane
    grid: TableGrid
    table: NDArray[np.float32]
    near: float  # slant ranges between which parts are listed, m
    far: float


@kernel
def list_echo_parts(arrays, poses, ping, side, fan, apparent, workspace, window, parts):
    """List the parts of the echo in some range bins of one side of one ping by the direct path.

    Parameters
    ----------
    arrays : SceneArrays
    poses : Poses
    ping, side : int
    fan : AzimuthFan
    apparent : ApparentTables
    workspace : SweepWorkspace
    window : Window
    parts : PartList

    Returns
    -------
    int
        Parts there are, of which as many are listed as there is room for; or -1 - k if the sonar is inside body k.
    """
    grid, n = prepare_table(apparent, poses.z[ping], workspace.table), 0
    near = window.first * arrays.bin_length
    far = near + window.weights.shape[1] * arrays.bin_length
    for k in range(fan.azimuth.size):
        plane, sector, reach = aim_plane(arrays, poses, ping, side, fan, k, grid)
        view = PlaneView(fan.azimuth[k], plane, grid, workspace.table, near, far)
        cells, count = _view_plane(arrays, plane, sector, reach, grid, workspace, parts.knots)
        if cells < 0:
            return cells
        if count > 1:
            n = _list_bed(arrays, sector, view, cells, count, workspace, window, parts, n)
        if cells > 0:
            n = _list_targets(arrays, sector, view, cells, count, workspace, window, parts, n)
    return n


@kernel_separate(TWO_INTEGERS)
def _view_plane(arrays, plane, sector, reach, grid, workspace, knots):
    """Fill a workspace with what one plane cuts, as the sweep does; return the z-buffer's cells and the knots."""
    profile, echoes, zbuffer, table = workspace.profile, workspace.echoes, workspace.zbuffer, workspace.table
    cells = fill_zbuffer(arrays, plane, sector, reach, grid, table, zbuffer) if zbuffer.body.size > 0 else 0
    if cells < 0:
        return cells, 0
    hidden_from, hidden_to = occluded_slopes(zbuffer, cells)
    count = slice_bed(arrays.bed, arrays.limits, plane.x, plane.y, plane.z, plane.ex, plane.ey, reach, profile)
    for i in range(count):  # a loop compiles in a fiftieth of the time of slices, which check that they fit
        knots.x[i], knots.z[i] = profile.x[i], profile.z[i]
    if count > 1:
        if sector.bent:
            apply_apparent_positions(table, grid, sector.angle == 0.0, profile, count)
        find_visible_echoes(profile, count, plane, arrays, sector, hidden_from, hidden_to, echoes)
    return cells, count


@kernel
def _list_bed(arrays, sector, view, cells, count, workspace, window, parts, n):
    """List the parts of a profile's segments; return the number of parts."""
    profile, echoes, zbuffer = workspace.profile, workspace.echoes, workspace.zbuffer
    x, z, area, r, cut = profile.x, profile.z, profile.area, echoes.r, echoes.cut
    launch, horizon, crest = echoes.launch, echoes.horizon, 0
    oblique = is_oblique(view.plane.ex, view.plane.ey)
    for i in range(count - 1):
        if launch[i] >= horizon[i]:
            crest = i
        # NaN, a hole in the bed, compares false.
        if not (area[i] == area[i] and _touches(view, r[i], r[i + 1], x[i + 1] - x[i])):
            continue
        segment = load_segment(
            i, x, z, profile.slope, area, profile.facing, profile.material, echoes.weight, arrays.reflectivity, sector
        )
        place = (i, crest)
        seen = launch[i + 1] > horizon[i]
        if seen and not cut[i]:
            energy, last = np.int64(abs(echoes.energy[i])), parts.bins.size - 2
            a, b = min(r[i], r[i + 1]) / arrays.bin_length, max(r[i], r[i + 1]) / arrays.bin_length
            step_density(parts.bins, a, energy, last)
            step_density(parts.bins, b, -energy, last)
            if oblique and b > a:
                tilt_density(parts.bins, a, b, echoes.energy[i], echoes.change[i], last)
            n = _list_stretch(arrays, sector, view, workspace, segment, place, x[i], x[i + 1], HEARD, NO_TARGET,
                              window, parts, n)  # fmt: skip
            continue
        start = visible_from(segment, x[i], x[i + 1], launch[i], horizon[i]) if seen else x[i + 1]
        n = _list_whole(arrays, sector, view, workspace, segment, place, x[i], start, BEHIND_BED, NO_TARGET,
                        window, parts, n)  # fmt: skip
        if seen and cells == 0:
            n = _list_whole(arrays, sector, view, workspace, segment, place, start, x[i + 1], HEARD, NO_TARGET,
                            window, parts, n)  # fmt: skip
        elif seen:
            occlusion = occlusion_of(zbuffer, cells)
            n = _list_behind_targets(arrays, sector, view, workspace, segment, place, start, x[i + 1], occlusion,
                                     window, parts, n)  # fmt: skip
    return n


@inlined
def _touches(view, near, far, run):
    """Whether a segment may lie between the slant ranges looked at; it comes nearer than its ends by its run."""
    return min(near, far) - run < view.far and max(near, far) > view.near


@kernel
def _list_behind_targets(arrays, sector, view, workspace, segment, place, x_from, x_to, occlusion, window, parts, n):
    """List the stretches of a segment that targets leave visible or hide."""
    low, high = launch_angle(segment, x_from), launch_angle(segment, x_to)
    while low < high:
        opened, closed = next_visible(occlusion, segment, low, high)
        start = x_from if opened <= low else x_to
        if low < opened < high:
            start = min(max(ground_range_at(segment, opened), x_from), x_to)
        if opened > low:
            n = _list_hidden(arrays, sector, view, workspace, segment, place, low, min(opened, high), x_from, start,
                             occlusion.edge, window, parts, n)  # fmt: skip
        if opened >= high:
            return n
        stop = x_to if closed >= high else min(ground_range_at(segment, closed), x_to)
        n = _list_whole(arrays, sector, view, workspace, segment, place, max(start, x_from), stop, HEARD, NO_TARGET,
                        window, parts, n)  # fmt: skip
        low, x_from = closed, stop
    return n


@kernel
def _list_hidden(arrays, sector, view, workspace, segment, place, low, high, x_from, x_to, edge, window, parts, n):
    """List a stretch that targets hide between two launch angles, by the target that is nearest in each cell."""
    zbuffer = workspace.zbuffer
    nearest, body = zbuffer.nearest, zbuffer.body
    cell = max(last_not_above(edge, low), 0)
    while low < high and cell + 1 < edge.size:
        p = nearest[cell]
        target = target_of_body(arrays.solids, arrays.mesh, body[p]) if p != NO_PRIMITIVE else NO_TARGET
        end = min(edge[cell + 1], high)
        stop = x_to if end >= high else min(max(ground_range_at(segment, end), x_from), x_to)
        if target != NO_TARGET:
            n = _list_whole(arrays, sector, view, workspace, segment, place, x_from, stop, BEHIND_TARGET, target,
                            window, parts, n)  # fmt: skip
        low, x_from, cell = end, stop, cell + 1
    return n


@kernel
def _list_whole(arrays, sector, view, workspace, segment, place, x_from, x_to, state, hider, window, parts, n):
    """Deposit a stretch of a segment by itself and list it."""
    if not x_to > x_from:
        return n
    deposit_partial_segment(segment, x_from, x_to, arrays.law, arrays.bin_length, parts.bins)
    return _list_stretch(arrays, sector, view, workspace, segment, place, x_from, x_to, state, hider, window, parts, n)


@kernel
def _list_stretch(arrays, sector, view, workspace, segment, place, x_from, x_to, state, hider, window, parts, n):
    """List a stretch of a segment whose echo lies in the bins of its own, which are cleared."""
    i, crest = place
    profile, knots, z = workspace.profile, parts.knots, view.plane.z
    nearest = _nearest(segment, x_from, x_to)
    near, far = slant_range(segment, x_from), slant_range(segment, x_to)
    sums = _take_bins(parts.bins, nearest, max(near, far), arrays.bin_length, window)
    if max(near, far) <= view.near or nearest >= view.far:
        return n
    if n >= parts.rows.shape[0]:
        return n + 1
    row = parts.rows[n]
    a, b = _inside(segment, x_from, x_to, nearest < min(near, far), view)
    near, far = slant_range(segment, a), slant_range(segment, b)
    middle = 0.5 * (a + b)
    height = segment.offset + segment.slope * middle
    r = math.sqrt(middle * middle + height * height)
    gain = 0.5 * (profile.gain[i] + profile.gain[i + 1]) if sector.bent and arrays.law != LIGHT else 1.0
    weight = segment.weight + segment.weight_rate * middle
    cosine = -segment.facing / (r * math.sqrt(segment.area))
    row[STATE], row[AZIMUTH], row[TARGET], row[MATERIAL], row[HIDER] = (
        state,
        view.azimuth,
        BED,
        profile.material[i],
        hider,
    )
    row[CREST_X], row[CREST_Z] = knots.x[crest], knots.z[crest] + z
    run = profile.x[i + 1] - profile.x[i]
    for end_of, at in ((0, a), (1, b)):
        share = (at - profile.x[i]) / run
        row[X_FROM + 2 * end_of] = knots.x[i] + share * (knots.x[i + 1] - knots.x[i])
        row[Z_FROM + 2 * end_of] = z + knots.z[i] + share * (knots.z[i + 1] - knots.z[i])
    row[NEAR], row[FAR] = near, far
    row[LAUNCH], row[COSINE] = math.atan2(height, middle), cosine
    row[STRENGTH] = backscatter_strength(cosine, segment.diffuse, segment.specular, segment.shininess, arrays.law)
    _enter_beam(arrays, sector, row, middle, height, r, weight, gain)
    row[ECHO], row[SPREAD], row[VALUE] = sums
    return n + 1


@inlined
def _nearest(segment, x_from, x_to):
    """Least slant range of a stretch."""
    foot = min(max(-segment.slope * segment.offset / (1.0 + segment.slope * segment.slope), x_from), x_to)
    return slant_range(segment, foot)


@inlined
def _inside(segment, x_from, x_to, turns, view):
    """Ground ranges between which a stretch lies in the bins; all of it if its slant range falls and grows again."""
    outward = slant_range(segment, x_to) >= slant_range(segment, x_from)
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
def _list_targets(arrays, sector, view, cells, count, workspace, window, parts, n):
    """List the facets of the nearest target in every cell of the z-buffer; return the number of parts."""
    solids, mesh, table, zbuffer = arrays.solids, arrays.mesh, arrays.reflectivity, workspace.zbuffer
    profile, plane = workspace.profile, view.plane
    bed, knot = BedHorizon(profile.x, profile.z, workspace.echoes.horizon, count), -1
    for cell in range(cells):
        p = zbuffer.nearest[cell]
        if p == NO_PRIMITIVE:
            continue
        body, row = zbuffer.body[p], primitive_material(solids, mesh, zbuffer, p)
        facets, centre = count_facets(zbuffer, cell)
        knot = knot_before(bed, centre, knot)
        source = load_apparent_source(sector.bent, zbuffer.source[p])
        primitive = load_primitive(solids, mesh, plane, body, zbuffer.line[p], source)
        material, who = (table[row, 0], table[row, 1], table[row, 2]), (target_of_body(solids, mesh, body), row)
        for k in range(facets):
            facet = visible_facet(primitive, zbuffer.edge[cell], zbuffer.edge[cell + 1], k, facets, bed, knot)
            nearest, farthest = min(facet.near, facet.centre, facet.far), max(facet.near, facet.centre, facet.far)
            if is_facet_met(facet) and nearest < view.far and farthest > view.near:
                deposit_facet(facet, source.gain, material, sector, arrays.pattern, arrays.law, arrays.bin_length,
                              parts.bins)  # fmt: skip
                sums = _take_bins(parts.bins, 0.9 * nearest, 1.1 * farthest, arrays.bin_length, window)
                n = _list_facet(arrays, sector, view, facet, source, material, who, sums, parts, n)
    return n


@kernel
def _list_facet(arrays, sector, view, facet, source, material, who, sums, parts, n):
    """List a facet of a target."""
    if n >= parts.rows.shape[0]:
        return n + 1
    row, r = parts.rows[n], facet.centre
    row[STATE], row[AZIMUTH], row[TARGET], row[MATERIAL], row[HIDER] = HEARD, view.azimuth, who[0], who[1], NO_TARGET
    row[CREST_X] = row[CREST_Z] = math.nan
    for end_of, angle, distance in ((0, facet.low, facet.near), (1, facet.high, facet.far)):
        x, z = _true_place(view, sector.bent, source, angle, distance)
        row[X_FROM + 2 * end_of], row[Z_FROM + 2 * end_of] = x, z
    row[NEAR], row[FAR], row[LAUNCH] = facet.near, facet.far, 0.5 * (facet.low + facet.high)
    row[COSINE] = facet.incidence
    row[STRENGTH] = backscatter_strength(facet.incidence, material[0], material[1], material[2], arrays.law)
    x, z = r * facet.cosine, r * facet.sine
    weight = source.gain * sector_weight(x, z, r, sector, arrays.pattern, arrays.law)
    _enter_beam(arrays, sector, row, x, z, r, weight, source.gain)
    row[ECHO], row[SPREAD], row[VALUE] = sums
    return n + 1


@inlined
def _true_place(view, bent, source, angle, distance):
    """Ground range and height above the datum of a place known by its launch angle and its slant range."""
    x, z = distance * math.cos(angle), distance * math.sin(angle)
    if not bent:
        return x, z + view.plane.z
    apparent, x = z, x / source.level
    for _ in range(RISES):
        _, rise, _, _ = look_up_position(view.table, view.grid, x, z)
        z = apparent - rise
    return x, z + view.plane.z
