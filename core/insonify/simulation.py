"""The whole way in one page: scene -> plan -> trace -> receive -> Dataset."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from importlib.metadata import version
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from insonify.acoustics.water import recording_speed
from insonify.io.record_schema import ACROSS, coordinates, join_blocks, labels, platform
from insonify.kernels.common.types import Poses, SceneArrays, still_water
from insonify.packing.containment import refuse_sonar_in_mesh
from insonify.packing.navigation import bed_beneath, make_poses, take_poses
from insonify.packing.reduced_scene import reduce_scene
from insonify.packing.scene_arrays import make_bed, pack_scene
from insonify.packing.terrain_tiles import TerrainTiles, restore_order
from insonify.packing.track import TowLine, tow_line_at
from insonify.parallel import in_parallel
from insonify.planning import Plan, plan
from insonify.receiver import Reception, make_reception, receive
from insonify.scene import Scene, SceneError, scene_to_toml
from insonify.scene.speckles.k import K
from insonify.terrain import AnyGround, EndlessGround, build_ground
from insonify.tracers import march, rays, sweep
from insonify.tracers.labels import PATHS, RecordLabels, trace_labels
from insonify.tracers.scatterers import ScattererTracer, make_scatterer_tracer

if TYPE_CHECKING:
    import xarray as xr

Tracer = Callable[..., NDArray[np.float32]]
TRACERS: dict[str, Tracer] = {
    "sweep": sweep.trace,
    "march": march.trace,
    "rays": rays.trace,
}


class ReducedScene(NamedTuple):
    """A problem and the ground about each ping, less what the plan leaves out."""

    arrays: SceneArrays
    tiles: TerrainTiles


@dataclass(frozen=True, eq=False)
class Simulation:
    """A scene made ready to trace any of its pings.

    Attributes
    ----------
    scene : Scene
        What was declared.
    plan : Plan
        How it is traced.
    ground : AnyGround
        The bed.
    arrays : SceneArrays
        All of it as the tracers take it; of endless ground only a piece.
    tiles : TerrainTiles
        The ground about each ping.
    reduced : ReducedScene
        What of both is traced.
    reception : Reception
        What becomes of the echoes.
    per_material_k : SceneArrays or None
        Likewise, with every material's echo divided by the shape of its K speckle; None where that is of no account.
    scatterers : ScattererTracer or None
        Scatterers to be heard one by one; None where speckle is not made of them.
    """

    scene: Scene
    plan: Plan
    ground: AnyGround
    arrays: SceneArrays
    tiles: TerrainTiles
    reduced: ReducedScene
    reception: Reception
    per_material_k: SceneArrays | None
    scatterers: ScattererTracer | None

    def poses(self, pings: NDArray[np.int64]) -> Poses:
        """Return where the sonar is at the given pings; beyond the track's last the tow goes on."""
        return make_poses(self.scene, self.ground, pings)

    def line(self, pings: NDArray[np.int64]) -> TowLine:
        """Return where the line of the tow leads, from which the fish strays by its motion."""
        return tow_line_at(self.scene, pings)

    def altitude(self, pings: NDArray[np.int64]) -> NDArray[np.float64]:
        """Return how high above the bed beneath the sonar is, in metres, with the bed smoothed as a fish follows it."""
        return self.poses(pings).z - bed_beneath(self.scene, self.ground, pings)

    def intensity(self, pings: NDArray[np.int64]) -> NDArray[np.float32]:
        """Trace and receive pings, any numbers in any order.

        Parameters
        ----------
        pings : (n,) int64
            Ping numbers, from 0.

        Returns
        -------
        (n, 2, bins) float32
            Linear intensity, port first; each ping is a function of the scene and its number alone.
        """
        pings = np.asarray(pings, dtype=np.int64)
        trace = TRACERS[self.plan.method] if self.scatterers is None else self.scatterers.trace
        poses = self.poses(pings)
        refuse_sonar_in_mesh(self.reduced.arrays, poses)
        traced = self._traced(trace, self.reduced.arrays, poses)
        per_material_k = None if self.per_material_k is None else self._traced(trace, self.per_material_k, poses)

        def block(first: int, last: int) -> NDArray[np.float32]:
            part = slice(first, last)
            return receive(
                self.reception, traced[part], pings[part], None if per_material_k is None else per_material_k[part]
            )

        return np.concatenate(in_parallel(block, pings.size)) if pings.size else traced

    def truth(self, pings: NDArray[np.int64]) -> RecordLabels:
        """Tell what every bin of the given pings shows.

        Parameters
        ----------
        pings : (n,) int64
            Ping numbers, from 0.

        Returns
        -------
        Truth
            Arrays (n, 2, bins), port first. It comes from the geometry of the sweep whatever the method, and is that
            of an ideal pulse: a longer one carries each echo on into the bins that follow.
        """
        fine = {name: number for name, number in self.plan.settings.items() if name in ("planes", "rays")}
        poses = self.poses(np.asarray(pings, dtype=np.int64))
        refuse_sonar_in_mesh(self.arrays, poses)
        crosstalk = self.reception.crosstalk
        places, tile_arrays = zip(*self.reduced.tiles.over(self.reduced.arrays, poses))
        found = [
            trace_labels(arrays, take_poses(poses, some), crosstalk=crosstalk, **fine)
            for some, arrays in zip(places, tile_arrays)
        ]
        return RecordLabels(*(restore_order(places, columns) for columns in zip(*found)))

    def _traced(self, trace: Tracer, arrays: SceneArrays, poses: Poses) -> NDArray[np.float32]:
        """Trace pings window by window."""
        places, tile_arrays = zip(*self.reduced.tiles.over(arrays, poses))
        found = [trace(part, take_poses(poses, some), **self.plan.settings) for some, part in zip(places, tile_arrays)]
        return restore_order(places, found)


def prepare(
    scene: Scene, *, method: str = "auto", tolerance: float = 0.03, forced: Mapping[str, str] | None = None
) -> Simulation:
    """Plan a scene, build its ground and make its receiver ready.

    Parameters
    ----------
    scene, method, tolerance, forced
        As in `simulate`.

    Returns
    -------
    Simulation

    Raises
    ------
    SceneError
        One sentence with what is wrong and the remedy.
    """
    chosen = plan(scene, tolerance, method=method, forced=forced)
    ground = build_ground(scene)
    _refuse_silence(scene, ground)
    arrays = pack_scene(scene, ground)
    if not chosen.bent:
        arrays = arrays._replace(water=still_water(arrays.water.reference, arrays.water.surface))
    reception = _make_reception(scene, ground, arrays)
    scatterers = make_scatterer_tracer(scene, arrays)
    reach = (arrays.bins + (0 if scatterers is None else scatterers.beyond)) * arrays.bin_length
    tiles = TerrainTiles(ground, reach)
    reduced = _reduce(scene, chosen, ground, arrays, tiles)
    per_material_k = _per_material_k(scene, ground, reduced.arrays)
    return Simulation(scene, chosen, ground, arrays, tiles, reduced, reception, per_material_k, scatterers)


def _reduce(scene: Scene, chosen: Plan, ground: AnyGround, arrays: SceneArrays, tiles: TerrainTiles) -> ReducedScene:
    """Leave out what the plan does."""
    bed = arrays.bed
    if chosen.every > 1:
        thinned = ground.thinned(chosen.every)
        bed, tiles = make_bed(thinned.around(scene.track.start, 0.0)), TerrainTiles(thinned, tiles.reach)
    less = reduce_scene(arrays, bed=bed, ways=chosen.ways, bounces=chosen.bounces, targets=chosen.targets)
    return ReducedScene(less, tiles)


def _refuse_silence(scene: Scene, ground: AnyGround) -> None:
    """Refuse a tow that never comes within range of a bed that ends somewhere, unless a target may be heard."""
    if isinstance(ground, EndlessGround) or ground.periodic or scene.targets:
        return
    line = tow_line_at(scene, np.unique(np.linspace(0, scene.track.pings - 1, 512).astype(np.int64)))
    ny, nx = ground.heights.shape
    x1, y1 = ground.x0 + (nx - 1) * ground.spacing, ground.y0 + (ny - 1) * ground.spacing
    away = np.hypot(line.x - np.clip(line.x, ground.x0, x1), line.y - np.clip(line.y, ground.y0, y1))
    if (away > scene.sonar.range).all():
        raise SceneError(
            f"track.start: from {list(scene.track.start)} the tow never comes within {scene.sonar.range:g} m "
            f"of the bed (x from {ground.x0:g} to {x1:g} m, y from {ground.y0:g} to {y1:g} m); start it over the bed"
        )


def _per_material_k(scene: Scene, ground: AnyGround, arrays: SceneArrays) -> SceneArrays | None:
    """Divide the strength of every material by the shape of its K speckle, if any says one."""
    speckle = scene.receiver.speckle
    rows = (*ground.reflectivities, *(target.material.reflectivity for target in scene.targets))
    if not isinstance(speckle, K) or all(row.speckle_shape is None for row in rows):
        return None
    shapes = np.array([row.speckle_shape or speckle.shape for row in rows])
    strengths = arrays.reflectivity / np.stack([shapes, shapes, np.ones(shapes.size)], axis=1)
    return arrays._replace(reflectivity=strengths)


def _make_reception(scene: Scene, ground: AnyGround, arrays: SceneArrays) -> Reception:
    """Make the receiver ready, for the height of the first ping."""
    first = np.zeros(1, dtype=np.int64)
    z = make_poses(scene, ground, first).z
    altitude = max(float((z - bed_beneath(scene, ground, first))[0]), arrays.bin_length)
    return make_reception(scene, arrays, altitude=altitude, depth=-float(z[0] + ground.datum))


def simulate(
    scene: Scene,
    *,
    method: str = "auto",
    tolerance: float = 0.03,
    forced: Mapping[str, str] | None = None,
    truth: bool = False,
    progress: Callable[[int, int], None] | None = None,
) -> xr.Dataset:
    """Simulate a scene's whole record.

    Parameters
    ----------
    scene : Scene
        What there is.
    method : str
        ``sweep``, ``march``, ``rays``, or ``auto``.
    tolerance : float
        Greatest error beyond 1.4 times the altitude, as a share of the record.
    forced : mapping of str to str, optional
        Choices that are not left to the plan, as in `insonify.plan`.
    truth : bool
        Whether to add what every bin shows: the target, the material, shadow, ground range, incidence and path, as
        `Simulation.truth` has them.
    progress : callable, optional
        Called with the pings done and the pings in all.

    Returns
    -------
    Dataset
        Dimensions (channel, ping_time, range_sample).

    Raises
    ------
    SceneError
        One sentence with what is wrong and the remedy.
    """
    blocks = []
    done = 0
    for block in simulate_blocks(scene, method=method, tolerance=tolerance, forced=forced, truth=truth):
        blocks.append(block)
        done += block.sizes["ping_time"]
        if progress is not None:
            progress(done, scene.track.pings)
    return join_blocks(blocks)


def simulate_blocks(
    scene: Scene,
    *,
    method: str = "auto",
    tolerance: float = 0.03,
    forced: Mapping[str, str] | None = None,
    truth: bool = False,
    block: int | None = None,
) -> Iterator[xr.Dataset]:
    """Simulate a scene's record block by block, so that memory does not grow with its length.

    Parameters
    ----------
    scene, method, tolerance, forced, truth
        As in `simulate`.
    block : int, optional
        Pings at a time; as planned when left out. The record does not depend on it.

    Yields
    ------
    Dataset
        Successive pings.

    Raises
    ------
    SceneError
        One sentence with what is wrong and the remedy.
    """
    if block is not None and block < 1:
        raise SceneError(f"block: {block} pings at a time are none; give at least 1")
    simulation = prepare(scene, method=method, tolerance=tolerance, forced=forced)
    attributes: dict[str, Any] = {
        "title": scene.title,
        "scene": scene_to_toml(scene),
        "plan": "\n".join(simulation.plan.lines()),
        "method": method,
        "tolerance": tolerance,
        "version": version("insonify"),
    }
    if forced:
        attributes["model"] = " ".join(f"{subject}={choice}" for subject, choice in forced.items())
    size = simulation.plan.block if block is None else block
    for first in range(0, scene.track.pings, size):
        pings = np.arange(first, min(first + size, scene.track.pings), dtype=np.int64)
        yield _dataset(simulation, pings, attributes, truth)


def _dataset(simulation: Simulation, pings: NDArray[np.int64], attributes: dict[str, Any], truth: bool) -> xr.Dataset:
    """Trace one block and dress it."""
    import xarray as xr  # takes longer to import than a preview takes to trace

    scene, sonar, poses = simulation.scene, simulation.scene.sonar, simulation.poses(pings)
    slant_range = (np.arange(sonar.bins) + 0.5) * (sonar.range / sonar.bins)
    intensity = np.moveaxis(simulation.intensity(pings), 1, 0)
    dataset = xr.Dataset(
        {"intensity": (ACROSS, intensity, labels("1", "echo intensity, linear, before display gain"))},
        coordinates(pings / sonar.ping_rate, slant_range, recording_speed(scene, simulation.ground.datum)),
        attributes,
    )
    dataset = dataset.assign(_platform(simulation, poses))
    return dataset.assign(_truth(simulation, pings)) if truth else dataset


def _truth(simulation: Simulation, pings: NDArray[np.int64]) -> dict[str, Any]:
    """Truth of each bin, with the names behind the numbers."""
    scene, found = simulation.scene, simulation.truth(pings)
    targets = [f"{target.kind}_{number}" for number, target in enumerate(scene.targets)]
    materials = [*simulation.ground.names, *(target.material.name for target in scene.targets)]
    attributes = {
        "target_id": _flags("greatest contributor of the bin", ["nothing", "bed", *targets], found.target_id.dtype, -2),
        "material": _flags("material of that contributor", ["nothing", *materials], found.material.dtype, -1),
        "shadow": {"long_name": "whether bed lies there, hidden, and nothing is heard on the direct path"},
        "ground_range": labels("m", "ground range of that contributor's strongest piece"),
        "incidence": labels("degree", "incidence on that piece, from its normal"),
        "path": _flags("how the sound went", ["none", *PATHS], found.path.dtype, -1),
        "caustic": {"long_name": "whether sound of a caustic is heard, its level held to what waves allow"},
    }
    return {name: (ACROSS, np.moveaxis(getattr(found, name), 1, 0), told) for name, told in attributes.items()}


def _flags(text: str, meanings: list[str], dtype: np.dtype[Any], first: int) -> dict[str, Any]:
    """Name the values of a variable that counts up from ``first``, as the CF conventions have it."""
    values = np.arange(first, first + len(meanings), dtype=dtype)
    return {"long_name": text, "flag_values": values, "flag_meanings": " ".join(meanings)}


def _platform(simulation: Simulation, poses: Poses) -> dict[str, Any]:
    """Where the sonar was, one number a ping."""
    ground = simulation.ground
    columns = (
        poses.x,
        poses.y,
        -(poses.z + ground.datum),
        poses.z - ground.height_at(poses.x, poses.y),
        *map(np.degrees, (poses.heading, poses.pitch, poses.roll)),
    )
    return platform(columns)
