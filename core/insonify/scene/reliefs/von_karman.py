"""Lineated roughness."""

from __future__ import annotations

from typing import Literal

from insonify.scene.base import parameter
from insonify.scene.reliefs.random_relief import ExtendableRelief, crest_heading, rms_height


class VonKarman(ExtendableRelief):
    """Lineated roughness that levels off at long waves (Goff and Jordan 1988)."""

    rank = 40
    kind: Literal["von_karman"] = "von_karman"
    rms: float = rms_height()
    across: float = parameter(
        5.0,
        unit="m",
        description="wavelength across the crests beyond which the spectrum levels off, 2π/k_n",
        gt=0.0,
        le=1e6,
        slider=(0.5, 100.0),
        log=True,
    )
    along: float = parameter(
        15.0,
        unit="m",
        description="wavelength along the crests beyond which it levels off, 2π/k_s",
        gt=0.0,
        le=1e6,
        slider=(0.5, 100.0),
        log=True,
    )
    heading: float = crest_heading()
    hurst: float = parameter(
        0.8, description="exponent ν; the fractal dimension is 3 − ν", gt=0.0, le=3.0, slider=(0.1, 1.0)
    )
