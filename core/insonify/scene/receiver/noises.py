"""Noises: levels in the receiver's band, spectral densities, and a ratio of the bed's echo to the noise."""

import math
from collections.abc import Callable, Iterator
from typing import ClassVar, Literal, NamedTuple

from insonify.scene.base import Family, Kind, decibels, describe_excess, parameter

NOISES = Family("noises", "insonify.scene.receiver")
KNOT = 0.514444  # m/s
WIND_SLOPE = 17.0  # dB per decade by which noise of the sea surface falls above 1 kHz
# Spectrum levels at 15.85 kHz, dB re 1 µPa²/Hz (Sadowski 1984, NUSC Technical Document 7265).
RAIN_FREQUENCY, RAIN = 15848.93, {"none": -math.inf, "intermediate": 58.6, "moderate": 69.4, "heavy": 76.7}


class NoiseConditions(NamedTuple):
    """Conditions on which the level of noise depends besides its own fields."""

    frequency: float  # carrier, Hz
    bandwidth: float  # Hz, of the noise that passes the receiver's filter; the filter's greatest gain is 1
    directivity: float  # dB by which the array receives less of isotropic noise than a point does
    bed_level: Callable[[float], float]  # mean level in dB of the bed's echo at a slant range in metres


class NoiseKind(Kind):
    """Noise received besides the echoes: a Gaussian wave, of exponential intensity where there is no echo.

    Attributes
    ----------
    absolute : bool
        Whether its level is in dB re 1 µPa, independent of the source, so that a source level is needed.
    advice : str
        What a scene that declares it should declare instead; empty for nothing.
    """

    family = NOISES
    absolute: ClassVar[bool] = False
    advice: ClassVar[str] = ""

    def received(self, conditions: NoiseConditions) -> float:
        """Mean level in the record before the time-varied gain, in dB."""
        raise NotImplementedError(f"the noise {self.kind!r} declares no level")


class AmbientNoise(NoiseKind, kind="ambient", rank=10):
    """Noise of a given level in the receiver's band, independent of pulse and beam."""

    advice = (
        "receiver.noise 'ambient' keeps its level whatever the pulse; "
        "'density', 'sea' or 'snr' follow the receiver's band and array"
    )
    level: float = decibels(
        -110.0,
        "mean level in the receiver's band, dB re the source at 1 m, or re 1 µPa with a source level",
        (-300.0, 200.0),
        (-150.0, 120.0),
    )

    def received(self, conditions: NoiseConditions) -> float:
        """Mean level in dB: the declared one."""
        return self.level


class SpectralNoise(NoiseKind):
    """Isotropic noise of a spectral density; a kind declares its `density`."""

    absolute = True

    def density(self, frequency: float) -> float:
        """Spectral density at a frequency (Hz), in dB re 1 µPa²/Hz."""
        raise NotImplementedError(f"the noise {self.kind!r} declares no density")

    def received(self, conditions: NoiseConditions) -> float:
        """Mean level in dB, NL + 10 log B − DI (Urick 1983, 2.1)."""
        return self.density(conditions.frequency) + to_decibels(conditions.bandwidth) - conditions.directivity


class WhiteNoise(SpectralNoise, kind="density", rank=20):
    """Noise of a given spectral density, such as a measured one."""

    level: float = decibels(35.0, "density, dB re 1 µPa²/Hz", (-100.0, 200.0), (0.0, 100.0))

    def density(self, frequency: float) -> float:
        """Spectral density: the declared one."""
        return self.level


class SeaNoise(SpectralNoise, kind="sea", rank=30):
    """Noise of wind, rain and the thermal motion of the water, by frequency (Wenz 1962, Mellen 1952)."""

    wind: float = parameter(
        5.0,
        "wind speed 10 m above the sea; sea states 0 to 6 are 0, 2.5, 4.5, 6.7, 9.4, 12.3, 15.5 m/s",
        "m/s",
        ge=0.0,
        le=40.0,
        slider=(0.0, 20.0),
    )
    rain: Literal["none", "intermediate", "moderate", "heavy"] = parameter(
        "none", "rain on the sea; above 16 kHz it is assumed to fall with frequency as wind noise does"
    )

    def density(self, frequency: float) -> float:
        """Spectral density of the sum of wind, rain and thermal noise."""
        parts = (wind_noise(frequency, self.wind), rain_noise(frequency, self.rain), thermal_noise(frequency))
        return to_decibels(sum(10.0 ** (part / 10.0) for part in parts))

    def describe_limits(self, frequency: float) -> Iterator[str]:
        """Describe a frequency beyond the curves of Wenz, where wind is louder than the water's thermal noise."""
        if wind_noise(frequency, self.wind) > thermal_noise(frequency):
            khz = frequency / 1e3
            yield from describe_excess("frequency", khz, khz, " kHz", (1.0, 100.0), "noise of wind by Wenz")


class SnrNoise(NoiseKind, kind="snr", rank=40):
    """Noise that is weaker by a given ratio than the mean echo of the bed at a range."""

    value: float = decibels(
        15.0, "mean echo of a level bed of the scene's materials over the noise", (-100.0, 200.0), (-10.0, 40.0)
    )
    at: float = parameter(40.0, "slant range of that echo", "m", gt=0.0, le=1e4, slider=(10.0, 200.0), log=True)

    def received(self, conditions: NoiseConditions) -> float:
        """Mean level in dB that gives the ratio."""
        return conditions.bed_level(self.at) - self.value


def wind_noise(frequency: float, wind: float) -> float:
    """Spectral density of the noise of wind (m/s) from 1 kHz up, dB re 1 µPa²/Hz: a fit to the curves of Wenz (1962).

    Within 3.5 dB of the table by sea state of Sadowski (1984, NUSC Technical Document 7265), which ends at 100 kHz.
    """
    return 95.0 + math.sqrt(21.0 * wind / KNOT) - WIND_SLOPE * math.log10(frequency)


def rain_noise(frequency: float, rain: str) -> float:
    """Spectral density of the noise of rain, dB re 1 µPa²/Hz, with the slope of wind noise."""
    return RAIN[rain] - WIND_SLOPE * math.log10(frequency / RAIN_FREQUENCY)


def thermal_noise(frequency: float) -> float:
    """Spectral density of the water's thermal noise, dB re 1 µPa²/Hz: −15 + 20 log f, f in kHz (Mellen 1952)."""
    return -15.0 + 20.0 * math.log10(frequency / 1e3)


def to_decibels(ratio: float) -> float:
    """Decibels of a positive ratio of powers."""
    return 10.0 * math.log10(ratio)
