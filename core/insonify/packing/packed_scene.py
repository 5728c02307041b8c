"""A scene with its ground and its arrays, and the same without what a model of it leaves out."""

import math
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np

from insonify.arrays import Booleans, Floats, Integers
from insonify.kernels.common.types import Bed, Poses, SceneArrays, Solids, still_water
from insonify.kernels.geometry.bvh import build_mesh
from insonify.packing.scene_arrays import make_bed, pack_scene
from insonify.packing.terrain_tiles import TerrainTiles
from insonify.scene import Scene
from insonify.scene.water.surfaces import WAYS
from insonify.terrain import AnyGround, build_ground
from insonify.tow.line import TowLine, tow_line_at
from insonify.tow.poses import bed_beneath, make_poses

SURFACE_ECHO = "surface_echo"  # the multipath that has no plane and takes no time


class Model(NamedTuple):
    """Model of a scene: its tracer, how finely that traces, and the effects that are included."""

    method: str = "sweep"  # name of the tracer
    planes: int = 1
    rays: int = 0  # per side; of the sweep, for pings where several eigenrays or none reach a place
    step: float = 0.0  # m, of the march
    every: int = 1  # stride of the nodes of the relief that are kept
    misplaced: float = math.inf  # share of a bin's echo that a segment may misplace before it is divided
    bent: bool = False
    bounces: int = 0
    targets: tuple[int, ...] = ()  # indices of those modelled
    ways: frozenset[str] = frozenset()  # multipaths by the sea surface that are modelled
    fineness: int = 0  # what any other tracer counts by its ladder
    across: int = 0  # planes across each target in the beam and each glint; 0 for planes alike everywhere


@dataclass(frozen=True, eq=False)
class PackedScene:
    """A scene with its ground and arrays, from which any model of it is traced."""

    scene: Scene  # the declaration
    ground: AnyGround  # the bed
    arrays: SceneArrays  # the whole scene for kernels; of endless ground, the piece at the start of the track
    _thinned: dict[int, tuple[AnyGround, Bed]] = field(default_factory=dict, repr=False)  # by stride of the nodes
    _tiles: dict[tuple[int, int], TerrainTiles] = field(default_factory=dict, repr=False)
    works: dict[Model, float] = field(default_factory=dict, repr=False)  # of a ping, as a plan counts them

    def poses(self, pings: Integers) -> Poses:
        """Return position and attitude of the sonar at the given pings; the tow continues beyond the track's last."""
        return make_poses(self.scene, self.ground, pings)

    def line(self, pings: Integers) -> TowLine:
        """Return positions and headings along the line of the tow, without the motion of the fish about it."""
        return tow_line_at(self.scene, pings)

    def altitude(self, pings: Integers) -> Floats:
        """Return the altitude of the sonar above the bed, in metres, with the bed smoothed as a fish follows it."""
        return self.poses(pings).z - bed_beneath(self.scene, self.ground, pings)

    def arrays_in_water(self, model: Model) -> SceneArrays:
        """Return the whole scene's arrays, in water without refraction if the model has none."""
        if model.bent:
            return self.arrays
        water = self.arrays.water
        return self.arrays._replace(water=still_water(water.reference, water.surface))

    def modelled_arrays(self, model: Model) -> SceneArrays:
        """Return the scene's arrays without the nodes, targets, paths and bounces that a model leaves out."""
        arrays = self.arrays_in_water(model)
        ways: dict[str, Any] = {way: getattr(arrays.multipath, way) and way in model.ways for way in WAYS}
        arrays = arrays._replace(
            bed=self._every_nth_node(model.every)[1],
            multipath=arrays.multipath._replace(enabled=any(ways.values()), **ways),
            bounces=model.bounces,
            limits=arrays.limits._replace(misplaced=model.misplaced),
        )
        kept = np.asarray(sorted(model.targets), dtype=np.int64)
        return _keep_bodies(arrays, np.isin(arrays.solids.target, kept), np.isin(arrays.mesh.target, kept))

    def ground_tiles(self, every: int, bins_beyond: int) -> TerrainTiles:
        """Return the ground about each ping, of every n-th node, wide enough for some bins beyond the last."""
        if (every, bins_beyond) not in self._tiles:
            reach = (self.arrays.bins + bins_beyond) * self.arrays.bin_length
            self._tiles[every, bins_beyond] = TerrainTiles(self._every_nth_node(every)[0], reach)
        return self._tiles[every, bins_beyond]

    def _every_nth_node(self, every: int) -> tuple[AnyGround, Bed]:
        """Ground and bed of every n-th node, made once."""
        if every not in self._thinned:
            kept = self.ground.thinned(every)
            bed = self.arrays.bed if every == 1 else make_bed(kept.around(self.scene.track.start, 0.0))
            self._thinned[every] = kept, bed
        return self._thinned[every]


def pack(scene: Scene, ground: AnyGround | None = None) -> PackedScene:
    """Build the ground of a scene, unless it is given, and pack its arrays."""
    ground = ground or build_ground(scene)
    return PackedScene(scene, ground, pack_scene(scene, ground))


def without_targets(arrays: SceneArrays) -> SceneArrays:
    """Return a scene's arrays without its targets."""
    none: Booleans = np.zeros(arrays.solids.target.size, np.bool_)
    return _keep_bodies(arrays, none, np.zeros(arrays.mesh.target.size, np.bool_))


def _keep_bodies(arrays: SceneArrays, solids: Booleans, triangles: Booleans) -> SceneArrays:
    """Scene with only some of its solids and triangles."""
    if solids.all() and triangles.all():
        return arrays
    mesh = arrays.mesh
    columns: list[Any] = [column[solids] for column in arrays.solids]
    return arrays._replace(
        solids=Solids(*columns),
        mesh=build_mesh(
            mesh.corners[triangles], mesh.material[triangles], mesh.target[triangles], mesh.closed[triangles]
        ),
    )
