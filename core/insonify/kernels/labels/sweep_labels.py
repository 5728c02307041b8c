"""Labels of range bins from the sweep: greatest contributor, its place and incidence, and the shadows of targets.

The planes of the sweep are walked once more. Every visible segment and facet adds its energy to the bins it spans,
contributor by contributor: each material of the bed is one, and so is each target. A bin has an echo if it has energy
in the record.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from insonify.compiler.jit import inlined, kernel
from insonify.kernels.common.contributors import (
    ROUNDING,
    add_contribution,
    open_contributor,
    spanned_bins,
    spread_contribution,
)
from insonify.kernels.common.range_bins import FIXED_POINT, RangeBins, accumulate_bins
from insonify.kernels.common.scattering import backscatter_strength
from insonify.kernels.common.types import LIGHT
from insonify.kernels.labels.bed_stretches import BEHIND_TARGET, VISIBLE, empty_stretches, split_segment
from insonify.kernels.labels.shadows import label_shadows, open_shadow
from insonify.kernels.multipath.echo_list import EchoSink
from insonify.kernels.multipath.surface_multipath import add_multipath
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
from insonify.kernels.sweep.sweep import aim_plane, sweep_plane
from insonify.kernels.sweep.target_echoes import BedHorizon, load_cell, visible_facet
from insonify.kernels.targets.angular_zbuffer import NO_PRIMITIVE
from insonify.kernels.targets.occlusion import occlusion_of

HALVES = 2  # least number of parts of a facet; labels add up their energies


class BinLabels(NamedTuple):
    """Labels of each range bin, by ping, side and bin."""

    # Material of the bed, or number of materials + index of a target, offset for each later path; or NOBODY.
    contributor: NDArray[np.int32]
    energy: NDArray[np.float32]  # of that contributor, in units of all bins at that range
    shadow: NDArray[np.float32]  # share of the bed's echo by the direct path that targets hide
    shadow_id: NDArray[np.int16]  # target that hides most of it, -2 where none does
    ground_range: NDArray[np.float32]  # m, NaN where nothing returns
    incidence: NDArray[np.float32]  # rad, NaN where nothing returns
    target_echo: NDArray[np.float32]  # (pings, 2, targets) direct echo of each target over all bins, m² by law SONAR
    caustic: NDArray[np.bool_]  # whether sound near a caustic returns, where an Airy function takes the place of rays


class LabelledSegment(NamedTuple):
    """A segment of the bed and what its echo is labelled with."""

    segment: BedSegment
    contributor: int
    range_ratio: float  # apparent ground range over the true one
    law: int
    bin_length: float


class Stretch(NamedTuple):
    """Part of a segment along which slant range grows or falls throughout."""

    x_from: float  # ground range at which it begins, m
    x_to: float  # and ends
    near: float  # least slant range, m
    far: float  # greatest
    outward: bool  # whether slant range grows with ground range


def empty_labels(pings: int, bins: int, targets: int) -> BinLabels:
    """Make room for the labels of a record."""
    shape = (pings, 2, bins)
    energy, shadow, ground_range, incidence = np.empty((4, *shape), np.float32)
    return BinLabels(
        contributor=np.empty(shape, np.int32),
        energy=energy,
        shadow=shadow,
        shadow_id=np.empty(shape, np.int16),
        ground_range=ground_range,
        incidence=incidence,
        target_echo=np.zeros((pings, 2, targets), np.float32),
        caustic=np.zeros(shape, np.bool_),
    )


def labels_of_pings(labels: BinLabels, first: int, last: int) -> BinLabels:
    """Labels of pings first to last - 1, as views."""
    return BinLabels(*(column[first:last] for column in labels))  # type: ignore[arg-type]


@kernel
def label_swept_pings(arrays, poses, fan, image_fan, apparent, workspace, multipath, contributions, shadows, labels):
    """Label every range bin of pings with its greatest contributor, by the sweep.

    Parameters
    ----------
    arrays, poses : SceneArrays, Poses
        n pings.
    fan, image_fan : AzimuthFan
        Planes of the sonar's beam, and of its image's in the sea surface.
    apparent, workspace, multipath : ApparentTables, SweepWorkspace, MultipathWorkspace
    contributions, shadows : ContributorTable, ShadowTable
        Empty, with a row for every contributor by every path, and one for every target.
    labels : BinLabels
        Of n pings; takes the result.
    """
    bins = RangeBins(np.zeros(arrays.bins + 2, np.int64), arrays.range_decay)
    straight, by_surface = np.zeros((2, arrays.bins), np.float32)
    profile, echoes, zbuffer = workspace.profile, workspace.echoes, workspace.zbuffer
    stretches = empty_stretches(zbuffer)
    for ping in range(poses.x.size):
        grid = prepare_table(apparent, poses.z[ping], workspace.table)
        for side in range(2):
            for k in range(fan.azimuth.size):
                plane, sector, reach = aim_plane(arrays, poses, ping, side, fan, k, grid)
                cells, count = sweep_plane(arrays, plane, sector, reach, grid, workspace, bins)
                _note_bed(profile, count, arrays, sector, zbuffer, cells, echoes, stretches, contributions, shadows)
                _note_targets(profile, count, echoes.horizon, arrays, sector, plane, zbuffer, cells, contributions)
            accumulate_bins(bins, arrays.range_factor, straight)
            if arrays.multipath.enabled:
                sink = EchoSink(bins, contributions, True)
                add_multipath(arrays, poses, ping, side, fan, image_fan, multipath, sink)
                accumulate_bins(bins, arrays.range_factor, by_surface)
            materials = arrays.reflectivity.shape[0]
            label_shadows(shadows, contributions, materials, labels, ping, side)
            sum_target_echoes(contributions, materials, 1.0 / FIXED_POINT, labels.target_echo[ping, side])
            label_bins(contributions, straight, by_surface, labels, ping, side)


@kernel
def sum_target_echoes(contributions, materials, scale, target_echo):
    """Sum the direct echo of each target over all range bins, before the factor that depends on range alone."""
    for target in range(target_echo.size):
        total = 0.0
        if contributions.present[materials + target]:
            for k in range(contributions.energy.shape[1]):
                total += contributions.energy[materials + target, k]
        target_echo[target] = scale * total


@kernel
def label_bins(contributions, straight, by_surface, labels, ping, side):
    """Label each bin of one side with its greatest contributor, and clear the contributions."""
    contributor, energy = labels.contributor[ping, side], labels.energy[ping, side]
    ground_range, incidence = labels.ground_range[ping, side], labels.incidence[ping, side]
    contributor[:], energy[:], ground_range[:], incidence[:] = NO_PRIMITIVE, 0.0, np.nan, np.nan
    for row in range(contributions.present.size):
        if contributions.present[row]:
            for k in range(straight.size):
                best = contributor[k]
                if (
                    straight[k] + by_surface[k] > 0.0
                    and contributions.strongest[row, k] >= 0.0
                    and (best == NO_PRIMITIVE or contributions.energy[row, k] > contributions.energy[best, k])
                ):
                    contributor[k] = row
    for k in range(straight.size):
        if contributor[k] != NO_PRIMITIVE:
            energy[k] = contributions.energy[contributor[k], k]
            ground_range[k] = contributions.x[contributor[k], k]
            incidence[k] = math.acos(min(contributions.cosine[contributor[k], k], 1.0))
    contributions.present[:] = False


@kernel
def _note_bed(profile, count, arrays, sector, zbuffer, cells, echoes, stretches, contributions, shadows):
    """Note the contribution of every visible segment of a profile, and the echo that targets hide of those segments."""
    occlusion = occlusion_of(zbuffer, cells)
    x, z, slope, area, facing = profile.x, profile.z, profile.slope, profile.area, profile.facing
    material, weights, ratios = profile.material, echoes.weight, profile.range_ratio
    for i in range(count - 1):
        if not echoes.cut[i] and echoes.energy[i] == 0.0:
            continue
        segment = load_segment(i, x, z, slope, area, facing, material, weights, arrays.reflectivity, sector)
        ratio = 0.5 * (ratios[i] + ratios[i + 1]) if sector.bent else 1.0
        labelled = LabelledSegment(segment, material[i], ratio, arrays.law, arrays.bin_length)
        open_contributor(contributions, material[i])
        if not echoes.cut[i]:
            density = abs(echoes.energy[i])
            _note_whole_segment(contributions, labelled, x[i], x[i + 1], echoes.r[i], echoes.r[i + 1], density)
            continue
        risen = visible_from(segment, x[i], x[i + 1], echoes.launch[i], echoes.horizon[i])
        n = split_segment(segment, x[i], x[i + 1], risen, occlusion, arrays, zbuffer, stretches)
        _note_stretches(contributions, shadows, labelled, stretches, n)


@inlined
def _note_stretches(contributions, shadows, labelled, stretches, n):
    """Note the visible stretches of a segment, and those that targets hide; neighbours behind one target are one."""
    k = 0
    while k < n:
        state, target, start, stop = stretches.state[k], stretches.hider[k], stretches.x_from[k], stretches.x_to[k]
        k += 1
        while state == BEHIND_TARGET and k < n and stretches.hider[k] == target and stretches.x_from[k] == stop:
            stop, k = stretches.x_to[k], k + 1
        foot = nearest_ground_range(labelled.segment, start, stop)
        if state == VISIBLE:
            _note_stretch(contributions, labelled, start, foot)
            _note_stretch(contributions, labelled, foot, stop)
        elif state == BEHIND_TARGET:
            open_shadow(shadows, target)
            _hide_stretch(shadows.energy, target, labelled, start, foot)
            _hide_stretch(shadows.energy, target, labelled, foot, stop)


@inlined
def _note_whole_segment(contributions, labelled, x_from, x_to, near, far, density):
    """Note a short segment; its energy is spread evenly over its slant range."""
    segment, row, level, bin_length = labelled.segment, labelled.contributor, labelled.range_ratio, labelled.bin_length
    energy, strongest, per_bin = contributions.energy[row], contributions.strongest[row], 1.0 / bin_length
    a, b = min(near, far), max(near, far)
    first, last = spanned_bins(a, b, per_bin, energy.size, ROUNDING)
    for k in range(first, last):
        start, stop = max(a, k * bin_length), min(b, (k + 1) * bin_length)
        part = density * max(stop - start, 0.0) * per_bin
        energy[k] += part
        if part > strongest[k]:
            r = 0.5 * (start + stop)
            strongest[k] = part
            contributions.x[row, k] = (x_from + (x_to - x_from) * (r - near) / (far - near)) / level
            contributions.cosine[row, k] = -segment.facing / (r * math.sqrt(segment.area))


@kernel
def _note_stretch(contributions, labelled, x_from, x_to):
    """Note a visible stretch of a segment along which slant range grows or falls, bin by bin."""
    if x_to > x_from:
        stretch, row = _stretch(labelled.segment, x_from, x_to), labelled.contributor
        bins = contributions.energy.shape[1]
        first, last = spanned_bins(stretch.near, stretch.far, 1.0 / labelled.bin_length, bins, ROUNDING)
        for k in range(first, last):
            x, cosine, energy = _echo_in_bin(labelled, stretch, k)
            add_contribution(contributions, row, k, energy, x / labelled.range_ratio, cosine)


@kernel
def _hide_stretch(hidden, target, labelled, x_from, x_to):
    """Add the echo of a hidden stretch of a segment along which slant range grows or falls to a target's row."""
    if x_to > x_from:
        stretch = _stretch(labelled.segment, x_from, x_to)
        first, last = spanned_bins(stretch.near, stretch.far, 1.0 / labelled.bin_length, hidden.shape[1], 0.0)
        for k in range(first, last):
            _, _, energy = _echo_in_bin(labelled, stretch, k)
            hidden[target, k] += energy


@inlined
def _stretch(segment, x_from, x_to):
    """Stretch of a segment between two ground ranges on one side of its foot."""
    near, far = slant_range(segment, x_from), slant_range(segment, x_to)
    return Stretch(x_from, x_to, min(near, far), max(near, far), far >= near)


@inlined
def _echo_in_bin(labelled, stretch, k):
    """Ground range, cosine of the incidence and energy of what of a stretch lies in range bin k."""
    segment, law, bin_length = labelled.segment, labelled.law, labelled.bin_length
    start, stop = max(stretch.near, k * bin_length), min(stretch.far, (k + 1) * bin_length)
    a = min(max(ground_range_at_slant(segment, start, stretch.outward), stretch.x_from), stretch.x_to)
    b = min(max(ground_range_at_slant(segment, stop, stretch.outward), stretch.x_from), stretch.x_to)
    x, side = 0.5 * (a + b), math.sqrt(segment.area)
    cosine = -segment.facing / (slant_range(segment, x) * side)
    energy = FIXED_POINT * backscatter_strength(cosine, segment.diffuse, segment.specular, segment.shininess, law)
    energy *= segment.weight + segment.weight_rate * x
    energy *= max(stop - start, 0.0) / bin_length if law == LIGHT else side * abs(b - a)
    return x, cosine, energy


@kernel
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
        for k in range(cell.facets):
            facet = visible_facet(cell.primitive, cell.low, cell.high, k, cell.facets, bed, knot)
            if is_facet_met(facet):
                open_contributor(contributions, row)
                weight = facet_weight(facet, cell.source.gain, sector, arrays.pattern, law)
                span = span_of_sector(facet, cell.bounds, sector, arrays.pattern)
                _note_facet(facet, weight, span, cell.material, row, cell.source.level, law, bin_length, contributions)


@inlined
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
