"""What the receiver does to the echo, and what it hears besides."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Discriminator, Tag

from insonify.scene.base import Choice, Declaration, kind_of, parameter


class NoSpeckle(Choice):
    """The mean echo."""

    kind: Literal["none"] = "none"


class Rayleigh(Choice):
    """Fully developed speckle: the intensity of every bin is exponential about its mean."""

    kind: Literal["rayleigh"] = "rayleigh"
    looks: int = parameter(1, description="independent records averaged", ge=1, le=64, slider=(1, 16), log=True)


class K(Choice):
    """Speckle of few scatterers: Rayleigh speckle of a bed whose strength is itself gamma-distributed."""

    kind: Literal["k"] = "k"
    shape: float = parameter(
        2.0,
        description="shape of the gamma distribution; fewer scatterers make it smaller and the speckle spikier",
        ge=0.01,
        le=1e4,
        slider=(0.1, 100.0),
        log=True,
    )
    looks: int = parameter(1, description="independent records averaged", ge=1, le=64, slider=(1, 16), log=True)
    cell: float | None = parameter(
        None,
        unit="m²",
        description="area that the shape refers to: it grows with the cell, hence with range and pulse; "
        "the same shape everywhere when left out",
        gt=0.0,
        le=1e6,
        slider=(1e-3, 10.0),
        log=True,
    )


class Coherent(Choice):
    """Every patch of bed and target carries scatterers whose echoes interfere; slow, and by the sweep alone."""

    kind: Literal["coherent"] = "coherent"
    density: float | None = parameter(
        None,
        unit="1/m²",
        description="scatterers per area, on average; 32 in a cell at half the range when left out",
        gt=0.0,
        le=1e6,
        slider=(1.0, 1e4),
        log=True,
    )


Speckle = Annotated[
    Annotated[NoSpeckle, Tag("none")]
    | Annotated[Rayleigh, Tag("rayleigh")]
    | Annotated[K, Tag("k")]
    | Annotated[Coherent, Tag("coherent")],
    Discriminator(lambda value: kind_of(value, "none")),
]


class NoFluctuation(Choice):
    """Every ping is as loud as the next."""

    kind: Literal["none"] = "none"


class Lognormal(Choice):
    """The loudness of pings wanders, lognormal about the same mean intensity."""

    kind: Literal["lognormal"] = "lognormal"
    level: float = parameter(
        1.5, unit="dB", description="standard deviation of the level", ge=0.0, le=20.0, slider=(0.0, 6.0)
    )
    correlation_time: float = parameter(
        1.0,
        unit="s",
        description="time after which the correlation is 1/e",
        gt=0.0,
        le=1e6,
        slider=(0.05, 100.0),
        log=True,
    )
    travel_time: float = parameter(
        0.0,
        unit="s",
        description="rms by which the water shifts a ping's echoes in time",
        ge=0.0,
        le=0.01,
        slider=(0.0, 1e-3),
    )


Fluctuation = Annotated[
    Annotated[NoFluctuation, Tag("none")] | Annotated[Lognormal, Tag("lognormal")],
    Discriminator(lambda value: kind_of(value, "none")),
]


def _volume_strength() -> float:
    return parameter(
        -70.0,
        unit="dB",
        description="backscattering strength of a cubic metre of water",
        ge=-200.0,
        le=0.0,
        slider=(-100.0, -40.0),
    )


def _surface_strength() -> float:
    return parameter(
        -30.0,
        unit="dB",
        description="backscattering strength of a square metre of the sea surface",
        ge=-200.0,
        le=10.0,
        slider=(-60.0, 0.0),
    )


class NoReverberation(Choice):
    """Only the bed and what lies on it echo."""

    kind: Literal["none"] = "none"


class VolumeReverberation(Choice):
    """The water echoes."""

    kind: Literal["volume"] = "volume"
    volume_strength: float = _volume_strength()


class SurfaceReverberation(Choice):
    """The sea surface echoes."""

    kind: Literal["surface"] = "surface"
    surface_strength: float = _surface_strength()


class WholeReverberation(Choice):
    """Both the water and its surface echo."""

    kind: Literal["both"] = "both"
    volume_strength: float = _volume_strength()
    surface_strength: float = _surface_strength()


Reverberation = Annotated[
    Annotated[NoReverberation, Tag("none")]
    | Annotated[VolumeReverberation, Tag("volume")]
    | Annotated[SurfaceReverberation, Tag("surface")]
    | Annotated[WholeReverberation, Tag("both")],
    Discriminator(lambda value: kind_of(value, "none")),
]


class NoNoise(Choice):
    """Silence where nothing echoes."""

    kind: Literal["none"] = "none"


class AmbientNoise(Choice):
    """Noise of the sea and the set, of exponential intensity."""

    kind: Literal["ambient"] = "ambient"
    level: float = parameter(
        -110.0,
        unit="dB",
        description="mean level in the receiver's band, dB re the source at 1 m, or re 1 µPa with a source level",
        ge=-300.0,
        le=200.0,
        slider=(-150.0, 120.0),
    )


Noise = Annotated[
    Annotated[NoNoise, Tag("none")] | Annotated[AmbientNoise, Tag("ambient")],
    Discriminator(lambda value: kind_of(value, "none")),
]


class NoTvg(Choice):
    """Echoes as loud as they arrive."""

    kind: Literal["none"] = "none"


class PowerTvg(Choice):
    """Time-varied gain by a power of range and by absorption: spreading · log r + 2αr, clipped at the noise floor."""

    kind: Literal["power"] = "power"
    spreading: float = parameter(
        30.0,
        unit="dB",
        description="gain per tenfold slant range: 40 for points, 30 for beds, 20 for volumes",
        ge=0.0,
        le=80.0,
        slider=(0.0, 60.0),
    )
    absorption: float | None = parameter(
        None,
        unit="dB/km",
        description="absorption made good on the way there and back (the water's own when left out)",
        ge=0.0,
        le=1e4,
        slider=(0.0, 400.0),
    )


Tvg = Annotated[
    Annotated[NoTvg, Tag("none")] | Annotated[PowerTvg, Tag("power")],
    Discriminator(lambda value: kind_of(value, "none")),
]


class Receiver(Declaration):
    """What becomes of the echo on its way into the record."""

    speckle: Speckle = parameter(NoSpeckle(), description="interference of scatterers within a cell")
    fluctuation: Fluctuation = parameter(NoFluctuation(), description="how pings differ in loudness")
    reverberation: Reverberation = parameter(NoReverberation(), description="echoes of the water and its surface")
    noise: Noise = parameter(NoNoise(), description="what is heard without any echo")
    source_level: float = parameter(
        0.0,
        unit="dB",
        description="level of the source at 1 m, dB re 1 µPa; at 0 the record is relative to the source",
        ge=0.0,
        le=300.0,
        slider=(0.0, 240.0),
    )
    tvg: Tvg = parameter(NoTvg(), description="time-varied gain")
    crosstalk: float | None = parameter(
        None,
        unit="dB",
        description="level at which each side hears the other's echoes (not at all when left out)",
        ge=-200.0,
        le=0.0,
        slider=(-80.0, 0.0),
    )
