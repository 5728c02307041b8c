"""Model of a scene: tracer, settings and effects included; the arrays that are traced by it, and its work."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from insonify.kernels.common.types import Bed, Poses, SceneArrays, still_water
from insonify.kernels.sweep.partial_segments import FINE
from insonify.packing.reduced_scene import reduce_scene
from insonify.packing.scene_arrays import make_bed, pack_scene
from insonify.packing.terrain_tiles import TerrainTiles
from insonify.scene import Scene
from insonify.terrain import AnyGround, build_ground
from insonify.tracers.registry import Tracer, make_tracer

# Work of a ping in knots of one plane over uniform water: of a plane besides its knots, of the planes of the near field
# that several planes need, of a target in a plane, and the factor of refraction.
PLANE, TARGET, REFRACTED = 300.0, 100.0, 1.5
# Of a path by a calm sea over that of the direct one, and what each facet of a rough sea adds.
SURFACE_PATH, FACET = 1.0, 0.25
# Of a segment too long against its range for one density, taken by itself, and of each of its parts.
CUT_SEGMENT, PART = 7.0, 2.5
NEAR_PLANES, NEAR_PLANES_OF_PATTERN = 4.0, 12.0
# Work of a profile whose segments are divided until they misplace a share of a bin's echo, over that of a whole one.
KNOTS = {math.inf: 1.0, 0.03: 2.5, 0.01: 3.0, 0.003: 4.5}
RAY, REFRACTED_RAY, STEP = 20.0, 300.0, 0.6  # of a ray, of a refracted one, of a step of the march


SURFACE_ECHO = "surface_echo"  # of the multipaths, the one that has no plane and takes no time


class Model(NamedTuple):
    """Model of a scene: its tracer, the settings of the tracer, and the effects that it includes."""

    method: str = "sweep"
    planes: int = 1
    rays: int = 0  # per side; of the sweep, for pings where several eigenrays or none reach a place
    step: float = 0.0  # m, of the march
    every: int = 1  # stride of the nodes of the relief that are kept
    misplaced: float = math.inf  # share of a bin's echo that a segment may misplace before it is divided
    bent: bool = False
    bounces: int = 0
    targets: tuple[int, ...] = ()  # indices of those modelled
    ways: frozenset[str] = frozenset()  # multipaths by the sea surface that are modelled

    @property
    def settings(self) -> dict[str, Any]:
        """Keyword arguments of the tracer."""
        if self.method == "march":
            return {"step": self.step, "rays": self.rays}
        if self.method == "rays":
            return {"rays": self.rays}
        return {"planes": self.planes} | ({"rays": self.rays} if self.bent else {})


class ReducedScene(NamedTuple):
    """Scene as a model simulates it."""

    whole: SceneArrays  # with all that the scene declares, but straight rays if the model takes them
    arrays: SceneArrays  # without the effects that the model omits; this one is traced
    tiles: TerrainTiles  # the ground about each ping, with as many nodes as the model keeps
    tracer: Tracer  # the method that finds echoes


@dataclass(frozen=True, eq=False)
class PackedScene:
    """Scene with its ground and arrays, from which any model of it is made."""

    scene: Scene
    ground: AnyGround
    arrays: SceneArrays
    _grids: dict[tuple[int, int], tuple[Bed, TerrainTiles]] = field(default_factory=dict, repr=False)

    def reduced(self, model: Model) -> ReducedScene:
        """Scene without the effects that a model omits, ready to be traced."""
        whole = self.arrays
        if not model.bent:
            whole = whole._replace(water=still_water(whole.water.reference, whole.water.surface))
        tracer = make_tracer(model.method, self.scene, whole)
        bed, tiles = self._grid(model.every, tracer.bins_beyond)
        arrays = reduce_scene(whole, bed=bed, ways=model.ways, bounces=model.bounces, targets=model.targets)
        arrays = arrays._replace(limits=arrays.limits._replace(misplaced=model.misplaced))
        return ReducedScene(whole, arrays, tiles, tracer)

    def trace(self, model: Model, poses: Poses) -> NDArray[np.float32]:
        """Trace pings by a model on one thread, (pings, sides, bins)."""
        reduced = self.reduced(model)

        def on_tile(tile: SceneArrays, poses: Poses) -> tuple[NDArray[np.float32]]:
            return (reduced.tracer.trace(tile, poses, threads=1, **model.settings),)

        return reduced.tiles.map(on_tile, reduced.arrays, poses)[0]

    def _grid(self, every: int, bins_beyond: int) -> tuple[Bed, TerrainTiles]:
        """Bed and tiles of every n-th node, made once."""
        if (every, bins_beyond) not in self._grids:
            arrays, kept = self.arrays, self.ground.thinned(every)
            bed = arrays.bed if every == 1 else make_bed(kept.around(self.scene.track.start, 0.0))
            tiles = TerrainTiles(kept, (arrays.bins + bins_beyond) * arrays.bin_length)
            self._grids[every, bins_beyond] = bed, tiles
        return self._grids[every, bins_beyond]

    def work(self, model: Model) -> float:
        """Work of a ping, both sides, by which models are compared; a count, the same on every machine."""
        arrays, paths = self.arrays, len(model.ways - {SURFACE_ECHO})
        reach = arrays.bins * arrays.bin_length
        if model.method != "sweep":
            of_ray = REFRACTED_RAY if model.bent else RAY
            of_ray += STEP * reach / model.step if model.method == "march" else 0.0
            return 2.0 * model.rays * of_ray * (1.0 + paths) * (1.0 + model.bounces)
        heading = math.radians(self.scene.track.heading)
        across = abs(math.cos(heading)) + abs(math.sin(heading))  # a plane crosses both families of grid lines
        spacing = arrays.bed.spacing * model.every / across
        segments, parts, beyond = divide_profile(reach, spacing, self.scene.altitude)
        knots = (CUT_SEGMENT * segments + PART * parts + beyond) * KNOTS[model.misplaced]
        profile = PLANE + knots * (REFRACTED if model.bent else 1.0) + TARGET * len(model.targets)
        near = NEAR_PLANES_OF_PATTERN if arrays.pattern.tabulated else NEAR_PLANES
        planes = 1.0 if model.planes == 1 else model.planes + near
        return 2.0 * planes * profile * (1.0 + weigh_path(arrays) * paths)


def divide_profile(reach: float, spacing: float, height: float) -> tuple[float, float, float]:
    """Count the segments of a profile too long for one density of echo, their parts, and the other segments."""
    height = max(height, spacing)
    nearer = min(math.sqrt(max((spacing / FINE) ** 2 - height**2, 0.0)), reach)
    segments = nearer / spacing
    return segments, math.asinh(nearer / height) / FINE + 0.5 * segments, (reach - nearer) / spacing


def weigh_path(arrays: SceneArrays) -> float:
    """Work of one path by the sea surface of a scene, over that of the direct one."""
    facets = arrays.multipath.facets.shape[1]
    return SURFACE_PATH + (FACET * facets if facets > 1 else 0.0)


def pack(scene: Scene, ground: AnyGround | None = None) -> PackedScene:
    """Build the ground of a scene, unless it is given, and pack its arrays."""
    ground = ground or build_ground(scene)
    return PackedScene(scene, ground, pack_scene(scene, ground))
