"""Absorption of sound by sea water."""

import math
from collections.abc import Iterator
from typing import Any, ClassVar

from pydantic import model_validator

from insonify.scene.base import Family, Kind, describe_excess, parameter

ABSORPTIONS = Family("absorptions", "insonify.scene.water")
NEPER_PER_DB = math.log(10.0) / 20.0


class AbsorptionKind(Kind):
    """Absorption of sound by the water.

    Attributes
    ----------
    by_frequency : bool
        Whether it depends on the frequency.
    """

    family = ABSORPTIONS
    by_frequency: ClassVar[bool] = True

    def decibels_per_km(self, frequency: float, depth: float) -> float:
        """Absorption one way, in dB/km, of sound of a frequency in Hz at a depth in metres."""
        return 0.0


class NoAbsorption(AbsorptionKind, kind="none", rank=10):
    """Water without absorption."""

    by_frequency = False


class ConstantAbsorption(AbsorptionKind, kind="constant", rank=20):
    """A given absorption; a bare number of dB/km stands for it."""

    by_frequency = False
    coefficient: float = parameter(30.0, "absorption, one way", "dB/km", ge=0.0, le=1e5, slider=(0.0, 500.0))

    @model_validator(mode="before")
    @classmethod
    def _name_alone(cls, value: Any) -> Any:
        return {"coefficient": value} if isinstance(value, (int, float)) else value

    def decibels_per_km(self, frequency: float, depth: float) -> float:
        """Absorption one way, in dB/km, the same at every frequency and depth."""
        return self.coefficient


class FrancoisGarrison(AbsorptionKind, kind="francois_garrison", rank=30):
    """Absorption of sea water by frequency, after Francois and Garrison (1982)."""

    temperature: float = parameter(10.0, "temperature of the water", "°C", ge=-2.0, le=40.0, slider=(0.0, 30.0))
    salinity: float = parameter(35.0, "salinity of the water", "g/kg", ge=0.0, le=45.0, slider=(0.0, 40.0))
    acidity: float = parameter(8.0, "acidity of the water", "pH", ge=7.0, le=9.0, slider=(7.5, 8.5))

    def decibels_per_km(self, frequency: float, depth: float) -> float:
        """Absorption one way, in dB/km, of sea water of this temperature, salinity and acidity."""
        return francois_garrison(frequency, self.temperature, self.salinity, depth, self.acidity)

    def describe_limits(self, frequency: float) -> Iterator[str]:
        """Describe what lies outside the measurements of Francois and Garrison (1982)."""
        formula, khz, t, s = "absorption by Francois and Garrison", frequency / 1e3, self.temperature, self.salinity
        yield from describe_excess("frequency", khz, khz, " kHz", (0.4, 1000.0), formula)
        yield from describe_excess("temperature", t, t, " °C", (-1.8, 30.0), formula)
        yield from describe_excess("salinity", s, s, "", (30.0, 35.0), formula)


def francois_garrison(
    frequency: float, temperature: float, salinity: float = 35.0, depth: float = 0.0, acidity: float = 8.0
) -> float:
    """Absorption of sea water in dB/km."""
    f, t = frequency / 1e3, temperature
    c = 1412.0 + 3.21 * t + 1.19 * salinity + 0.0167 * depth
    kelvin = t + 273.0
    # Boric acid.
    a1 = 8.86 / c * 10.0 ** (0.78 * acidity - 5.0)
    f1 = 2.8 * math.sqrt(salinity / 35.0) * 10.0 ** (4.0 - 1245.0 / kelvin)
    # Magnesium sulphate.
    a2 = 21.44 * salinity / c * (1.0 + 0.025 * t)
    p2 = 1.0 - 1.37e-4 * depth + 6.2e-9 * depth**2
    f2 = 8.17 * 10.0 ** (8.0 - 1990.0 / kelvin) / (1.0 + 0.0018 * (salinity - 35.0))
    # Pure water.
    if t <= 20.0:
        a3 = 4.937e-4 - 2.59e-5 * t + 9.11e-7 * t**2 - 1.50e-8 * t**3
    else:
        a3 = 3.964e-4 - 1.146e-5 * t + 1.45e-7 * t**2 - 6.5e-10 * t**3
    p3 = 1.0 - 3.83e-5 * depth + 4.9e-10 * depth**2
    boric = a1 * f1 * f**2 / (f**2 + f1**2) if f1 > 0.0 else 0.0
    return boric + a2 * p2 * f2 * f**2 / (f**2 + f2**2) + a3 * p3 * f**2
