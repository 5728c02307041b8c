"""Recorder: gain of the last amplifier, converter and losses on the way to the file."""

from typing import Annotated, Literal

from pydantic import Field, field_validator

from insonify.scene.base import Declaration, check_increasing, decibels, parameter, share

MOST_GAIN = 200.0  # dB, either way
Seconds = Annotated[float, Field(ge=0.0, le=1e9)]
Decibels = Annotated[float, Field(ge=-MOST_GAIN, le=MOST_GAIN)]
GainSteps = Decibels | tuple[tuple[Seconds, Decibels], ...]


class Recorder(Declaration):
    """Amplifier and converter after detection; with the defaults the record is what the receiver detects."""

    gain: GainSteps = parameter(
        0.0,
        "operator's gain: a number, or [[time in s, gain], ...], each kept until the next",
        "dB",
        slider=(-20.0, 40.0),
    )
    side_gain: float = decibels(0.0, "gain of port over starboard", (-MOST_GAIN, MOST_GAIN), (-12.0, 12.0))
    bits: Literal["float", 8, 16] = parameter(
        "float", "bits of the converter that records the amplitude; float: no rounding"
    )
    full_scale: float | None = decibels(
        None,
        "level at which the converter clips (when left out: the greatest level of a flat bed of albedo 1, "
        "raised until a step of amplitude is a power of two; no clipping with float)",
        (-400.0, 400.0),
        (-150.0, 200.0),
    )
    dropped_pings: float = share(0.0, "share of pings that are lost and recorded as 0", shown=0.1)

    @field_validator("gain")
    @classmethod
    def _steps_in_order(cls, gain: GainSteps) -> GainSteps:
        if isinstance(gain, tuple):
            if not gain:
                raise ValueError("is empty; give a number or [[time, gain], ...]")
            check_increasing("time", gain)
        return gain

    @property
    def gain_steps(self) -> tuple[tuple[float, float], ...]:
        """Times (s) from which each gain (dB) applies; the first also applies before its time."""
        return self.gain if isinstance(self.gain, tuple) else ((0.0, self.gain),)
