"""Simulation of a scene's record, step by step: scene → plan → trace → receive → Dataset."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from importlib.metadata import version
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from insonify.acoustics.water import recording_speed
from insonify.io.georeference import Georeference
from insonify.io.record_schema import coordinates, echo_variable, join_blocks, label_variables, platform
from insonify.kernels.common.types import Poses, SceneArrays, still_water
from insonify.packing.navigation import bed_beneath, make_poses, platform_columns, refuse_track_off_bed
from insonify.packing.reduced_scene import reduce_scene
from insonify.packing.scene_arrays import make_bed, pack_scene
from insonify.packing.terrain_tiles import TerrainTiles
from insonify.packing.track import TowLine, tow_line_at
from insonify.planning import Plan, plan
from insonify.receiver import Reception, Traced, prepare_reception, record_echoes
from insonify.scene import Scene, SceneError, scene_to_toml
from insonify.terrain import AnyGround, build_ground
from insonify.tracers.labels import PATHS, RecordLabels, trace_labels
from insonify.tracers.registry import Tracer, make_tracer

if TYPE_CHECKING:
    import xarray as xr


@dataclass(frozen=True, eq=False)
class Simulation:
    """A scene made ready to trace any of its pings.

    Attributes
    ----------
    scene : Scene
        The declaration.
    plan : Plan
        Methods and settings of the tracing.
    ground : AnyGround
        The bed.
    arrays : SceneArrays
        The whole scene as tracers take it; of endless ground only the piece at the start of the track.
    reduced : SceneArrays
        The scene without the effects that the plan omits; this one is traced.
    tiles : TerrainTiles
        The ground about each ping, with as many nodes as the plan keeps.
    tracer : Tracer
        The method that finds echoes.
    reception : Reception
        The receiver, which turns echoes into the record.
    """

    scene: Scene
    plan: Plan
    ground: AnyGround
    arrays: SceneArrays
    reduced: SceneArrays
    tiles: TerrainTiles
    tracer: Tracer
    reception: Reception

    def poses(self, pings: NDArray[np.int64]) -> Poses:
        """Return position and attitude of the sonar at the given pings; beyond the track's last the tow goes on."""
        return make_poses(self.scene, self.ground, pings)

    def line(self, pings: NDArray[np.int64]) -> TowLine:
        """Return positions and headings along the line of the tow, without the motion of the fish about it."""
        return tow_line_at(self.scene, pings)

    def altitude(self, pings: NDArray[np.int64]) -> NDArray[np.float64]:
        """Return the altitude of the sonar above the bed, in metres, with the bed smoothed as a fish follows it."""
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
        poses = self.poses(pings)
        trace_pings = (self.reception.sums_waves and self.tracer.trace_waves) or self.tracer.trace

        def trace(arrays: SceneArrays) -> Traced:
            def trace_tile(tile: SceneArrays, some: Poses) -> tuple[Traced]:
                return (trace_pings(tile, some, **self.plan.settings),)

            return self.tiles.map(trace_tile, arrays, poses)[0]

        return record_echoes(self.reception, trace, self.reduced, pings)

    def truth(self, pings: NDArray[np.int64]) -> RecordLabels:
        """Label every range bin of the given pings.

        Parameters
        ----------
        pings : (n,) int64
            Ping numbers, from 0.

        Returns
        -------
        RecordLabels
            Arrays (n, 2, bins), port first. It comes from the geometry of the sweep whatever the method, and is that
            of an ideal pulse: a longer one carries each echo on into the bins that follow.
        """
        settings = {name: number for name, number in self.plan.settings.items() if name in ("planes", "rays")}

        def label_tile(tile: SceneArrays, some: Poses) -> RecordLabels:
            return trace_labels(tile, some, crosstalk=self.reception.crosstalk, **settings)

        return RecordLabels(*self.tiles.map(label_tile, self.reduced, self.poses(np.asarray(pings, dtype=np.int64))))


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
    refuse_track_off_bed(scene, ground)
    arrays = pack_scene(scene, ground)
    if not chosen.bent:
        arrays = arrays._replace(water=still_water(arrays.water.reference, arrays.water.surface))
    tracer = make_tracer(chosen.method, scene, arrays)
    kept, bed = ground, arrays.bed
    if chosen.every > 1:
        kept = ground.thinned(chosen.every)
        bed = make_bed(kept.around(scene.track.start, 0.0))
    return Simulation(
        scene=scene,
        plan=chosen,
        ground=ground,
        arrays=arrays,
        reduced=reduce_scene(arrays, bed=bed, ways=chosen.ways, bounces=chosen.bounces, targets=chosen.targets),
        tiles=TerrainTiles(kept, (arrays.bins + tracer.bins_beyond) * arrays.bin_length),
        tracer=tracer,
        reception=prepare_reception(scene, ground, arrays),
    )


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
        Whether to add labels of every bin: the target, the material, shadow, ground range, incidence and path, as
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
    attributes |= _sonar_attributes(scene) | _place_attributes(scene)
    if forced:
        attributes["model"] = " ".join(f"{subject}={choice}" for subject, choice in forced.items())
    size = simulation.plan.block if block is None else block
    for first in range(0, scene.track.pings, size):
        pings = np.arange(first, min(first + size, scene.track.pings), dtype=np.int64)
        yield _make_dataset(simulation, pings, attributes, truth)


def _sonar_attributes(scene: Scene) -> dict[str, float]:
    """Frequency in Hz, and the one-way widths and the depression of the beams in degrees, as far as they have any."""
    sonar = scene.sonar
    told = {
        "frequency": sonar.frequency,
        "beam_width": getattr(sonar.beam, "width", None),
        "vertical_beam_width": getattr(sonar.vertical, "width", None),
        "vertical_beam_tilt": getattr(sonar.vertical, "tilt", None),
    }
    return {name: value for name, value in told.items() if value is not None}


def _place_attributes(scene: Scene) -> dict[str, Any]:
    """Where the scene lies on Earth, if it says so."""
    origin = scene.world.origin
    return {} if origin is None else Georeference(scene.world.crs, origin).attributes()


def _make_dataset(
    simulation: Simulation, pings: NDArray[np.int64], attributes: dict[str, Any], truth: bool
) -> xr.Dataset:
    """Record of one block of pings."""
    import xarray as xr  # takes longer to import than a preview takes to trace

    scene, sonar, ground = simulation.scene, simulation.scene.sonar, simulation.ground
    slant_range = (np.arange(sonar.bins) + 0.5) * (sonar.range / sonar.bins)
    variables = echo_variable(simulation.intensity(pings))
    variables |= platform(platform_columns(simulation.poses(pings), ground))
    if truth:
        targets = [f"{target.kind}_{number}" for number, target in enumerate(scene.targets)]
        materials = [*ground.names, *(target.material.name for target in scene.targets)]
        variables |= label_variables(simulation.truth(pings)._asdict(), targets, materials, PATHS)
    coords = coordinates(pings / sonar.ping_rate, slant_range, recording_speed(scene, ground.datum))
    return xr.Dataset(variables, coords, attributes)
