"""Receiver of the sonar: speckle, reverberation, noise and other waves, gain, recorder."""

from __future__ import annotations

from typing import Annotated

from insonify.scene.base import Declaration, parameter
from insonify.scene.kinds import KindOf
from insonify.scene.receiver.fluctuations import FLUCTUATIONS, FluctuationKind
from insonify.scene.receiver.fluctuations.none import NoFluctuation
from insonify.scene.receiver.gains import GAINS, GainKind
from insonify.scene.receiver.gains.none import NoTvg
from insonify.scene.receiver.interferences import INTERFERENCES, InterferenceKind
from insonify.scene.receiver.interferences.none import NoInterference
from insonify.scene.receiver.noises import NOISES, NoiseKind
from insonify.scene.receiver.noises.none import NoNoise
from insonify.scene.receiver.recorder import Recorder
from insonify.scene.receiver.reverberations import REVERBERATIONS, ReverberationKind
from insonify.scene.receiver.reverberations.none import NoReverberation
from insonify.scene.receiver.ringings import RINGINGS, RingingKind
from insonify.scene.receiver.ringings.none import NoRinging
from insonify.scene.receiver.speckles import SPECKLES, SpeckleKind
from insonify.scene.receiver.speckles.none import NoSpeckle


class Receiver(Declaration):
    """Effects between the echo and the record: speckle, reverberation, noise and other waves, gain, recorder."""

    speckle: Annotated[SpeckleKind, KindOf(SPECKLES, default="none")] = parameter(
        NoSpeckle(), description="interference of scatterers within a cell"
    )
    fluctuation: Annotated[FluctuationKind, KindOf(FLUCTUATIONS, default="none")] = parameter(
        NoFluctuation(), description="variation of the level from ping to ping", rare=True
    )
    reverberation: Annotated[ReverberationKind, KindOf(REVERBERATIONS, default="none")] = parameter(
        NoReverberation(), description="echoes of the water and its surface"
    )
    noise: Annotated[NoiseKind, KindOf(NOISES, default="none")] = parameter(
        NoNoise(), description="noise received besides the echoes"
    )
    interference: Annotated[InterferenceKind, KindOf(INTERFERENCES, default="none")] = parameter(
        NoInterference(), description="pings of another sonar", rare=True
    )
    ringing: Annotated[RingingKind, KindOf(RINGINGS, default="none")] = parameter(
        NoRinging(), description="ringing of the transducer after transmission", rare=True
    )
    source_level: float = parameter(
        0.0,
        unit="dB",
        description="level of the source at 1 m, dB re 1 µPa; at 0 the record is relative to the source",
        ge=0.0,
        le=300.0,
        slider=(0.0, 240.0),
    )
    tvg: Annotated[GainKind, KindOf(GAINS, default="none")] = parameter(NoTvg(), description="time-varied gain")
    crosstalk: float | None = parameter(
        None,
        unit="dB",
        description="level at which each side receives the other's echoes (not at all when left out)",
        ge=-200.0,
        le=0.0,
        slider=(-80.0, 0.0),
        rare=True,
    )
    recorder: Recorder = parameter(Recorder(), description="amplifier and converter")

    @property
    def steady(self) -> bool:
        """Whether all pings are received and recorded alike, without anything random or timed."""
        kinds = {part.kind for part in (self.speckle, self.fluctuation, self.noise, self.interference)}
        return kinds == {"none"} and self.recorder.dropped_pings == 0.0 and len(self.recorder.gain_steps) == 1
