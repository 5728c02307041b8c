"""Effects between echo and record: fluctuation, interference and ringing, one kind each, and reverberation."""

import math

from insonify.arrays import Floats
from insonify.scene.base import Family, Kind, decibels, parameter

REVERBERATIONS = Family("reverberations", "insonify.scene.receiver")
FLUCTUATIONS = Family("fluctuations", "insonify.scene.receiver")
INTERFERENCES = Family("interferences", "insonify.scene.receiver")
RINGINGS = Family("ringings", "insonify.scene.receiver")


class ReverberationKind(Kind):
    """Echoes of the water and its surface."""

    family = REVERBERATIONS

    @property
    def echoes(self) -> bool:
        """Whether the water or its surface echoes."""
        return self.of_volume is not None or self.of_surface is not None

    @property
    def of_volume(self) -> float | None:
        """Backscattering strength of a cubic metre of water, in dB; None where it does not echo."""
        return getattr(self, "volume_strength", None)

    @property
    def of_surface(self) -> float | None:
        """Backscattering strength of a square metre of the sea surface, in dB; None where it does not echo."""
        return getattr(self, "surface_strength", None)


class NoReverberation(ReverberationKind, kind="none", rank=10):
    """No reverberation: only the bed and the targets echo."""


class VolumeReverberation(ReverberationKind, kind="volume", rank=20):
    """Volume reverberation: the water echoes."""

    volume_strength: float = decibels(
        -70.0, "backscattering strength of a cubic metre of water", (-200.0, 0.0), (-100.0, -40.0)
    )


class SurfaceReverberation(ReverberationKind, kind="surface", rank=30):
    """Surface reverberation: the sea surface echoes."""

    surface_strength: float = decibels(
        -30.0, "backscattering strength of a square metre of the sea surface", (-200.0, 10.0), (-60.0, 0.0)
    )


class WholeReverberation(SurfaceReverberation, VolumeReverberation, kind="both", rank=40):
    """Volume and surface reverberation."""


class Lognormal(Kind, kind="lognormal"):
    """Levels of pings that fluctuate slowly, lognormal about the same mean intensity."""

    family = FLUCTUATIONS
    level: float = decibels(1.5, "standard deviation of the level", (0.0, 20.0), (0.0, 6.0))
    correlation_time: float = parameter(
        1.0, "time after which the correlation is 1/e", "s", gt=0.0, le=1e6, slider=(0.05, 100.0), log=True
    )
    travel_time: float = parameter(
        0.0, "rms time shift of a ping's echoes by the water", "s", ge=0.0, le=0.01, slider=(0.0, 1e-3)
    )


class OtherSonar(Kind, kind="sonar"):
    """Another sonar with its own ping rate: its pings cross the record as slanting rows of dashes."""

    family = INTERFERENCES
    level: float = decibels(
        -60.0,
        "received level of the pulses of that sonar, dB re the source at 1 m, or re 1 µPa with a source level",
        (-300.0, 250.0),
        (-120.0, 180.0),
    )
    ping_rate: float = parameter(7.3, "ping rate of that sonar", "Hz", ge=1e-3, le=1e4, slider=(0.5, 50.0), log=True)
    duration: float = parameter(
        1e-3, "duration of the pulses of that sonar", "s", gt=0.0, le=10.0, slider=(1e-5, 1e-2), log=True
    )


class DecayingRinging(Kind, kind="decay"):
    """Ringing of the transducer whose energy decays exponentially after transmission."""

    family = RINGINGS
    level: float = decibels(
        -40.0, "level at the end of the transmission, dB re the source at 1 m", (-300.0, 0.0), (-100.0, 0.0)
    )
    time: float = parameter(
        5e-4, "time in which its energy falls to 1/e", "s", gt=0.0, le=1.0, slider=(1e-5, 1e-2), log=True
    )

    def decibels(self, time: Floats) -> Floats:
        """Level in dB re the source at 1 m at times (s) after transmission."""
        return self.level - 10.0 / math.log(10.0) * time / self.time
