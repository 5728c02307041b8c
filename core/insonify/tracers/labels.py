"""Labels of a record by the geometry of the sweep: target, material and path of every range bin."""

import math
from typing import Any

import numpy as np

from insonify.arrays import Floats, Integers, Singles
from insonify.kernels.common.contributors import ContributorTable, empty_contributor_table
from insonify.kernels.common.range_bins import FIXED_POINT
from insonify.kernels.common.types import BED, Poses, SceneArrays
from insonify.kernels.labels.refracted_labels import label_refracted_pings
from insonify.kernels.labels.sweep_labels import NO_MATERIAL, NO_PATH, Contributors, LabelledPings, label_swept_pings
from insonify.kernels.labels.sweep_labels import RecordLabels as RecordLabels
from insonify.kernels.multipath.surface_multipath import empty_multipath_workspace
from insonify.kernels.sweep.bed_stretches import NO_TARGET
from insonify.kernels.sweep.image_paths import PATH_COUNT, SURFACE_ECHO
from insonify.kernels.sweep.plane_errors import empty_plane_sums
from insonify.kernels.sweep.sweep import empty_sweep_workspace
from insonify.packing.apparent_tables import make_apparent_tables
from insonify.packing.containment import refuse_sonar_in_target
from insonify.packing.packed_scene import without_targets
from insonify.parallel import PerThread
from insonify.tow.poses import take_poses
from insonify.tracers.azimuth_fan import lay_planes_of_images
from insonify.tracers.base import new_record, share_blocks
from insonify.tracers.plane_counts import AS_ESTIMATED, Trust, empty_squares
from insonify.tracers.sweep import pings_a_thread, trace
from insonify.tracers.target_planes import find_pings_met

PATHS = ("direct", "surface_bottom", "surface_bottom_surface", "second_bottom", "surface", "crosstalk")


def trace_labels(
    arrays: SceneArrays,
    poses: Poses,
    *,
    planes: int | Integers = 16,
    across: int | Integers = 0,
    rays: int = 4000,
    crosstalk: float = 0.0,
    volumes: Singles | None = None,
    echoes: Singles | None = None,
    squares: Floats | None = None,
    targets_alone: bool = False,
    threads: int | None = None,
    trust: Trust = AS_ESTIMATED,
) -> RecordLabels:
    """Label every range bin of every ping, for an ideal pulse: where an echo begins.

    ``echoes`` takes the intensity that `sweep.trace` finds, beneath waves only by rounding, ``squares`` the squares of
    the errors of planes. With ``targets_alone`` pings that meet no target have the bed wherever there is an echo, of no
    place, incidence and material.
    """
    refuse_sonar_in_target(arrays, poses)
    planes, across = (np.broadcast_to(np.asarray(number, np.int64), poses.x.shape) for number in (planes, across))
    labels, described = empty_labels(poses.x.size, arrays.bins, count_targets(arrays)), describe_contributors(arrays)
    energy, traced = new_record(arrays, poses), new_record(arrays, poses) if echoes is None else echoes
    apparent, folded = make_apparent_tables(arrays, poses)
    rooms = PerThread(
        lambda: (
            empty_sweep_workspace(arrays, apparent, contributions=empty_contributions(arrays)),
            empty_multipath_workspace(arrays),
            empty_plane_sums(arrays.bins),
        )
    )
    missed = empty_squares(0) if squares is None else squares

    def trace_some(places: Integers) -> Singles:
        own = None if squares is None else empty_squares(places.size)
        settings: dict[str, Any] = {"rays": rays, "threads": threads, "squares": own, "trust": trust}
        found = trace(arrays, take_poses(poses, places), planes=planes[places], across=across[places], **settings)
        if squares is not None:
            squares[places] = own
        return found

    by_rays, clear = np.flatnonzero(folded), np.flatnonzero(~folded)
    if by_rays.size > 0:
        _follow_rays(arrays, poses, rays, described, LabelledPings(labels, energy, traced, missed, by_rays), threads)
        if echoes is not None:
            echoes[by_rays] = trace_some(by_rays)
    laid, image_laid = lay_planes_of_images(arrays, take_poses(poses, clear), planes[clear], across[clear])
    if targets_alone:
        met = find_pings_met(arrays, take_poses(poses, clear), laid)
        others, clear, laid, image_laid = clear[~met], clear[met], laid.of_pings(met), image_laid.of_pings(met)
        if others.size > 0:
            traced[others] = trace_some(others)
            _label_bed(labels, energy, others, traced[others])

    def sweep(part: Poses, first: int, last: int) -> None:
        out = LabelledPings(labels, energy, traced, missed, clear[first:last])
        beams = (own.of_pings(slice(first, last)) for own in (laid, image_laid))
        label_swept_pings(arrays, part, *beams, apparent, described, *rooms.own, out)

    share_blocks(take_poses(poses, clear), sweep, threads, pings_a_thread(laid))
    if squares is not None:
        squares[clear, :, :, 0] *= np.square(trust.of(arrays, take_poses(poses, clear), laid))[:, None, None]
    turn_into_degrees(labels.incidence)
    return _label_beside(labels, energy, arrays.range_factor, crosstalk, volumes)


def _follow_rays(
    arrays: SceneArrays, poses: Poses, rays: int, described: Contributors, out: LabelledPings, threads: int | None
) -> None:
    """Label pings that several rays reach, or none, by rays."""
    bare, places = without_targets(arrays), out.places

    def follow(part: Poses, first: int, last: int) -> None:
        own = out._replace(places=places[first:last])
        label_refracted_pings(arrays, bare, part, rays, described, empty_contributions(arrays), own)

    share_blocks(take_poses(poses, places), follow, threads)
    out.energy[places] *= FIXED_POINT  # rays count in plain units


def _label_beside(
    labels: RecordLabels, energy: Singles, range_factor: Floats, crosstalk: float, volumes: Singles | None
) -> RecordLabels:
    """Label bins in which crosstalk or a volume is louder than what is swept."""
    if crosstalk > 0.0:
        labels = _label_crosstalk(labels, energy, crosstalk)
    if volumes is not None:
        greatest = np.maximum(energy, crosstalk * energy[:, ::-1]) * (range_factor / FIXED_POINT)
        _label_volumes(labels, volumes, greatest, crosstalk)
    return labels


def _label_crosstalk(labels: RecordLabels, energy: Singles, crosstalk: float) -> RecordLabels:
    """Label bins with the other side's contributor wherever its crosstalk exceeds the side's own echo."""
    leaked: dict[str, Any] = {}
    louder = crosstalk * energy[:, ::-1] > energy
    for name in ("target_id", "material", "ground_range", "incidence", "path", "caustic"):
        leaked[name] = np.where(louder, getattr(labels, name)[:, ::-1], getattr(labels, name))
    leaked["path"][louder] = PATHS.index("crosstalk")
    return labels._replace(**leaked)


def _label_volumes(labels: RecordLabels, volumes: Singles, greatest: Floats, crosstalk: float) -> None:
    """Label bins with the volume of the greatest echo, where that exceeds the contributor's."""
    for number, own in enumerate(volumes):
        received = np.maximum(own, crosstalk * own[:, ::-1])
        labels.volume_id[received > greatest] = number
        greatest = np.maximum(received, greatest)


def empty_labels(pings: int, bins: int, targets: int) -> RecordLabels:
    """Make room for the labels of a record: none by a caustic or of a volume, and no echo of targets."""
    shape = (pings, 2, bins)
    (target, material, shadow_id), path = np.empty((3, *shape), np.int16), np.empty(shape, np.int8)
    (shadow, ground_range, incidence), volume = np.empty((3, *shape), np.float32), np.full(shape, NO_TARGET, np.int16)
    target_echo, caustic = np.zeros((pings, 2, targets), np.float32), np.zeros(shape, np.bool_)
    return RecordLabels(
        target, material, shadow, shadow_id, ground_range, incidence, path, volume, caustic, target_echo
    )


def _label_bed(labels: RecordLabels, energy: Singles, places: Integers, echoes: Singles) -> None:
    """Label the pings that meet the bed alone, without the places of their echoes."""
    has_echo = echoes > 0.0
    labels.target_id[places] = np.where(has_echo, BED, NO_TARGET)
    labels.material[places], labels.path[places] = np.where(has_echo, 0, NO_MATERIAL), np.where(has_echo, 0, NO_PATH)
    labels.shadow[places], labels.shadow_id[places], energy[places] = 0.0, NO_TARGET, 0.0
    labels.ground_range[places] = labels.incidence[places] = np.nan


def turn_into_degrees(cosines: Singles) -> None:
    """Turn cosines into angles in degrees, in place."""
    np.arccos(np.minimum(cosines, np.float32(1.0), out=cosines), out=cosines)
    np.multiply(cosines, np.float32(180.0 / math.pi), out=cosines)


def empty_contributions(arrays: SceneArrays) -> ContributorTable:
    """Room for the contributions to one side of a ping."""
    paths, targets = PATH_COUNT if arrays.multipath.enabled else 1, count_targets(arrays)
    return empty_contributor_table(arrays.reflectivity.shape[0], targets, paths, arrays.bins)


def count_targets(arrays: SceneArrays) -> int:
    """Count the declared targets."""
    return 1 + max(int(bodies.target.max(initial=-1)) for bodies in (arrays.solids, arrays.mesh))


def count_contributors(arrays: SceneArrays) -> int:
    """Count the contributors by one path: materials of the bed, then targets."""
    return arrays.reflectivity.shape[0] + count_targets(arrays)


def contributor_materials(arrays: SceneArrays) -> Integers:
    """Row of the reflectivity table of each contributor by one path."""
    rows, material = arrays.reflectivity.shape[0], np.arange(count_contributors(arrays))
    for bodies in (arrays.solids, arrays.mesh):
        material[rows + bodies.target] = bodies.material
    return material


def describe_contributors(arrays: SceneArrays) -> Contributors:
    """Describe the contributors by every path: their targets and materials, none of the sea surface."""
    path, contributor = np.divmod(np.arange(count_contributors(arrays) * PATH_COUNT), count_contributors(arrays))
    rows, of_scene = arrays.reflectivity.shape[0], path != SURFACE_ECHO
    target = np.where(contributor >= rows, contributor - rows, BED)
    return Contributors(
        np.where(of_scene, target, NO_TARGET).astype(np.int16),
        np.where(of_scene, contributor_materials(arrays)[contributor], NO_MATERIAL).astype(np.int16),
        path.astype(np.int8),
    )
