"""Echoes of the bed's segments as labels need them: what is heard of each bin's bed, and what targets hide of it.

Theory: docs/theory/sweep.md.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from insonify.compiler.jit import inlined, kernel
from insonify.kernels.common.contributors import ROUNDING, add_contribution, open_contributor, spanned_bins
from insonify.kernels.common.range_bins import FIXED_POINT
from insonify.kernels.common.scattering import backscatter_strength
from insonify.kernels.common.search import last_not_above
from insonify.kernels.common.types import LIGHT
from insonify.kernels.labels.shadows import NO_TARGET, open_shadow, target_of_body
from insonify.kernels.sweep.partial_segments import BedSegment, slant_range
from insonify.kernels.sweep.sweep import load_segment, visible_from
from insonify.kernels.sweep.target_echoes import ground_range_at, launch_angle
from insonify.kernels.targets.angular_zbuffer import NO_PRIMITIVE
from insonify.kernels.targets.occlusion import next_visible, occlusion_of


class LabelledSegment(NamedTuple):
    """A segment of the bed whose echo is labelled."""

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


@kernel
def note_bed(profile, count, arrays, sector, zbuffer, cells, echoes, contributions, shadows):
    """Note the contribution of every visible segment of a profile, and the echo that targets hide of those segments."""
    occlusion = occlusion_of(zbuffer, cells)
    x, z, slope, area, facing = profile.x, profile.z, profile.slope, profile.area, profile.facing
    material, weights, ratios = profile.material, echoes.weight, profile.range_ratio
    law, bin_length = arrays.law, arrays.bin_length
    for i in range(count - 1):
        if not echoes.cut[i] and echoes.energy[i] == 0.0:
            continue
        segment = load_segment(i, x, z, slope, area, facing, material, weights, arrays.reflectivity, sector)
        ratio = 0.5 * (ratios[i] + ratios[i + 1]) if sector.bent else 1.0
        labelled = LabelledSegment(segment, material[i], ratio, law, bin_length)
        open_contributor(contributions, material[i])
        if echoes.cut[i]:
            start = visible_from(segment, x[i], x[i + 1], echoes.launch[i], echoes.horizon[i])
            _note_cut_segment(contributions, shadows, labelled, start, x[i + 1], occlusion, arrays, zbuffer)
        else:
            density = abs(echoes.energy[i])
            _note_whole_segment(contributions, labelled, x[i], x[i + 1], echoes.r[i], echoes.r[i + 1], density)


@inlined
def _note_cut_segment(contributions, shadows, labelled, start, x_to, occlusion, arrays, zbuffer):
    """Note the stretches of a segment that targets leave visible or hide, above the horizon from ``start`` on."""
    segment = labelled.segment
    low, high = launch_angle(segment, start), launch_angle(segment, x_to)
    while low < high:
        opened, closed = next_visible(occlusion, segment, low, high)
        if opened > low:
            stop = x_to if opened >= high else min(max(ground_range_at(segment, opened), start), x_to)
            _note_behind_cells(shadows, labelled, low, opened, start, stop, occlusion.edge, arrays, zbuffer)
            start = stop
        if opened >= high:
            break
        stop = x_to if closed >= high else min(ground_range_at(segment, closed), x_to)
        foot = _foot(segment, start, stop)
        _note_stretch(contributions, labelled, start, foot)
        _note_stretch(contributions, labelled, foot, stop)
        low, start = closed, stop


@inlined
def _note_behind_cells(shadows, labelled, low, high, x_from, x_to, edge, arrays, zbuffer):
    """Note a stretch that targets hide between two launch angles, as hidden by what is nearest in each cell."""
    segment, nearest, body = labelled.segment, zbuffer.nearest, zbuffer.body
    cell = max(last_not_above(edge, low), 0)
    while low < high and cell + 1 < edge.size:
        p = nearest[cell]
        target = target_of_body(arrays.solids, arrays.mesh, body[p]) if p != NO_PRIMITIVE else NO_TARGET
        cell += 1
        while edge[cell] < high and cell + 1 < edge.size:
            p = nearest[cell]
            if p == NO_PRIMITIVE or target_of_body(arrays.solids, arrays.mesh, body[p]) != target:
                break
            cell += 1
        end = min(edge[cell], high)
        stop = x_to if end >= high else min(max(ground_range_at(segment, end), x_from), x_to)
        if target != NO_TARGET:
            open_shadow(shadows, target)
            foot = _foot(segment, x_from, stop)
            _hide_stretch(shadows.energy, target, labelled, x_from, foot)
            _hide_stretch(shadows.energy, target, labelled, foot, stop)
        low, x_from = end, stop


@inlined
def _foot(segment, x_from, x_to):
    """Ground range at which a segment comes nearest: slant range falls towards it and grows beyond."""
    return min(max(-segment.slope * segment.offset / (1.0 + segment.slope * segment.slope), x_from), x_to)


@inlined
def _note_whole_segment(contributions, labelled, x_from, x_to, near, far, density):
    """Note a short segment whose energy is spread evenly over its slant range."""
    segment, who, level, bin_length = labelled.segment, labelled.contributor, labelled.range_ratio, labelled.bin_length
    energy, strongest, per_bin = contributions.energy[who], contributions.strongest[who], 1.0 / bin_length
    a, b = min(near, far), max(near, far)
    first, last = spanned_bins(a, b, per_bin, energy.size, ROUNDING)
    for k in range(first, last):
        start, stop = max(a, k * bin_length), min(b, (k + 1) * bin_length)
        part = density * max(stop - start, 0.0) * per_bin
        energy[k] += part
        if part > strongest[k]:
            r = 0.5 * (start + stop)
            strongest[k] = part
            contributions.x[who, k] = (x_from + (x_to - x_from) * (r - near) / (far - near)) / level
            contributions.cosine[who, k] = -segment.facing / (r * math.sqrt(segment.area))


@kernel
def _note_stretch(contributions, labelled, x_from, x_to):
    """Note a visible stretch of a segment along which slant range grows or falls, bin by bin."""
    if x_to > x_from:
        stretch, who = _stretch(labelled.segment, x_from, x_to), labelled.contributor
        bins = contributions.energy.shape[1]
        first, last = spanned_bins(stretch.near, stretch.far, 1.0 / labelled.bin_length, bins, ROUNDING)
        for k in range(first, last):
            x, cosine, energy = _echo_in_bin(labelled, stretch, k)
            add_contribution(contributions, who, k, energy, x / labelled.range_ratio, cosine)


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


@inlined
def ground_range_at_slant(segment, r, outward):
    """Ground range at which a segment's line has a slant range, beyond the foot of its perpendicular or before it."""
    tilt = 1.0 + segment.slope * segment.slope
    foot = -segment.slope * segment.offset / tilt
    nearest_squared = segment.offset * segment.offset / tilt
    away = math.sqrt(max(r * r - nearest_squared, 0.0) / tilt)
    return foot + away if outward else foot - away
