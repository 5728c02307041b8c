"""Labels of range bins from the sweep: greatest contributor, its place and incidence, and the shadows of targets.

Planes are swept as for the record, the intensity of which is found beside its labels. Every visible segment and facet
adds its energy to the bins it spans, contributor by contributor: each material of the bed is one, and so is each
target. A bin has an echo if it has energy in the record.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from insonify.compiler.jit import inlined_uncounted, kernel, kernel_uncounted
from insonify.kernels.bed.profile import list_marked
from insonify.kernels.common.contributors import (
    SpreadEcho,
    add_contribution,
    contributor_row,
    open_contributor,
    spanned_bins,
    spread_contribution,
    spread_echo,
)
from insonify.kernels.common.range_bins import FIXED_POINT, RangeBins, accumulate_bins
from insonify.kernels.common.scattering import backscatter_strength
from insonify.kernels.common.types import LIGHT
from insonify.kernels.labels.bed_stretches import BEHIND_BED, empty_stretches, split_segment
from insonify.kernels.labels.shadows import NO_TARGET, label_shadows, open_shadow
from insonify.kernels.multipath.echo_list import EchoSink
from insonify.kernels.multipath.surface_multipath import add_multipath, empty_shares_of_images
from insonify.kernels.refraction.apparent_positions import prepare_table
from insonify.kernels.sweep.facets import (
    divide_facet,
    facet_curve,
    facet_weight,
    is_facet_met,
    part_echo,
    span_of_sector,
    widen,
)
from insonify.kernels.sweep.partial_segments import (
    BedSegment,
    ground_range_at_slant,
    load_segment,
    nearest_ground_range,
    slant_range,
    visible_from,
)
from insonify.kernels.sweep.plane_errors import add_plane, finish_side, square_record
from insonify.kernels.sweep.sweep import (
    aim_plane,
    begin_measured,
    can_measure,
    planes_of,
    reach_in_bins,
    shares_planes,
    sweep_plane,
)
from insonify.kernels.sweep.target_echoes import BedHorizon, cell_facet, is_cell_clear, load_cell, visible_facet
from insonify.kernels.targets.angular_zbuffer import NO_PRIMITIVE
from insonify.kernels.targets.occlusion import occlusion_of

NO_MATERIAL = NO_PATH = -1
HALVES = 2  # least number of parts of a facet; labels add up their energies


class Contributors(NamedTuple):
    """What a bin is labelled with, by the row of its greatest contributor: the scene's by each path in turn."""

    target: NDArray[np.int16]
    material: NDArray[np.int16]
    path: NDArray[np.int8]


class RecordLabels(NamedTuple):
    """Labels of every range bin: greatest contributor, its place and path, and shadows of targets.

    Each is (n, 2, bins) but ``target_echo``, which is (n, 2, targets).
    """

    # Index of the declared target that is the bin's greatest contributor, -1 for the bed, -2 where there is no
    # echo, except perhaps of the sea surface.
    target_id: NDArray[np.int16]
    material: NDArray[np.int16]  # its row of the material table, -1 where there is none
    # Share, 0 to 1, of the bed's echo that targets hide: the echo by the direct path that the bed would return
    # into the bin without the targets is 1, whatever the beam makes of it. 0 where the bed would return none, so
    # that bed that other bed hides does not count.
    shadow: NDArray[np.float32]
    shadow_id: NDArray[np.int16]  # index of the declared target that hides most of it, -2 where none hides any
    ground_range: NDArray[np.float32]  # of the contributor's strongest echo, in metres; NaN without an echo
    # Of that echo on its surface, from the normal, in degrees, the greater of two if sound comes and goes by
    # different paths; NaN without an echo.
    incidence: NDArray[np.float32]
    path: NDArray[np.int8]  # place of that contributor's propagation path among `PATHS`, -1 without an echo
    # Index of the declared volume of the water column with the greatest mean echo, if that exceeds the contributor's;
    # else -2.
    volume_id: NDArray[np.int16]
    # Whether the echo comes by a caustic of the water: ray theory does not give its intensity, and the ray tubes
    # count as no narrower than Airy's function allows.
    caustic: NDArray[np.bool_]
    # Of each target, up to the last that is modelled: its echo by the direct path over all bins, weighted by the
    # beam, without spreading and absorption. By law `sonar` a backscattering cross-section in m².
    target_echo: NDArray[np.float32]


class LabelledPings(NamedTuple):
    """Where the kernels put what they find of some pings."""

    labels: RecordLabels  # of all pings, with cosines in place of the incidence in degrees
    energy: NDArray[np.float32]  # (pings, 2, bins) of the greatest contributor, in units of all bins at that range
    traced: NDArray[np.float32]  # (pings, 2, bins) intensity, as the sweep and its multipath find it
    errors: NDArray[np.float64]  # (pings, 2, 3, 2) as `sweep_pings` has them; with no pings, no error is estimated
    places: NDArray[np.int64]  # rows of all these that belong to the pings


class LabelledSegment(NamedTuple):
    """A segment of the bed and what its echo is labelled with."""

    segment: BedSegment
    contributor: int
    range_ratio: float  # apparent ground range over the true one
    law: int
    bin_length: float


@kernel
def label_swept_pings(
    arrays, poses, laid, image_laid, apparent, contributors, workspace, multipath, sums, contributions, shadows, out
):
    """Label every range bin of pings with its greatest contributor, by the sweep.

    Parameters
    ----------
    arrays, poses : SceneArrays, Poses
        n pings.
    laid, image_laid : LaidPlanes
        Planes of the sonar's beam, and of its image's in the sea surface, of n pings.
    apparent, contributors : ApparentTables, Contributors
    workspace, multipath, sums : SweepWorkspace, MultipathWorkspace, PlaneSums
    contributions, shadows : ContributorTable, ShadowTable
        Empty, with a row for every contributor by every path, and one for every target.
    out : LabelledPings
        Of n pings; takes the result.
    """
    bins = RangeBins(np.zeros(arrays.bins + 2, np.int64), arrays.range_decay)
    by_surface, stretches = np.zeros(arrays.bins, np.float32), empty_stretches(workspace.zbuffer)
    shares, factor = empty_shares_of_images(laid, image_laid), arrays.range_factor
    no_bins = np.zeros(0, np.float32)
    for ping in range(poses.x.size):
        grid, fan = prepare_table(apparent, poses.z[ping], workspace.table), planes_of(laid, ping)
        is_measured = can_measure(fan, out.errors)
        for side in range(2):
            place = out.places[ping]
            intensity = out.traced[place, side]
            missed = out.errors[place : place + 1, side]
            if is_measured:
                begin_measured(arrays, poses, ping, side, fan, shares_planes(laid, ping), sums, shares)
            _note_direct(
                arrays, poses, ping, side, fan, grid, workspace, stretches, contributions, shadows, bins,
                sums, shares, is_measured,
            )  # fmt: skip
            if is_measured:
                missed[0] = 0.0
                finish_side(sums, factor, intensity, missed[0], no_bins)
                square_record(sums, factor, intensity, missed[0])
            else:
                accumulate_bins(bins, factor, intensity)
            if arrays.multipath.enabled:
                sink = EchoSink(bins, contributions, True)
                add_multipath(
                    arrays, poses, ping, side, laid, image_laid, multipath, sink, sums, shares, by_surface, intensity,
                    missed, no_bins,
                )  # fmt: skip
            materials = arrays.reflectivity.shape[0]
            label_shadows(shadows, contributions, materials, out.labels, place, side)
            sum_target_echoes(contributions, materials, 1.0 / FIXED_POINT, out.labels.target_echo[place, side])
            label_bins(contributions, contributors, intensity, out, place, side)


@kernel_uncounted
def _note_direct(
    arrays, poses, ping, side, fan, grid, workspace, stretches, contributions, shadows, bins, sums, shares, is_measured
):
    """Sweep the planes of one side of one ping, and note what each contributes."""
    profile, echoes, zbuffer = workspace.profile, workspace.echoes, workspace.zbuffer
    for k in range(fan.azimuth.size):
        plane, sector, reach = aim_plane(arrays, poses, ping, side, fan, k, grid)
        cells, count = sweep_plane(arrays, plane, sector, reach, grid, workspace, bins)
        if count > 1:
            _note_bed(profile, count, arrays, sector, zbuffer, cells, echoes, stretches, contributions, shadows)
        if cells > 0:
            _note_targets(profile, count, echoes.horizon, arrays, sector, plane, zbuffer, cells, contributions)
        if is_measured:
            add_plane(sums, bins, shares[k], reach_in_bins(arrays, plane.z, reach), fan.azimuth[k], fan.apart[k])


@kernel_uncounted
def sum_target_echoes(contributions, materials, scale, target_echo):
    """Sum the direct echo of each target over all range bins, before the factor that depends on range alone."""
    for target in range(target_echo.size):
        total = 0.0
        if contributions.present[materials + target]:
            for k in range(contributions.energy.shape[1]):
                total += contributions.energy[materials + target, k]
        target_echo[target] = scale * total


@kernel_uncounted
def label_bins(contributions, contributors, intensity, out, place, side):
    """Label each bin of one side of one ping with its greatest contributor, and clear the contributions."""
    labels, energy = out.labels, out.energy[place, side]
    target, material, path = labels.target_id[place, side], labels.material[place, side], labels.path[place, side]
    ground_range, cosine = labels.ground_range[place, side], labels.incidence[place, side]
    target[:], material[:], path[:] = NO_TARGET, NO_MATERIAL, NO_PATH
    energy[:], ground_range[:], cosine[:] = 0.0, np.nan, np.nan
    for row in range(contributions.present.size):
        if not contributions.present[row]:
            continue
        own = contributor_row(contributions, row)
        for k in range(intensity.size):
            is_echo = intensity[k] > 0.0 and own.strongest[k] >= 0.0
            if is_echo and (path[k] == NO_PATH or np.float32(own.energy[k]) > energy[k]):
                target[k], material[k], path[k] = (
                    contributors.target[row],
                    contributors.material[row],
                    contributors.path[row],
                )
                energy[k], ground_range[k], cosine[k] = own.energy[k], own.x[k], own.cosine[k]
    contributions.present[:] = False


@inlined_uncounted
def _note_bed(profile, count, arrays, sector, zbuffer, cells, echoes, stretches, contributions, shadows):
    """Note the contribution of every visible segment of a profile, and the echo that targets hide of those segments."""
    _note_whole_segments(profile, count, sector.bent, echoes, 1.0 / arrays.bin_length, contributions)
    occlusion = occlusion_of(zbuffer, cells)
    x, z, slope, area, facing = profile.x, profile.z, profile.slope, profile.area, profile.facing
    material, weights, ratios = profile.material, echoes.weight, profile.range_ratio
    for k in range(list_marked(echoes.cut, count - 1, echoes.marked)):
        i = echoes.marked[k]
        segment = load_segment(i, x, z, slope, area, facing, material, weights, arrays.reflectivity, sector)
        ratio = 0.5 * (ratios[i] + ratios[i + 1]) if sector.bent else 1.0
        labelled = LabelledSegment(segment, material[i], ratio, arrays.law, arrays.bin_length)
        open_contributor(contributions, material[i])
        risen = visible_from(segment, x[i], x[i + 1], echoes.launch[i], echoes.horizon[i])
        for s in range(split_segment(segment, x[i], x[i + 1], risen, occlusion, arrays, zbuffer, stretches)):
            hider, start, stop = stretches.hider[s], stretches.x_from[s], stretches.x_to[s]
            if hider != NO_TARGET:
                open_shadow(shadows, hider)
            if stretches.state[s] != BEHIND_BED:
                foot = nearest_ground_range(segment, start, stop)
                _note_stretch(contributions, shadows, labelled, hider, start, foot)
                _note_stretch(contributions, shadows, labelled, hider, foot, stop)


@inlined_uncounted
def _note_whole_segments(profile, count, bent, echoes, per_bin, contributions):
    """Note every segment that is visible whole; its energy is spread evenly over its slant range."""
    x, ratios, material, row = profile.x, profile.range_ratio, profile.material, -1
    r, cos_squared, density = echoes.r, echoes.cos_squared, echoes.energy
    own = contributor_row(contributions, 0)
    for i in range(count - 1):
        if density[i] == 0.0:
            continue
        if material[i] != row:
            row = material[i]
            open_contributor(contributions, row)
            own = contributor_row(contributions, row)
        near, far = r[i] * per_bin, r[i + 1] * per_bin
        a, b = min(near, far), max(near, far)
        ratio = 0.5 * (ratios[i] + ratios[i + 1]) if bent else 1.0
        run = (x[i + 1] - x[i]) / ((far - near) * ratio)
        # The height of the segment's line over nadir, by √area: cos α is inverse to the slant range along it.
        facing = math.sqrt(cos_squared[i]) * 0.5 * (a + b)
        spread_echo(own, SpreadEcho(a, b, abs(np.float64(density[i])), x[i] / ratio - near * run, run, facing))


@kernel_uncounted
def _note_stretch(contributions, shadows, labelled, hider, x_from, x_to):
    """Note a stretch of a segment along which slant range grows or falls, each bin by what of it lies there."""
    if not x_to > x_from:
        return
    segment, law, bin_length = labelled.segment, labelled.law, labelled.bin_length
    one, other = slant_range(segment, x_from), slant_range(segment, x_to)
    near, far, outward = min(one, other), max(one, other), other >= one
    begin, per_bin, root = x_from if outward else x_to, 1.0 / bin_length, math.sqrt(segment.area)
    first, last = spanned_bins(near * per_bin, far * per_bin, contributions.energy.shape[1])
    for k in range(first, last):
        start, stop = max(near, k * bin_length), min(far, (k + 1) * bin_length)
        end = min(max(ground_range_at_slant(segment, stop, outward), x_from), x_to)
        x, length = 0.5 * (begin + end), abs(end - begin)
        cosine = -segment.facing / (slant_range(segment, x) * root)
        energy = backscatter_strength(cosine, segment.diffuse, segment.specular, segment.shininess, law)
        energy *= FIXED_POINT * (segment.weight + segment.weight_rate * x)
        energy *= max(stop - start, 0.0) * per_bin if law == LIGHT else root * length
        if hider == NO_TARGET:
            add_contribution(contributions, labelled.contributor, k, energy, x / labelled.range_ratio, cosine)
        else:
            shadows.energy[hider, k] += energy
        begin = end


@kernel_uncounted
def _note_targets(profile, count, horizon, arrays, sector, plane, zbuffer, cells, contributions):
    """Note the contribution of the nearest target in every cell of the z-buffer, facet by facet as in the sweep."""
    bodies, materials = (arrays.solids, arrays.mesh, arrays.reflectivity), arrays.reflectivity.shape[0]
    law, bin_length = arrays.law, arrays.bin_length
    bed, knot = BedHorizon(profile.x, profile.z, horizon, count), -1
    for c in range(cells):
        if zbuffer.nearest[c] == NO_PRIMITIVE:
            continue
        cell = load_cell(c, bodies, plane, sector.bent, zbuffer, bed, knot)
        knot, row = cell.knot, materials + cell.target
        # A cell that is whole has been met along its beginning, its middle and its end.
        whole = cell.facets == 1 and is_cell_clear(zbuffer, c, bed, knot)
        for k in range(cell.facets):
            facet = cell_facet(zbuffer, c, cell.source)
            if not whole:
                facet = visible_facet(cell.primitive, cell.low, cell.high, k, cell.facets, bed, knot)
            if is_facet_met(facet):
                open_contributor(contributions, row)
                weight = facet_weight(facet, cell.source.gain, sector, arrays.pattern, law)
                span = span_of_sector(facet, cell.bounds, sector, arrays.pattern)
                _note_facet(facet, weight, span, cell.material, row, cell.source.level, law, bin_length, contributions)


@inlined_uncounted
def _note_facet(facet, weight, span, material, row, level, law, bin_length, contributions):
    """Note the contribution of one facet, part by part as in the sweep."""
    curve, x, per_bin = facet_curve(facet), facet.centre * facet.cosine / level, 1.0 / bin_length
    near, centre, far = facet.near * per_bin, facet.centre * per_bin, facet.far * per_bin
    parts, _ = divide_facet(facet, 1.0 - facet.incidence * facet.incidence, material, near, centre, far)
    parts = max(parts, HALVES)
    start = facet.near
    for k in range(parts):
        stop, cosine, energy = part_echo(facet, curve, k, parts, start, weight, material, law, per_bin)
        first, last = widen(start, stop, span)
        spread_contribution(contributions, row, first, last, energy, x, cosine, bin_length)
        start = stop
