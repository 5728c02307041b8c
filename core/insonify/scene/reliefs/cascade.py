"""A multifractal bed."""

from __future__ import annotations

from typing import Literal

from insonify.scene.base import parameter
from insonify.scene.reliefs.random_relief import RandomRelief, rms_height


class Cascade(RandomRelief):
    """A multifractal: lognormal flux, cascading from the period down, integrated fractionally.

    Structure functions scale as ζ(q) = qH − C₁(q² − q) (Schertzer and Lovejoy 1987, α = 2).
    """

    rank = 60
    kind: Literal["cascade"] = "cascade"
    rms: float = rms_height()
    intermittency: float = parameter(
        0.15, description="codimension C₁ of the mean flux; 0 is no multifractal", ge=0.0, le=1.0, slider=(0.0, 0.5)
    )
    hurst: float = parameter(
        0.7, description="order H of the fractional integration", gt=0.0, le=2.0, slider=(0.1, 1.0)
    )
