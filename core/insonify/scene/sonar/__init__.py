"""Sonar of a scene: beam, pulse, range, bins and scattering law."""

from typing import Annotated, Literal

from insonify.errors import SceneError
from insonify.scene.base import Declaration, KindOf, metres, parameter
from insonify.scene.sonar.beams import BEAMS, BeamKind, FanBeam
from insonify.scene.sonar.pulses import PULSES, PulseKind, Tone
from insonify.scene.sonar.vertical_beams import VERTICAL_BEAMS, UniformVerticalBeam, VerticalBeamKind

MOST_BINS = 100_000  # greatest number of bins per side of a record, and of bins that a pulse may last


class Sonar(Declaration):
    """A side-scan sonar with a port and a starboard channel."""

    preset: str | None = parameter(
        None, "named sonar, whose values apply to all fields that are left out; sonar = 'NAME' is short for it"
    )
    frequency: float = parameter(400e3, "carrier frequency", "Hz", ge=1e3, le=2e6, slider=(5e4, 1.2e6), log=True)
    beam: Annotated[BeamKind, KindOf(BEAMS, default="fan")] = parameter(FanBeam, "horizontal beam")
    vertical: Annotated[VerticalBeamKind, KindOf(VERTICAL_BEAMS, default="uniform")] = parameter(
        UniformVerticalBeam, "vertical beam"
    )
    pulse: Annotated[PulseKind, KindOf(PULSES, default="tone")] = parameter(Tone, "transmitted pulse")
    range: float = metres(50.0, "slant range of the last bin", (10.0, 200.0), most=1e4)
    bins: int = parameter(1000, "range bins per side", ge=1, le=MOST_BINS, slider=(100, 4000), log=True)
    ping_rate: float = parameter(
        10.0, "pings per second, at most c / (2 range)", "Hz", ge=1e-3, le=1e4, slider=(0.5, 50.0), log=True
    )
    law: Literal["sonar", "light"] = parameter(
        "sonar", "backscatter of the insonified area (sonar), or the paper's radiance per ray (light)"
    )
    bounces: int = parameter(
        0, "specular reflections and refractions followed after the first echo", ge=0, le=16, slider=(0, 8), rare=True
    )

    @property
    def scattering_frequency(self) -> float | None:
        """Frequency in Hz at which sediments scatter; None for the law of light, which has none."""
        return None if self.law == "light" else self.frequency

    def check_ping_rate(self, sound_speed: float) -> None:
        """Raise SceneError if a ping follows before the echoes from the whole range have returned."""
        fastest = sound_speed / (2.0 * self.range)
        if self.ping_rate > fastest:
            raise SceneError(
                f"sonar.ping_rate {self.ping_rate:g} Hz leaves no time for echoes from {self.range:g} m; "
                f"lower it to {fastest:.4g} Hz or shorten sonar.range"
            )

    def check_pulse_length(self, sound_speed: float) -> None:
        """Raise SceneError if a pulse lasts more bins than a record may have."""
        bin_length = self.range / self.bins
        longest = MOST_BINS * bin_length / (0.5 * sound_speed)
        if self.pulse.length > longest:
            raise SceneError(
                f"sonar.pulse.duration {self.pulse.length:g} s lasts over {MOST_BINS} bins of {bin_length:.3g} m; "
                f"shorten it to {longest:.3g} s, lengthen sonar.range or lower sonar.bins"
            )
