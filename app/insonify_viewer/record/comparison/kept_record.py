"""A simulated record that is kept while the scene changes."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from insonify_viewer.record.record import Record, pings_held
from insonify_viewer.state.modelling import Modelling

if TYPE_CHECKING:
    from insonify.display.normalisation import LevelBed
    from insonify.scene import Scene
    from insonify.simulation import Simulation
    from insonify_viewer.work.ping_request import TracedPings

BLOCK_TIME = 0.1  # s, predicted for a block of pings, after which it is shown
Traced = tuple[NDArray[np.float32], NDArray[np.float64]]
STAMP = 0  # of all rows: a kept record does not change


class SimulatedScene(NamedTuple):
    """A scene that is ready to be traced, and its record on a level bed."""

    simulation: Simulation
    level: LevelBed


def find_altitude(simulation: Simulation, pings: NDArray[np.int64]) -> NDArray[np.float64]:
    """Height of the sonar above the bed at pings, in metres; NaN where there is no bed."""
    poses = simulation.poses(pings)
    return np.asarray(poses.z - simulation.ground.height_at(poses.x, poses.y))


class KeptRecord:
    """The record of a scene under one modelling, traced where it is looked at."""

    def __init__(self, scene: Scene, modelling: Modelling, simulated: SimulatedScene | None = None) -> None:
        self.scene, self.modelling, self.simulated = scene, modelling, simulated
        self.record = Record(pings_held(scene), scene.sonar.bins)

    @classmethod
    def of(cls, record: Record, modelling: Modelling, answer: TracedPings) -> KeptRecord:
        """Copy the pings of a record on screen that were traced for the request of an answer."""
        simulation = answer.simulation
        kept = cls(simulation.scene, modelling, SimulatedScene(simulation, answer.level))
        kept.record.amplitude[:] = record.amplitude
        kept.record.ping[:] = np.where(record.stamp == 2 * answer.number + answer.fine, record.ping, -1)
        kept.record.stamp[:] = STAMP
        kept.record.altitude[:] = record.altitude
        return kept

    def missing(self, top: int) -> NDArray[np.int64]:
        """Pings that are on screen below a ping on top, and not traced yet; as many as take a moment."""
        missing = self.record.missing(top, STAMP)
        return missing if self.simulated is None else missing[: self.simulated.simulation.pings_within(BLOCK_TIME)]

    def trace(self, pings: NDArray[np.int64]) -> Traced:
        """Trace pings: amplitudes relative to a level bed, (n, 2, bins), and altitudes, (n,), in metres."""
        assert self.simulated is not None
        simulation, level = self.simulated
        return level.amplitudes(pings), find_altitude(simulation, pings)

    def put(
        self, pings: NDArray[np.int64], amplitude: NDArray[np.float32], altitude: NDArray[np.float64]
    ) -> NDArray[np.int64]:
        """Store traced pings; return the rows they took."""
        return self.record.put(pings, amplitude, STAMP, altitude)
