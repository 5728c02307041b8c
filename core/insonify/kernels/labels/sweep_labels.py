"""Labels of range bins from the sweep: greatest contributor, its place and incidence, and the shadows of targets.

The planes of the sweep are walked once more. Every visible segment and facet adds its energy to the bins it spans,
contributor by contributor: each material of the bed is one, and so is each target. Whether a bin holds an echo at all
the sweep's own bins decide.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from insonify.compiler.jit import inlined, kernel
from insonify.kernels.common.contributors import open_contributor, spread_contribution
from insonify.kernels.common.range_bins import FIXED_POINT, accumulate_bins
from insonify.kernels.labels.bed_labels import note_bed
from insonify.kernels.labels.shadows import label_shadows, target_of_body
from insonify.kernels.multipath.echo_list import EchoSink
from insonify.kernels.multipath.surface_multipath import add_multipath
from insonify.kernels.refraction.apparent_positions import prepare_table
from insonify.kernels.sweep.facets import divide_facet, facet_curve, facet_weight, is_facet_met, part_echo
from insonify.kernels.sweep.sweep import aim_plane, sweep_plane
from insonify.kernels.sweep.target_echoes import (
    BedHorizon,
    count_facets,
    knot_before,
    primitive_material,
    visible_facet,
)
from insonify.kernels.targets.angular_zbuffer import NO_PRIMITIVE
from insonify.kernels.targets.apparent_targets import load_apparent_source
from insonify.kernels.targets.primitives import load_primitive

HALVES = 2  # parts of a facet at least, whose energies its labels add up


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
    caustic: NDArray[np.bool_]  # whether a ray at a caustic returns, whose tube's width is bounded from below


def empty_labels(pings: int, bins: int, targets: int) -> BinLabels:
    """Make room for the labels of a record.

    Parameters
    ----------
    pings, bins, targets : int

    Returns
    -------
    BinLabels
    """
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
    """Labels of pings first to last - 1, as views.

    Parameters
    ----------
    labels : BinLabels
    first, last : int

    Returns
    -------
    BinLabels
    """
    return BinLabels(*(column[first:last] for column in labels))  # type: ignore[arg-type]


@kernel
def label_swept_pings(arrays, poses, fan, image_fan, apparent, workspace, multipath, contributions, shadows, labels):
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
    shadows : ShadowTable
        Empty, with a row for every target.
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
                note_bed(profile, count, arrays, sector, zbuffer, cells, echoes, contributions, shadows)
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
    return 0


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
        if contributor[k] != NO_PRIMITIVE:
            energy[k] = contributions.energy[contributor[k], k]
            ground_range[k] = contributions.x[contributor[k], k]
            incidence[k] = math.acos(min(contributions.cosine[contributor[k], k], 1.0))
    contributions.present[:] = False


@kernel
def _note_targets(profile, knots, horizon, arrays, sector, plane, zbuffer, cells, contributions):
    """Note the contribution of the nearest target in every cell of the z-buffer, facet by facet as in the sweep."""
    solids, mesh, table, pattern = arrays.solids, arrays.mesh, arrays.reflectivity, arrays.pattern
    law, bin_length = arrays.law, arrays.bin_length
    bed, knot = BedHorizon(profile.x, profile.z, horizon, knots), -1
    for cell in range(cells):
        p = zbuffer.nearest[cell]
        if p == NO_PRIMITIVE:
            continue
        body, row = zbuffer.body[p], primitive_material(solids, mesh, zbuffer, p)
        who = table.shape[0] + target_of_body(solids, mesh, body)
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
