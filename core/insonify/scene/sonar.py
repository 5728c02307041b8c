"""The sonar: beam, pulse, range and how the record is made from them."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Discriminator, Tag, model_validator

from insonify.errors import SceneError
from insonify.scene.base import Choice, Declaration, kind_of, parameter

MOST_BINS = 100_000  # of a record, and that a pulse may last


class Knife(Choice):
    """A beam without width: one upright line across the track, however the fish is pitched, 1 m wide by definition."""

    kind: Literal["knife"] = "knife"

    @property
    def words(self) -> str:
        """Name of the beam for captions."""
        return "knife-edge beam"


class Aimed(Choice):
    """A beam with a direction."""

    squint: float = parameter(
        0.0,
        unit="°",
        description="angle by which the beam is turned towards the bow",
        ge=-45.0,
        le=45.0,
        slider=(-10.0, 10.0),
    )

    def _named(self, name: str) -> str:
        return f"{name}, squint {self.squint:g}°" if self.squint else name


class Fan(Aimed):
    """A top-hat beam, one-way full width; the cell widens with range."""

    kind: Literal["fan"] = "fan"
    width: float = parameter(
        1.0, unit="°", description="one-way full beamwidth", ge=1e-3, le=60.0, slider=(0.1, 10.0), log=True
    )

    @property
    def words(self) -> str:
        """Name of the beam for captions."""
        return self._named(f"fan {self.width:g}°")


class Gaussian(Aimed):
    """A bell-shaped beam without sidelobes."""

    kind: Literal["gaussian"] = "gaussian"
    width: float = parameter(
        1.0, unit="°", description="one-way full beamwidth to -3 dB", ge=1e-3, le=60.0, slider=(0.1, 10.0), log=True
    )
    two_way: bool = parameter(True, description="whether sound passes the beam going and coming, or once")

    @property
    def words(self) -> str:
        """Name of the beam for captions."""
        return self._named(f"gaussian {self.width:g}° {'two' if self.two_way else 'one'}-way")


class LineArray(Aimed):
    """The beam of a line of transducers, with its sidelobes, wider than far away within its near field."""

    kind: Literal["array"] = "array"
    length: float = parameter(
        0.5, unit="m", description="length of the array along the fish", gt=0.0, le=20.0, slider=(0.1, 2.0), log=True
    )
    taper: Literal["uniform", "cosine", "hamming", "taylor"] = parameter(
        "uniform", description="weight of the elements; a tapered array has lower sidelobes and a wider beam"
    )
    two_way: bool = parameter(True, description="whether sound passes the beam going and coming, or once")

    @property
    def words(self) -> str:
        """Name of the beam for captions."""
        return self._named(f"{self.taper} array of {self.length:g} m {'two' if self.two_way else 'one'}-way")


class Uniform(Choice):
    """Equal sensitivity at every grazing angle."""

    kind: Literal["uniform"] = "uniform"

    @property
    def words(self) -> str:
        """Name of the beam for captions: none, for it leaves nothing out."""
        return ""


class Tilted(Choice):
    """A vertical beam with an axis."""

    width: float = parameter(
        50.0, unit="°", description="one-way full width; to -3 dB of a gaussian", ge=1e-3, le=170.0, slider=(5.0, 90.0)
    )
    tilt: float = parameter(
        30.0, unit="°", description="depression of the axis below the level fish", ge=-90.0, le=90.0, slider=(0.0, 60.0)
    )

    def _named(self, name: str) -> str:
        return f"vertical {name} {self.width:g}° tilted {self.tilt:g}°"


class VerticalFan(Tilted):
    """A vertical top-hat: all within its width, nothing beyond."""

    kind: Literal["fan"] = "fan"

    @property
    def words(self) -> str:
        """Name of the beam for captions."""
        return self._named("fan")


class VerticalGaussian(Tilted):
    """A bell-shaped vertical beam."""

    kind: Literal["gaussian"] = "gaussian"

    @property
    def words(self) -> str:
        """Name of the beam for captions."""
        return self._named("gaussian")


class Ideal(Choice):
    """A pulse shorter than any bin."""

    kind: Literal["ideal"] = "ideal"


class Tone(Choice):
    """A gated tone: every echo lasts as long as the pulse."""

    kind: Literal["tone"] = "tone"
    duration: float = parameter(
        1e-4, unit="s", description="length of the pulse", gt=0.0, le=0.1, slider=(1e-5, 1e-3), log=True
    )


class Chirp(Choice):
    """A sweep of frequencies, compressed by a matched filter: an echo is as short as the bandwidth allows."""

    kind: Literal["chirp"] = "chirp"
    duration: float = parameter(
        1e-3, unit="s", description="length of the pulse", gt=0.0, le=0.1, slider=(1e-4, 1e-2), log=True
    )
    bandwidth: float = parameter(
        30e3, unit="Hz", description="frequencies swept", gt=0.0, le=1e6, slider=(5e3, 2e5), log=True
    )
    window: Literal["uniform", "hamming", "hann"] = parameter(
        "hamming", description="weight of the frequencies; a tapered one has lower sidelobes and is less sharp"
    )

    @model_validator(mode="after")
    def _long_enough(self) -> Chirp:
        if self.duration * self.bandwidth < 1.0:
            raise ValueError(
                f"bandwidth {self.bandwidth:g} Hz is less than a pulse of {self.duration:g} s has; "
                f"raise it to {1.0 / self.duration:.4g} Hz or more, or lengthen the pulse"
            )
        return self


Beam = Annotated[
    Annotated[Knife, Tag("knife")]
    | Annotated[Fan, Tag("fan")]
    | Annotated[Gaussian, Tag("gaussian")]
    | Annotated[LineArray, Tag("array")],
    Discriminator(lambda value: kind_of(value, "fan")),
]
Vertical = Annotated[
    Annotated[Uniform, Tag("uniform")]
    | Annotated[VerticalFan, Tag("fan")]
    | Annotated[VerticalGaussian, Tag("gaussian")],
    Discriminator(lambda value: kind_of(value, "uniform")),
]
Pulse = Annotated[
    Annotated[Ideal, Tag("ideal")] | Annotated[Tone, Tag("tone")] | Annotated[Chirp, Tag("chirp")],
    Discriminator(lambda value: kind_of(value, "tone")),
]


class Sonar(Declaration):
    """A side-scan sonar with a port and a starboard channel."""

    frequency: float = parameter(
        400e3, unit="Hz", description="carrier frequency", ge=1e3, le=2e6, slider=(5e4, 1.2e6), log=True
    )
    beam: Beam = parameter(Fan(), description="horizontal beam")
    vertical: Vertical = parameter(Uniform(), description="vertical beam")
    pulse: Pulse = parameter(Tone(), description="transmitted pulse")
    range: float = parameter(
        50.0, unit="m", description="slant range of the last bin", gt=0.0, le=1e4, slider=(10.0, 200.0), log=True
    )
    bins: int = parameter(1000, description="range bins per side", ge=1, le=MOST_BINS, slider=(100, 4000), log=True)
    ping_rate: float = parameter(
        10.0,
        unit="Hz",
        description="pings per second, at most c / (2 range)",
        ge=1e-3,
        le=1e4,
        slider=(0.5, 50.0),
        log=True,
    )
    law: Literal["sonar", "light"] = parameter(
        "sonar", description="energy of the insonified area, or the paper's radiance per ray"
    )
    bounces: int = parameter(
        0, description="mirror-like bounces and passages followed after the first echo", ge=0, le=16, slider=(0, 8)
    )

    def refuse_haste(self, sound_speed: float) -> None:
        """Refuse pings that follow each other before echoes from the whole range are back.

        Parameters
        ----------
        sound_speed : float
            Of the water at the sonar, in m/s.

        Raises
        ------
        SceneError
        """
        fastest = sound_speed / (2.0 * self.range)
        if self.ping_rate > fastest:
            raise SceneError(
                f"sonar.ping_rate {self.ping_rate:g} Hz leaves no time for echoes from {self.range:g} m; "
                f"lower it to {fastest:.4g} Hz or shorten sonar.range"
            )

    def refuse_long_pulse(self, sound_speed: float) -> None:
        """Refuse a pulse that lasts more bins than can be told apart.

        Parameters
        ----------
        sound_speed : float
            Of the water at the sonar, in m/s.

        Raises
        ------
        SceneError
        """
        bin_length = self.range / self.bins
        longest = MOST_BINS * bin_length / (0.5 * sound_speed)
        if not isinstance(self.pulse, Ideal) and self.pulse.duration > longest:
            raise SceneError(
                f"sonar.pulse.duration {self.pulse.duration:g} s lasts over {MOST_BINS} bins of {bin_length:.3g} m; "
                f"shorten it to {longest:.3g} s, lengthen sonar.range or lower sonar.bins"
            )
