"""Labels of range bins from the sweep: greatest contributor, its place and incidence, and whether bed is hidden.

The planes of the sweep are walked once more. Every visible segment and facet adds its energy to the bins it spans,
contributor by contributor: each material of the bed is one, and so is each target. Whether a bin holds an echo at all
the sweep's own bins decide.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from insonify.kernels.common.contributors import (
    ROUNDING,
    add_contribution,
    open_contributor,
    spanned_bins,
    spread_contribution,
)
from insonify.kernels.common.jit import inlined, kernel
from insonify.kernels.common.range_bins import FIXED_POINT, accumulate_bins
from insonify.kernels.common.scattering import backscatter_strength
from insonify.kernels.common.types import LIGHT
from insonify.kernels.multipath.echo_list import EchoSink
from insonify.kernels.multipath.surface_multipath import add_multipath
from insonify.kernels.refraction.apparent_positions import prepare_table
from insonify.kernels.sweep.facets import divide_facet, facet_curve, facet_weight, is_facet_met, part_echo
from insonify.kernels.sweep.partial_segments import BedSegment, slant_range
from insonify.kernels.sweep.sweep import aim_plane, load_segment, sweep_plane, visible_from
from insonify.kernels.sweep.target_echoes import (
    BedHorizon,
    count_facets,
    ground_range_at,
    knot_before,
    launch_angle,
    primitive_material,
    visible_facet,
)
from insonify.kernels.targets.angular_zbuffer import NO_PRIMITIVE
from insonify.kernels.targets.apparent_targets import load_apparent_source
from insonify.kernels.targets.occlusion import next_visible, occlusion_of
from insonify.kernels.targets.primitives import load_primitive

HALVES = 2  # parts of a facet at least, whose energies its labels add up


class BinLabels(NamedTuple):
    """Labels of each range bin, by ping, side and bin."""

    # Material of the bed, or number of materials + index of a target, offset for each later path; or NOBODY.
    contributor: NDArray[np.int32]
    energy: NDArray[np.float32]  # of that contributor, in units of all bins at that range
    shadow: NDArray[np.bool_]  # whether bed lies there, hidden, and nothing returns by the direct path
    ground_range: NDArray[np.float32]  # m, NaN where nothing returns
    incidence: NDArray[np.float32]  # rad, NaN where nothing returns
    caustic: NDArray[np.bool_]  # whether a ray at a caustic returns, whose tube's width is bounded from below


def empty_labels(pings: int, bins: int) -> BinLabels:
    """Make room for the labels of a record.

    Parameters
    ----------
    pings, bins : int

    Returns
    -------
    BinLabels
    """
    shape = (pings, 2, bins)
    contributor, shadow = np.empty(shape, np.int32), np.empty(shape, np.bool_)
    caustic = np.zeros(shape, np.bool_)
    energy, ground_range, incidence = np.empty((3, *shape), np.float32)
    return BinLabels(contributor, energy, shadow, ground_range, incidence, caustic)


def labels_of_pings(labels: BinLabels, first: int, last: int) -> BinLabels:
    """Labels of pings first to last - 1, as views.

    Parameters
    ----------
    labels : BinLabels
    first, last : int

    Returns
    -------
    BinLabels
    """
    contributor, energy, shadow, ground_range, incidence, caustic = (column[first:last] for column in labels)
    return BinLabels(contributor, energy, shadow, ground_range, incidence, caustic)  # type: ignore[arg-type]


class LabelledSegment(NamedTuple):
    """A segment of the bed whose echo is labelled."""

    segment: BedSegment
    contributor: int
    range_ratio: float  # apparent ground range over the true one
    law: int
    bin_length: float


@kernel
def label_swept_pings(arrays, poses, fan, image_fan, apparent, workspace, multipath, contributions, labels):
    """Label every range bin of pings with its greatest contributor, by the sweep.

    Parameters
    ----------
    arrays : SceneArrays
    poses : Poses
        n pings.
    fan, image_fan : AzimuthFan
        Planes of the sonar's beam, and of its image's in the sea surface.
    apparent : ApparentTables
    workspace : SweepWorkspace
    multipath : MultipathWorkspace
    contributions : ContributorTable
        Empty, with a row for every contributor by every path.
    labels : BinLabels
        Of n pings; takes the result.

    Returns
    -------
    int
        0, or -1 - k if the sonar is inside body k.
    """
    bins = np.zeros(arrays.bins + 2, np.int64)
    straight, by_surface = np.zeros((2, arrays.bins), np.float32)
    profile, echoes, zbuffer = workspace.profile, workspace.echoes, workspace.zbuffer
    for ping in range(poses.x.size):
        grid = prepare_table(apparent, poses.z[ping], workspace.table)
        for side in range(2):
            for k in range(fan.azimuth.size):
                plane, sector, reach = aim_plane(arrays, poses, ping, side, fan, k, grid)
                cells, count = sweep_plane(arrays, plane, sector, reach, grid, workspace, bins)
                if cells < 0:
                    return cells
                _note_bed(profile, count, arrays, sector, zbuffer, cells, echoes, contributions)
                _note_targets(profile, count, echoes.horizon, arrays, sector, plane, zbuffer, cells, contributions)
            accumulate_bins(bins, arrays.range_factor, straight)
            if arrays.multipath.enabled:
                sink = EchoSink(bins, contributions, True)
                add_multipath(arrays, poses, ping, side, fan, image_fan, multipath, sink)
                accumulate_bins(bins, arrays.range_factor, by_surface)
            label_bins(contributions, straight, by_surface, labels, ping, side)
    return 0


@kernel
def label_bins(contributions, straight, by_surface, labels, ping, side):
    """Label each bin of one side with its greatest contributor, and clear the contributions.

    Parameters
    ----------
    contributions : ContributorTable
        Cleared.
    straight, by_surface : ndarray of float, shape (bins,)
        Intensities of the direct path and of those by the sea surface.
    labels : BinLabels
        Takes the result.
    ping, side : int
    """
    contributor, energy, shadow = labels.contributor[ping, side], labels.energy[ping, side], labels.shadow[ping, side]
    ground_range, incidence = labels.ground_range[ping, side], labels.incidence[ping, side]
    contributor[:], energy[:], ground_range[:], incidence[:] = NO_PRIMITIVE, 0.0, np.nan, np.nan
    for who in range(contributions.present.size):
        if contributions.present[who]:
            for k in range(straight.size):
                best = contributor[k]
                if (
                    straight[k] + by_surface[k] > 0.0
                    and contributions.strongest[who, k] >= 0.0
                    and (best == NO_PRIMITIVE or contributions.energy[who, k] > contributions.energy[best, k])
                ):
                    contributor[k] = who
    for k in range(straight.size):
        shadow[k] = contributions.hidden[k] and not straight[k] > 0.0
        if contributor[k] != NO_PRIMITIVE:
            energy[k] = contributions.energy[contributor[k], k]
            ground_range[k] = contributions.x[contributor[k], k]
            incidence[k] = math.acos(min(contributions.cosine[contributor[k], k], 1.0))
    contributions.present[:] = False
    contributions.hidden[:] = False


@kernel
def _note_bed(profile, count, arrays, sector, zbuffer, cells, echoes, contributions):
    """Note the contribution of every visible segment of a profile, and mark the bins that hidden bed spans."""
    occlusion = occlusion_of(zbuffer, cells)
    x, z, slope, area, material = profile.x, profile.z, profile.slope, profile.area, profile.material
    weights, ratios, law, bin_length = echoes.weight, profile.range_ratio, arrays.law, arrays.bin_length
    for i in range(count - 1):
        segment = load_segment(i, x, z, slope, area, material, weights, arrays.reflectivity, sector)
        ratio = 0.5 * (ratios[i] + ratios[i + 1]) if sector.bent else 1.0
        labelled = LabelledSegment(segment, material[i], ratio, law, bin_length)
        if echoes.cut[i]:
            open_contributor(contributions, material[i])
            start = visible_from(segment, x[i], x[i + 1], echoes.launch[i], echoes.horizon[i])
            _note_partial_segment(contributions, labelled, x[i], start, x[i + 1], occlusion)
        elif echoes.energy[i] != 0.0:
            open_contributor(contributions, material[i])
            density = abs(echoes.energy[i])
            _note_whole_segment(contributions, labelled, x[i], x[i + 1], echoes.r[i], echoes.r[i + 1], density)
        elif not echoes.launch[i + 1] > echoes.horizon[i]:
            _mark_hidden(segment, x[i], x[i + 1], bin_length, contributions.hidden)


@kernel
def _note_partial_segment(contributions, labelled, x_from, start, x_to, occlusion):
    """Note the visible stretches of a segment above the horizon from ``start`` on, and mark the hidden ones between."""
    segment, bin_length, seen_to = labelled.segment, labelled.bin_length, x_from
    low, high = launch_angle(segment, start), launch_angle(segment, x_to)
    while low < high:
        opened, closed = next_visible(occlusion, segment, low, high)
        if opened >= high:
            break
        start = start if opened <= low else max(ground_range_at(segment, opened), start)
        stop = x_to if closed >= high else min(ground_range_at(segment, closed), x_to)
        _mark_hidden(segment, seen_to, start, bin_length, contributions.hidden)
        # Slant range falls towards the foot of the perpendicular and grows beyond it.
        foot = _foot(segment, start, stop)
        _note_stretch(contributions, labelled, start, foot)
        _note_stretch(contributions, labelled, foot, stop)
        low, start, seen_to = closed, stop, stop
    _mark_hidden(segment, seen_to, x_to, bin_length, contributions.hidden)


@inlined
def _foot(segment, x_from, x_to):
    """Ground range at which a segment comes nearest."""
    return min(max(-segment.slope * segment.offset / (1.0 + segment.slope * segment.slope), x_from), x_to)


@kernel
def _mark_hidden(segment, x_from, x_to, bin_length, hidden):
    """Mark the bins spanned by a hidden stretch of a segment inside the beam."""
    start, stop = slant_range(segment, x_from), slant_range(segment, x_to)
    if x_to > x_from and segment.weight + segment.weight_rate * 0.5 * (x_from + x_to) > 0.0:
        nearest = slant_range(segment, _foot(segment, x_from, x_to))
        first, last = spanned_bins(nearest, max(start, stop), 1.0 / bin_length, hidden.size, -ROUNDING)
        hidden[first:last] = True


@inlined
def _note_whole_segment(contributions, labelled, x_from, x_to, near, far, density):
    """Note a short segment whose energy is spread evenly over its slant range."""
    segment, who, level, bin_length = labelled.segment, labelled.contributor, labelled.range_ratio, labelled.bin_length
    energy, strongest, per_bin = contributions.energy[who], contributions.strongest[who], 1.0 / bin_length
    a, b = min(near, far), max(near, far)
    first, last = spanned_bins(a, b, per_bin, contributions.hidden.size, ROUNDING)
    for k in range(first, last):
        start, stop = max(a, k * bin_length), min(b, (k + 1) * bin_length)
        part = density * max(stop - start, 0.0) * per_bin
        energy[k] += part
        if part > strongest[k]:
            r = 0.5 * (start + stop)
            strongest[k] = part
            contributions.x[who, k] = (x_from + (x_to - x_from) * (r - near) / (far - near)) / level
            contributions.cosine[who, k] = -segment.offset / (r * math.sqrt(segment.area))


@kernel
def _note_stretch(contributions, labelled, x_from, x_to):
    """Note a stretch of a segment along which slant range grows or falls, bin by bin."""
    if not x_to > x_from:
        return
    segment, law, bin_length = labelled.segment, labelled.law, labelled.bin_length
    near, far = slant_range(segment, x_from), slant_range(segment, x_to)
    outward = far >= near
    near, far = min(near, far), max(near, far)
    first, last = spanned_bins(near, far, 1.0 / bin_length, contributions.hidden.size, ROUNDING)
    stretch = math.sqrt(segment.area)
    for k in range(first, last):
        start, stop = max(near, k * bin_length), min(far, (k + 1) * bin_length)
        a = min(max(_ground_range_at_slant(segment, start, outward), x_from), x_to)
        b = min(max(_ground_range_at_slant(segment, stop, outward), x_from), x_to)
        x = 0.5 * (a + b)
        r = slant_range(segment, x)
        cosine = -segment.offset / (r * stretch)
        energy = FIXED_POINT * backscatter_strength(cosine, segment.diffuse, segment.specular, segment.shininess, law)
        energy *= segment.weight + segment.weight_rate * x
        energy *= max(stop - start, 0.0) / bin_length if law == LIGHT else stretch * abs(b - a)
        add_contribution(contributions, labelled.contributor, k, energy, x / labelled.range_ratio, cosine)


@inlined
def _ground_range_at_slant(segment, r, outward):
    """Ground range at which a segment's line has a slant range, beyond the foot of its perpendicular or before it."""
    tilt = 1.0 + segment.slope * segment.slope
    foot = -segment.slope * segment.offset / tilt
    nearest_squared = segment.offset * segment.offset / tilt
    away = math.sqrt(max(r * r - nearest_squared, 0.0) / tilt)
    return foot + away if outward else foot - away


@kernel
def _note_targets(profile, knots, horizon, arrays, sector, plane, zbuffer, cells, contributions):
    """Note the contribution of the nearest target in every cell of the z-buffer, facet by facet as in the sweep."""
    solids, mesh, table, pattern = arrays.solids, arrays.mesh, arrays.reflectivity, arrays.pattern
    law, bin_length, bodies = arrays.law, arrays.bin_length, solids.shape.size
    bed, knot = BedHorizon(profile.x, profile.z, horizon, knots), -1
    for cell in range(cells):
        p = zbuffer.nearest[cell]
        if p == NO_PRIMITIVE:
            continue
        body, row = zbuffer.body[p], primitive_material(solids, mesh, zbuffer, p)
        who = table.shape[0] + (solids.target[body] if body < bodies else mesh.target[body - bodies])
        material = table[row, 0], table[row, 1], table[row, 2]
        facets, centre = count_facets(zbuffer, cell)
        knot = knot_before(bed, centre, knot)
        source = load_apparent_source(sector.bent, zbuffer.source[p])
        primitive = load_primitive(solids, mesh, plane, body, zbuffer.line[p], source)
        low, high = zbuffer.edge[cell], zbuffer.edge[cell + 1]
        for k in range(facets):
            facet = visible_facet(primitive, low, high, k, facets, bed, knot)
            if is_facet_met(facet):
                open_contributor(contributions, who)
                weight = facet_weight(facet, source.gain, sector, pattern, law)
                _note_facet(facet, weight, material, who, source.level, law, bin_length, contributions)


@inlined
def _note_facet(facet, weight, material, who, level, law, bin_length, contributions):
    """Note the contribution of one facet, part by part as in the sweep."""
    curve, x, per_bin = facet_curve(facet), facet.centre * facet.cosine / level, 1.0 / bin_length
    near, centre, far = facet.near * per_bin, facet.centre * per_bin, facet.far * per_bin
    parts, _ = divide_facet(facet, 1.0 - facet.incidence * facet.incidence, material, near, centre, far)
    parts = max(parts, HALVES)
    start = facet.near
    for k in range(parts):
        stop, cosine, energy = part_echo(facet, curve, k, parts, start, weight, material, law, per_bin)
        spread_contribution(contributions, who, start, stop, energy, x, cosine, bin_length)
        start = stop
