"""What the window asks its worker for, and what the worker answers."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from insonify.scene import Scene
from insonify_viewer.modelling import Modelling

if TYPE_CHECKING:
    from insonify.display.normalisation import LevelBed
    from insonify.simulation import Simulation


@dataclass(frozen=True)
class PingRequest:
    """Pings wanted of a scene.

    Attributes
    ----------
    number : int
        Number of the edit that the request is for.
    scene : Scene
        Scene to trace.
    modelling : Modelling
        Its modelling.
    pings : (n,) int64
        Pings wanted, the most urgent first.
    fine : bool
        Whether to trace by the modelling; else one plane traces every few pings, and new endless ground is thinned.
    """

    number: int
    scene: Scene
    modelling: Modelling
    pings: NDArray[np.int64]
    fine: bool


@dataclass(frozen=True)
class TracedPings:
    """Traced pings.

    Attributes
    ----------
    number, fine
        As in the request.
    pings : (n,) int64
        Their numbers.
    amplitude : (n, 2, bins) float32
        Amplitude relative to the level bed's.
    level : LevelBed
        Intensities of a level bed, at which the amplitude is 1.
    simulation : Simulation
        The simulation that traced them.
    seconds : float
        Time that tracing took.
    alike : int
        Number of successive pings that share the amplitudes of the first of them.
    altitude : (n,) float64
        Height of the sonar above the bed at each ping in metres; NaN where there is no bed.
    reach : (bins,) float64, optional
        Number of pings that the beam covers, over which the view still has to average.
    """

    number: int
    fine: bool
    pings: NDArray[np.int64]
    amplitude: NDArray[np.float32]
    level: LevelBed
    simulation: Simulation
    seconds: float
    alike: int
    altitude: NDArray[np.float64]
    reach: NDArray[np.float64] | None = None
