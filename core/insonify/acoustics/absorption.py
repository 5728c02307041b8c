"""Absorption of sound in sea water."""

from __future__ import annotations

import math

from insonify.scene.absorptions import AbsorptionKind
from insonify.scene.absorptions.constant import ConstantAbsorption
from insonify.scene.absorptions.francois_garrison import FrancoisGarrison

NEPER_PER_DB = math.log(10.0) / 20.0


def francois_garrison(
    frequency: float, temperature: float, salinity: float = 35.0, depth: float = 0.0, acidity: float = 8.0
) -> float:
    """Absorption of sea water in dB/km.

    Parameters
    ----------
    frequency : float
        Hz.
    temperature : float
        °C.
    salinity : float
        g/kg.
    depth : float
        Metres.
    acidity : float
        pH.

    Returns
    -------
    float
        dB per kilometre, one way.

    References
    ----------
    Francois & Garrison, J. Acoust. Soc. Am. 72 (1982), part II, the general equation.
    """
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


def absorption_coefficient(absorption: AbsorptionKind, frequency: float, depth: float) -> float:
    """Amplitude absorption of a declared water in Np/m at ``frequency`` (Hz) and ``depth`` (m)."""
    if isinstance(absorption, ConstantAbsorption):
        decibels = absorption.coefficient
    elif isinstance(absorption, FrancoisGarrison):
        water = absorption
        decibels = francois_garrison(frequency, water.temperature, water.salinity, depth, water.acidity)
    else:
        return 0.0
    return decibels * NEPER_PER_DB / 1e3
