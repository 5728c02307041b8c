"""Labels of range bins from the sweep: greatest contributor, its place and incidence, and the shadows of targets.

Planes are swept as for the record, the intensity of which is found beside its labels. Every visible segment and facet
adds its energy to the bins it spans, contributor by contributor: each material of the bed is one, and so is each
target. A bin has an echo if it has energy in the record.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from insonify.compiler.jit import kernel, kernel_uncounted
from insonify.kernels.common.contributors import contributor_row
from insonify.kernels.common.range_bins import FIXED_POINT, RangeBins
from insonify.kernels.multipath.surface_multipath import add_multipath, empty_shares_of_images
from insonify.kernels.refraction.apparent_positions import prepare_table
from insonify.kernels.sweep.bed_stretches import NO_TARGET
from insonify.kernels.sweep.stretches import StretchSink
from insonify.kernels.sweep.sweep import sweep_side

NO_MATERIAL = NO_PATH = -1


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


@kernel
def label_swept_pings(arrays, poses, laid, image_laid, apparent, contributors, workspace, multipath, sums, out):
    """Label every range bin of pings with its greatest contributor, by the sweep.

    Parameters
    ----------
    arrays, poses : SceneArrays, Poses
        n pings.
    laid, image_laid : LaidPlanes
        Planes of the sonar's beam, and of its image's in the sea surface, of n pings.
    apparent, contributors : ApparentTables, Contributors
    workspace, multipath, sums : SweepWorkspace, MultipathWorkspace, PlaneSums
        The first notes contributors.
    out : LabelledPings
        Of n pings; takes the result.
    """
    bins, contributions = RangeBins(np.zeros(arrays.bins + 2, np.int64), arrays.range_decay), workspace.contributions
    by_surface, materials = np.zeros(arrays.bins, np.float32), arrays.reflectivity.shape[0]
    shares, no_bins = empty_shares_of_images(laid, image_laid), np.zeros(0, np.float32)
    for ping in range(poses.x.size):
        grid, place = prepare_table(apparent, poses.z[ping], workspace.table), out.places[ping]
        for side in range(2):
            intensity, missed = out.traced[place, side], out.errors[place : place + 1, side]
            sweep_side(
                arrays, poses, ping, side, laid, grid, workspace, bins, sums, shares, intensity, missed, no_bins,
            )  # fmt: skip
            if arrays.multipath.enabled:
                sink = StretchSink(bins, contributions, True)
                add_multipath(
                    arrays, poses, ping, side, laid, image_laid, multipath, sink, sums, shares, by_surface, intensity,
                    missed, no_bins,
                )  # fmt: skip
            label_side(contributions, contributors, materials, 1.0 / FIXED_POINT, intensity, out, place, side)


@kernel_uncounted
def label_side(contributions, contributors, materials, scale, intensity, out, place, side):
    """Label one side of one ping with what its contributions tell, and clear them."""
    _label_shadows(contributions, materials, out.labels.shadow[place, side], out.labels.shadow_id[place, side])
    _sum_target_echoes(contributions, materials, scale, out.labels.target_echo[place, side])
    _label_bins(contributions, contributors, intensity, out, place, side)
    contributions.present[:] = False


@kernel_uncounted
def _label_shadows(contributions, materials, share, target):
    """Label each bin with the share of the bed's echo that targets hide, and with the target that hides most.

    Bed that a target hides would return an echo without the targets: the *hidden echo*, weighted by the beam like any
    other. Its share is taken of the echo that the whole bed would return without the targets. Bed that other bed hides
    returns nothing either way and does not count.
    """
    share[:], target[:] = 0.0, NO_TARGET
    first, present, energy = contributions.first_hidden, contributions.present, contributions.energy
    for row in range(first, present.size):
        for k in range(share.size if present[row] else 0):
            if energy[row, k] > 0.0:
                share[k] += energy[row, k]
                if target[k] == NO_TARGET or energy[row, k] > energy[first + target[k], k]:
                    target[k] = row - first
    for k in range(share.size):
        if share[k] > 0.0:
            seen = 0.0  # echo of the visible bed by the direct path
            for row in range(materials):
                if present[row]:
                    seen += energy[row, k]
            share[k] /= share[k] + seen


@kernel_uncounted
def _sum_target_echoes(contributions, materials, scale, target_echo):
    """Sum the direct echo of each target over all range bins, before the factor that depends on range alone."""
    for target in range(target_echo.size):
        total = 0.0
        if contributions.present[materials + target]:
            for k in range(contributions.energy.shape[1]):
                total += contributions.energy[materials + target, k]
        target_echo[target] = scale * total


@kernel_uncounted
def _label_bins(contributions, contributors, intensity, out, place, side):
    """Label each bin of one side of one ping with its greatest contributor."""
    labels, energy = out.labels, out.energy[place, side]
    target, material, path = labels.target_id[place, side], labels.material[place, side], labels.path[place, side]
    ground_range, cosine = labels.ground_range[place, side], labels.incidence[place, side]
    target[:], material[:], path[:] = NO_TARGET, NO_MATERIAL, NO_PATH
    energy[:], ground_range[:], cosine[:] = 0.0, np.nan, np.nan
    for row in range(contributions.first_hidden):
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
