"""Requests of the window to the simulator, and its answers."""

from dataclasses import dataclass, fields
from typing import Any, NamedTuple

import numpy as np

from insonify.arrays import Booleans, Floats, Integers, Singles
from insonify.scene import Scene
from insonify_viewer.core_types import AnyGround, LevelBed, Simulation
from insonify_viewer.state.history import Modelling

INTERPOLATED, COARSE, FINE, FINENESSES = 0, 1, 2, 3  # of a picture


@dataclass(frozen=True)
class PingRequest:
    """Request for pings of a scene."""

    number: int  # number of the edit that the request is for
    scene: Scene  # scene to trace
    modelling: Modelling  # its modelling
    pings: Integers  # (n,) pings wanted, the most urgent first
    # Whether to trace by the modelling; else by one plane, over new endless ground that is thinned, and at first, if
    # that takes long, every few pings.
    fine: bool

    @property
    def stamp(self) -> int:
        """Least stamp of the rows of a record that answer it."""
        return stamp_of(self.number, FINE if self.fine else COARSE)


@dataclass(frozen=True)
class TracedPings:
    """Traced pings."""

    number: int  # as in the request
    fine: bool
    pings: Integers  # (n,) their numbers
    amplitude: Singles  # (n, 2, bins) amplitude relative to the level bed's
    level: LevelBed  # intensities of a level bed, at which the amplitude is 1
    simulation: Simulation  # the simulation that traced them
    seconds: float  # time that tracing took
    between: Booleans  # (n,) whether amplitudes are interpolated between traced pings
    # (n,) height of the sonar above the bed at each ping in metres; NaN where there is no bed.
    altitude: Floats
    # (bins,) number of pings that the beam covers, over which the view still has to average.
    reach: Floats | None = None
    error: Singles | None = None  # (n,) estimated errors; None of interpolated and coarse pings
    drawn: Any = None  # as `Simulator.draw` has made it of them beside the window
    example: bool = False  # whether they come with the package, shown until the first pings are traced

    @property
    def stamps(self) -> Integers:
        """Stamp of each ping, (n,): later edits and finer pictures have greater ones."""
        return stamp_of(self.number, np.where(self.between, INTERPOLATED, FINE if self.fine else COARSE))


def stamp_of(number: int, fineness: Any) -> Any:
    """Stamp of a picture of an edit: later edits and finer pictures have greater ones."""
    return number * FINENESSES + fineness


class SimulatedScene(NamedTuple):
    """A scene that is ready to be traced, and its record on a level bed."""

    simulation: Simulation
    level: LevelBed


def find_altitude(simulation: Simulation, pings: Integers) -> Floats:
    """Height of the sonar above the bed at pings, in metres; NaN where there is no bed."""
    poses = simulation.poses(pings)
    return np.asarray(poses.z - simulation.ground.height_at(poses.x, poses.y))


def is_same_ground(one: AnyGround, other: AnyGround) -> bool:
    """Whether two grounds hold the very same arrays, at the same place, of the same materials."""
    if type(one) is not type(other):
        return False
    parts: list[tuple[Any, Any]] = [
        (getattr(one, field.name), getattr(other, field.name)) for field in fields(one) if field.init
    ]
    return all(a is b or (not isinstance(a, np.ndarray) and bool(a == b)) for a, b in parts)
