"""Labels of a record by the geometry of the sweep: target, material and path of every range bin."""

import math
from functools import partial
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from insonify.arrays import Booleans, Integers, Singles
from insonify.kernels.common.contributors import ContributorTable, empty_contributor_table
from insonify.kernels.common.range_bins import FIXED_POINT
from insonify.kernels.common.types import BED, Poses, SceneArrays
from insonify.kernels.labels.refracted_labels import label_refracted_pings
from insonify.kernels.labels.shadows import NO_TARGET, ShadowTable, empty_shadow_table
from insonify.kernels.labels.sweep_labels import (
    NO_MATERIAL,
    NO_PATH,
    BinLabels,
    Contributors,
    empty_labels,
    label_swept_pings,
)
from insonify.kernels.multipath.image_sources import PATH_COUNT, SURFACE_ECHO
from insonify.kernels.multipath.surface_multipath import empty_multipath_workspace
from insonify.kernels.refraction.apparent_positions import ApparentTables
from insonify.kernels.sweep.sweep import AzimuthFan, empty_sweep_workspace
from insonify.packing.apparent_tables import make_apparent_tables
from insonify.packing.containment import refuse_sonar_in_target
from insonify.packing.packed_scene import without_targets
from insonify.parallel import PerThread
from insonify.tow.poses import take_poses
from insonify.tracers.azimuth_fan import lay_planes_of_images
from insonify.tracers.base import new_record, share_blocks
from insonify.tracers.sweep import pings_a_thread, trace
from insonify.tracers.target_planes import find_pings_met

NOTHING = NO_TARGET  # target of a bin without an echo, or without a shadow
PATHS = ("direct", "surface_bottom", "surface_bottom_surface", "second_bottom", "surface", "crosstalk")


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
    shadow: Singles
    shadow_id: NDArray[np.int16]  # index of the declared target that hides most of it, -2 where none hides any
    ground_range: Singles  # of the contributor's strongest echo, in metres; NaN without an echo
    # Of that echo on its surface, from the normal, in degrees, the greater of two if sound comes and goes by
    # different paths; NaN without an echo.
    incidence: Singles
    path: NDArray[np.int8]  # place of that contributor's propagation path among `PATHS`, -1 without an echo
    # Index of the declared volume of the water column with the greatest mean echo, if that exceeds the contributor's;
    # else -2.
    volume_id: NDArray[np.int16]
    # Whether the echo comes by a caustic of the water: ray theory does not give its intensity, and the ray tubes
    # count as no narrower than Airy's function allows.
    caustic: Booleans
    # Of each target, up to the last that is modelled: its echo by the direct path over all bins, weighted by the
    # beam, without spreading and absorption. By law `sonar` a backscattering cross-section in m².
    target_echo: Singles


def trace_labels(
    arrays: SceneArrays,
    poses: Poses,
    *,
    planes: int = 16,
    across: int = 0,
    rays: int = 4000,
    crosstalk: float = 0.0,
    volumes: Singles | None = None,
    echoes: Singles | None = None,
    targets_alone: bool = False,
    threads: int | None = None,
) -> RecordLabels:
    """Label every range bin of every ping, for an ideal pulse: where an echo begins.

    ``echoes`` takes those by the direct path, as the sweep traces them. With ``targets_alone`` pings that meet no
    target have the bed wherever there is an echo, of no place, incidence and material.
    """
    refuse_sonar_in_target(arrays, poses)
    found, described = empty_labels(poses.x.size, arrays.bins, count_targets(arrays)), describe_contributors(arrays)
    apparent, folded = make_apparent_tables(arrays, poses)
    rooms = PerThread(lambda: _make_room(arrays, apparent))
    trace_some = partial(trace, arrays, planes=planes, across=across, rays=rays, threads=threads)
    traced = new_record(arrays, poses) if echoes is None else echoes
    by_rays = np.flatnonzero(folded)
    if by_rays.size > 0:
        bare = without_targets(arrays)

        def follow_rays(part: Poses, first: int, last: int) -> None:
            table, shadows = empty_tables(arrays)
            label_refracted_pings(arrays, bare, part, rays, described, table, shadows, found, by_rays[first:last])

        share_blocks(take_poses(poses, by_rays), follow_rays, threads)
        found.energy[by_rays] *= FIXED_POINT  # rays count in plain units
        if echoes is not None:
            echoes[by_rays] = trace_some(take_poses(poses, by_rays))
    clear = np.flatnonzero(~folded)
    for among, *beams in lay_planes_of_images(arrays, take_poses(poses, clear), planes, across):
        places = clear[among]
        if targets_alone:
            met = find_pings_met(arrays, take_poses(poses, places), beams[0])
            if not met.all():
                others = places[~met]
                traced[others] = trace_some(take_poses(poses, others))
                _label_bed(found, others, traced[others])
            places = places[met]

        if places.size > 0:
            _sweep(arrays, take_poses(poses, places), places, beams, apparent, described, rooms, found, traced, threads)
    labels = RecordLabels(
        target_id=found.target_id,
        material=found.material,
        shadow=found.shadow,
        shadow_id=found.shadow_id,
        ground_range=found.ground_range,
        incidence=degrees_of_incidence(found.cosine),
        path=found.path,
        volume_id=np.full(found.target_id.shape, NOTHING, np.int16),
        caustic=found.caustic,
        target_echo=found.target_echo,
    )
    if crosstalk > 0.0:
        # The other side's contributor wherever its crosstalk exceeds the side's own echo.
        leaked: dict[str, Any] = {}
        louder = crosstalk * found.energy[:, ::-1] > found.energy
        for name in ("target_id", "material", "ground_range", "incidence", "path", "caustic"):
            leaked[name] = np.where(louder, getattr(labels, name)[:, ::-1], getattr(labels, name))
        leaked["path"][louder] = PATHS.index("crosstalk")
        labels = labels._replace(**leaked)
    if volumes is None:
        return labels
    # The volume of the greatest echo, where that exceeds the contributor's.
    greatest = np.maximum(found.energy, crosstalk * found.energy[:, ::-1]) * (arrays.range_factor / FIXED_POINT)
    for number, own in enumerate(volumes):
        received = np.maximum(own, crosstalk * own[:, ::-1])
        labels.volume_id[received > greatest] = number
        greatest = np.maximum(received, greatest)
    return labels


def _sweep(
    arrays: SceneArrays,
    poses: Poses,
    places: Integers,
    beams: list[AzimuthFan],
    apparent: ApparentTables,
    described: Contributors,
    rooms: PerThread[tuple[Any, ...]],
    found: BinLabels,
    traced: Singles,
    threads: int | None,
) -> None:
    """Label pings that share their planes, each at its place."""

    def block(part: Poses, first: int, last: int) -> None:
        label_swept_pings(arrays, part, *beams, apparent, described, *rooms.own, found, traced, places[first:last])

    share_blocks(poses, block, threads, pings_a_thread(beams[0]))


def _label_bed(found: BinLabels, places: Integers, echoes: Singles) -> None:
    """Label the pings that meet the bed alone, without the places of their echoes."""
    has_echo = echoes > 0.0
    found.target_id[places] = np.where(has_echo, BED, NOTHING)
    found.material[places], found.path[places] = np.where(has_echo, 0, NO_MATERIAL), np.where(has_echo, 0, NO_PATH)
    found.energy[places], found.shadow[places], found.shadow_id[places] = 0.0, 0.0, NO_TARGET
    found.ground_range[places] = found.cosine[places] = np.nan


def degrees_of_incidence(cosine: Singles) -> Singles:
    """Turn cosines of the incidence, which are overwritten, into degrees."""
    np.arccos(np.minimum(cosine, np.float32(1.0), out=cosine), out=cosine)
    return np.multiply(cosine, np.float32(180.0 / math.pi), out=cosine)


def empty_tables(arrays: SceneArrays) -> tuple[ContributorTable, ShadowTable]:
    """Room for the contributions to one side of a ping and the shadows on it."""
    contributors = count_contributors(arrays) * (PATH_COUNT if arrays.multipath.enabled else 1)
    return (
        empty_contributor_table(contributors, arrays.bins),
        empty_shadow_table(count_targets(arrays), arrays.bins),
    )


def _make_room(arrays: SceneArrays, apparent: ApparentTables) -> tuple[Any, ...]:
    """Work space for the labels of pings."""
    return empty_sweep_workspace(arrays, apparent), empty_multipath_workspace(arrays), *empty_tables(arrays)


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
        np.where(of_scene, target, NOTHING).astype(np.int16),
        np.where(of_scene, contributor_materials(arrays)[contributor], NO_MATERIAL).astype(np.int16),
        path.astype(np.int8),
    )
