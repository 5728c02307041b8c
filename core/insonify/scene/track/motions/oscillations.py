"""Sinusoidal motions, each along or about the axis that its kind names."""

import math
from typing import cast

import numpy as np

from insonify.arrays import Floats
from insonify.scene.base import angle, parameter
from insonify.scene.track.motions import Axis, SingleMotion


class Oscillation(SingleMotion):
    """A sinusoidal motion: amplitude · sin(2π t / period + phase), t seconds after the first ping."""

    keeps_line = True
    amplitude: float
    period: float = parameter(8.0, "period of the motion", "s", ge=0.1, le=1e5, slider=(1.0, 60.0), log=True)
    phase: float = angle("phase of the motion at the first ping", rare=True)

    def displacement(self, time: Floats) -> dict[Axis, Floats]:
        """Displacement of the towfish along or about its axis at times after the first ping."""
        # Whole periods are subtracted first, so that the sine is as exact far along the tow.
        turns = np.remainder(time / self.period, 1.0) + self.phase / 360.0
        return {cast("Axis", self.kind): self.amplitude * np.sin(2.0 * math.pi * turns)}

    @property
    def greatest_sway(self) -> float:
        """Amplitude along or across the line, in metres."""
        return self.amplitude if self.kind in ("surge", "sway") else 0.0

    @property
    def greatest_heave(self) -> float:
        """Amplitude of a heave, in metres."""
        return self.amplitude if self.kind == "heave" else 0.0


class Surge(Oscillation, kind="surge", rank=15):
    """Surge: the towfish speeds up and slows down along its line, so that pings lie closer or farther apart."""

    amplitude: float = parameter(
        0.5, "greatest distance ahead of a tow at constant speed", "m", ge=0.0, le=100.0, slider=(0.0, 5.0)
    )


class Sway(Oscillation, kind="sway", rank=20):
    """Sway to port and starboard of the line; the towfish keeps its heading and crabs."""

    amplitude: float = parameter(0.5, "greatest distance to port of the line", "m", ge=0.0, le=100.0, slider=(0.0, 5.0))


class Heave(Oscillation, kind="heave", rank=30):
    """Heave: the towfish rises and sinks."""

    amplitude: float = parameter(
        0.5, "greatest rise above the track's own height", "m", ge=0.0, le=1000.0, slider=(0.0, 3.0)
    )


class Yaw(Oscillation, kind="yaw", rank=40):
    """Yaw: the axis of the towfish turns to port and starboard of the line; the course stays."""

    amplitude: float = parameter(2.0, "greatest turn of the axis to port", "°", ge=0.0, le=60.0, slider=(0.0, 15.0))


class Pitch(Oscillation, kind="pitch", rank=50):
    """Pitch: the bow rises and sinks."""

    tilts = True
    amplitude: float = parameter(2.0, "greatest angle of the bow upwards", "°", ge=0.0, le=60.0, slider=(0.0, 15.0))


class Roll(Oscillation, kind="roll", rank=60):
    """Roll: the port side rises and sinks."""

    tilts = True
    amplitude: float = parameter(
        3.0, "greatest angle of the port side upwards", "°", ge=0.0, le=60.0, slider=(0.0, 15.0)
    )
