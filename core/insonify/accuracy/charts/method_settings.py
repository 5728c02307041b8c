"""A scene packed for charts, and the methods that trace it with their settings."""

import math
from collections.abc import Callable, Sequence
from functools import partial
from typing import NamedTuple

import numpy as np

from insonify.accuracy.charts.embree import TriangulatedScene, explain_omission
from insonify.arrays import Singles
from insonify.kernels.common.types import Bed, Poses, SceneArrays, still_water
from insonify.packing.scene_arrays import pack_scene
from insonify.packing.terrain_tiles import TerrainTiles
from insonify.scene import Scene
from insonify.simulation import Simulation, prepare
from insonify.terrain import build_ground
from insonify.tow.poses import make_poses, take_poses
from insonify.tracers import march, rays, sweep

MARCH_STEPS = (16.0, 4.0, 1.0, 0.5)  # step of a march, in cells of the bed
RAYS = (250, 1000, 4000, 16000)
MANY_RAYS = (64000, 256000)  # in addition where rays are straight; along arcs they take too long
PLANES = (1, 2, 4, 8, 16, 32, 64)
STILL_RAYS, STILL_PLANES = (16000,), (4, 16, 64)
COARSER = {2: "2nd", 4: "4th"}  # stride of the nodes of the bed
COARSE_PLANES = (4, 16)
DOUBLE_PLANES = (4, 16, 64)
# Share of a bin's echo that a segment of a profile may add wrongly before it is divided; beside the default.
DIVISIONS = {"whole segments": math.inf, "segments to 3 %": 0.03, "segments to 1 %": 0.01}
SWEEPS = ("sweep", *(f"sweep, {division}" for division in DIVISIONS))  # of the whole scene, however divided
PLAN = "plan"
TOLERANCES = (0.1, 0.03, 0.01, 0.003, 0.001)  # of plans
EMBREE, EMBREE_OWN = "embree", "embree, against its own triangles"


def pack_for_chart(scene: Scene, pings: int) -> tuple[SceneArrays, Poses]:
    """Arrays and poses of some pings of a scene, with refraction wherever the water has a gradient."""
    ground = build_ground(scene)
    arrays = pack_scene(scene, ground)
    # These effects exclude refraction; the plan decides which of both is modelled.
    if arrays.water.bent and (arrays.multipath.enabled or arrays.bounces) and not prepare(scene).plan.model.bent:
        arrays = arrays._replace(water=still_water(arrays.water.reference, arrays.water.surface))
    poses = make_poses(scene, ground, np.unique(np.linspace(0, scene.track.pings - 1, pings).astype(np.int64)))
    tiles = TerrainTiles(ground, arrays.bins * arrays.bin_length).split(arrays, poses)
    places, arrays = max(tiles, key=lambda tile: poses.x[tile[0]].size)
    return arrays, take_poses(poses, places)


class SettingKey(NamedTuple):
    """Key of a method with one setting."""

    method: str  # name of the method
    setting: str  # setting as text
    targets: bool  # whether the scene includes its targets


class MethodSetting(NamedTuple):
    """One method with one setting."""

    method: str  # name of the method
    setting: str  # setting as text
    size: float  # setting as a number: step in metres, rays per side, or planes
    trace: Callable[[Poses], Singles]  # traces the record of some poses on one thread


def list_settings(arrays: SceneArrays, poses: Poses) -> list[MethodSetting]:
    """List all methods that can trace a scene, with their settings, each on one thread."""
    if arrays.bounces:
        return ray_settings("rays", arrays, RAYS)
    counts = RAYS if arrays.water.bent else RAYS + MANY_RAYS
    out = march_settings(arrays, MARCH_STEPS) + ray_settings("rays", arrays, counts)
    if not explain_omission(arrays, poses):
        scene = TriangulatedScene(arrays, poses)
        out += [MethodSetting(EMBREE, f"{count:,} rays", count, partial(scene.trace, rays=count)) for count in RAYS]
    if arrays.water.station.size == 1:  # the sweep needs water that varies with depth alone
        out += sweep_settings("sweep", arrays, PLANES) + sweep_settings(
            "sweep, float64", arrays, DOUBLE_PLANES, double=True
        )
        for method, share in zip(SWEEPS[1:], DIVISIONS.values()):
            divided = arrays._replace(limits=arrays.limits._replace(misplaced=share))
            out += sweep_settings(method, divided, PLANES)
        for every, ordinal in COARSER.items():
            if (coarse := coarsen_bed(arrays.bed, every)) is not None:
                out += sweep_settings(f"sweep, every {ordinal} node", arrays._replace(bed=coarse), COARSE_PLANES)
    if arrays.water.bent:
        still = arrays._replace(water=still_water(arrays.water.reference, arrays.water.surface))
        out += ray_settings("rays, straight", still, STILL_RAYS) + sweep_settings(
            "sweep, straight", still, STILL_PLANES
        )
    return out


def plan_settings(scene: Scene) -> list[MethodSetting]:
    """List what plans choose at tolerances from coarse to fine, as records are made, on one thread."""
    made = []
    for tolerance in TOLERANCES:
        simulation = prepare(scene, tolerance=tolerance, threads=1)
        made.append(MethodSetting(PLAN, f"{100.0 * tolerance:g} %", tolerance, partial(_trace_pings, simulation)))
    return made


def _trace_pings(simulation: Simulation, poses: Poses) -> Singles:
    """Trace pings by a plan, each by as many planes as its own error requires."""
    return simulation.trace_pings(poses).echoes


def coarsen_bed(bed: Bed, every: int) -> Bed | None:
    """Keep every n-th node of a bed; None where its period would change or no bed would be left."""
    heights = np.ascontiguousarray(bed.heights[::every, ::every])
    finite = heights[np.isfinite(heights)]
    if min(heights.shape) < 2 or finite.size == 0 or (bed.periodic and any(n % every for n in bed.heights.shape)):
        return None
    return bed._replace(
        heights=heights,
        transposed=np.ascontiguousarray(heights.T),
        materials=np.ascontiguousarray(bed.materials[::every, ::every]),
        spacing=bed.spacing * every,
        low=float(finite.min()),
        high=float(finite.max()),
    )


def march_settings(arrays: SceneArrays, cells: Sequence[float]) -> list[MethodSetting]:
    """List marches by their steps in cells of the bed; each has one ray per bin and side."""
    steps = [one * arrays.bed.spacing for one in cells]
    return [
        MethodSetting("march", f"{step:.3g} m", step, _bound(march.trace, arrays, step=step, rays=arrays.bins))
        for step in steps
    ]


def ray_settings(method: str, arrays: SceneArrays, counts: Sequence[int]) -> list[MethodSetting]:
    """List exact ray tracings by their numbers of rays per side."""
    return [MethodSetting(method, f"{count:,} rays", count, _bound(rays.trace, arrays, rays=count)) for count in counts]


def sweep_settings(
    method: str, arrays: SceneArrays, counts: Sequence[int], *, double: bool = False
) -> list[MethodSetting]:
    """List sweeps by their numbers of planes, in single or double precision; a knife-edge beam has one plane."""
    return [
        MethodSetting(
            method,
            f"{planes} plane{'s' * (planes > 1)}",
            planes,
            _bound(sweep.trace, arrays, planes=planes, double=double),
        )
        for planes in (counts if arrays.half_width > 0.0 else (1,))
    ]


def _bound(trace: Callable[..., Singles], arrays: SceneArrays, **settings: float) -> Callable[[Poses], Singles]:
    return partial(trace, arrays, threads=1, **settings)
