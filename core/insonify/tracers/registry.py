"""The tracers, their common interface, and the choice of the one that traces a scene."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

from insonify.kernels.common.types import SceneArrays
from insonify.scene import Scene
from insonify.tracers import march, rays, scatterers, sweep
from insonify.tracers.base import Record
from insonify.tracers.scatterers import Waves


class Tracer(Protocol):
    """Traces the pings of a scene."""

    @property
    def bins_beyond(self) -> int:
        """Bins beyond the record's last whose echoes the tracer sums into the record."""

    @property
    def trace(self) -> Callable[..., Record]:
        """Trace pings: called with the scene's arrays, the poses of n pings and the plan's settings.

        Returns (n, 2, bins) float32, the intensity of port and starboard; raises a SceneError if the sonar is inside
        a target. A ping's record depends on its own pose alone, not on the other pings nor on the number of threads.
        """

    @property
    def trace_waves(self) -> Callable[..., Waves] | None:
        """Trace pings likewise, but return the complex amplitudes of every bin's samples, (n, 2, bins * samples).

        None for a tracer that sums the energy of echoes, which has no phases.
        """


@dataclass(frozen=True)
class EnergyTracer:
    """A tracer that sums the energy of echoes, from a scene's arrays alone."""

    trace: Callable[..., Record]
    bins_beyond: int = 0
    trace_waves: None = None


def _energy(trace: Callable[..., Record]) -> Callable[[Scene, SceneArrays], Tracer]:
    return lambda scene, arrays: EnergyTracer(trace)


TRACERS: dict[str, Callable[[Scene, SceneArrays], Tracer]] = {
    "sweep": _energy(sweep.trace),
    "march": _energy(march.trace),
    "rays": _energy(rays.trace),
    "scatterers": scatterers.make_tracer,
}


def make_tracer(method: str, scene: Scene, arrays: SceneArrays) -> Tracer:
    """Make the tracer of a scene ready."""
    coherent = scene.receiver.speckle.interferes
    return TRACERS["scatterers" if coherent else method](scene, arrays)
