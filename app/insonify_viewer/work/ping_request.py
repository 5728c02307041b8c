"""What the window asks its worker for, and what the worker answers."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from insonify.scene import Scene
from insonify_viewer.state.modelling import Modelling

if TYPE_CHECKING:
    from insonify.display.normalisation import LevelBed
    from insonify.simulation import Simulation


@dataclass(frozen=True)
class PingRequest:
    """Pings wanted of a scene."""

    number: int  # number of the edit that the request is for
    scene: Scene  # scene to trace
    modelling: Modelling  # its modelling
    pings: NDArray[np.int64]  # (n,) pings wanted, the most urgent first
    # Whether to trace by the modelling; else one plane traces every few pings, and new endless ground is thinned.
    fine: bool


@dataclass(frozen=True)
class TracedPings:
    """Traced pings."""

    number: int  # as in the request
    fine: bool
    pings: NDArray[np.int64]  # (n,) their numbers
    amplitude: NDArray[np.float32]  # (n, 2, bins) amplitude relative to the level bed's
    level: LevelBed  # intensities of a level bed, at which the amplitude is 1
    simulation: Simulation  # the simulation that traced them
    seconds: float  # time that tracing took
    alike: int  # number of successive pings that share the amplitudes of the first of them
    # (n,) height of the sonar above the bed at each ping in metres; NaN where there is no bed.
    altitude: NDArray[np.float64]
    # (bins,) number of pings that the beam covers, over which the view still has to average.
    reach: NDArray[np.float64] | None = None
