"""Receiver of the sonar: speckle, reverberation, noise and other waves, gain, recorder."""

from typing import Annotated, Self

from pydantic import model_validator

from insonify.scene.base import Declaration, KindOf, decibels, parameter
from insonify.scene.receiver.effects import (
    FLUCTUATIONS,
    INTERFERENCES,
    REVERBERATIONS,
    RINGINGS,
    DecayingRinging,
    Lognormal,
    NoReverberation,
    OtherSonar,
    ReverberationKind,
)
from insonify.scene.receiver.gains import GAINS, GainKind, NoTvg
from insonify.scene.receiver.noises import NOISES, NoiseKind
from insonify.scene.receiver.recorder import Recorder
from insonify.scene.receiver.speckles import SPECKLES, NoSpeckle, SpeckleKind


class Receiver(Declaration):
    """Effects between the echo and the record: speckle, reverberation, noise and other waves, gain, recorder."""

    speckle: Annotated[SpeckleKind, KindOf(SPECKLES, default="none")] = parameter(
        NoSpeckle, "interference of scatterers within a cell"
    )
    fluctuation: Annotated[Lognormal | None, KindOf(FLUCTUATIONS, optional=True)] = parameter(
        None, "variation of the level from ping to ping", rare=True
    )
    reverberation: Annotated[ReverberationKind, KindOf(REVERBERATIONS, default="none")] = parameter(
        NoReverberation, "echoes of the water and its surface"
    )
    noise: Annotated[NoiseKind | None, KindOf(NOISES, optional=True)] = parameter(
        None, "noise received besides the echoes"
    )
    interference: Annotated[OtherSonar | None, KindOf(INTERFERENCES, optional=True)] = parameter(
        None, "pings of another sonar", rare=True
    )
    ringing: Annotated[DecayingRinging | None, KindOf(RINGINGS, optional=True)] = parameter(
        None, "ringing of the transducer after transmission", rare=True
    )
    source_level: float = decibels(
        0.0,
        "level of the source at 1 m, dB re 1 µPa; at 0 the record is relative to the source",
        (0.0, 300.0),
        (0.0, 240.0),
    )
    tvg: Annotated[GainKind, KindOf(GAINS, default="none")] = parameter(NoTvg, "time-varied gain")
    crosstalk: float | None = decibels(
        None,
        "level at which each side receives the other's echoes (not at all when left out)",
        (-200.0, 0.0),
        (-80.0, 0.0),
        rare=True,
    )
    recorder: Recorder = parameter(Recorder, "amplifier and converter")

    @model_validator(mode="after")
    def _noise_in_micropascals_needs_a_source(self) -> Self:
        if self.noise is not None and self.noise.absolute and self.source_level == 0.0:
            raise ValueError(
                f"receiver.noise {self.noise.kind!r} is in dB re 1 µPa and receiver.source_level 0 is relative; "
                "give the level of the source, such as 210, or a noise of the kind 'snr'"
            )
        return self

    @property
    def steady(self) -> bool:
        """Whether all pings are received and recorded alike, without anything random or timed."""
        varying = self.speckle.speckled or self.fluctuation or self.noise or self.interference
        return not varying and self.recorder.dropped_pings == 0.0 and len(self.recorder.gain_steps) == 1
