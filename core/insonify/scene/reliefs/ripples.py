"""Sand ripples."""

from __future__ import annotations

from typing import Literal

from insonify.scene.base import parameter
from insonify.scene.reliefs.random_relief import ExtendableRelief, crest_heading


class Ripples(ExtendableRelief):
    """Crests of one height that wander, fork and end: the phase of a narrow band of waves, shaped."""

    rank = 50
    kind: Literal["ripples"] = "ripples"
    wavelength: float = parameter(
        0.8,
        unit="m",
        description="distance from crest to crest, in the mean",
        gt=0.0,
        le=1e5,
        slider=(0.3, 20.0),
        log=True,
    )
    heading: float = crest_heading(30.0)
    height: float = parameter(
        0.08, unit="m", description="from trough to crest", ge=0.0, le=1e4, slider=(0.005, 2.0), log=True
    )
    bandwidth: float = parameter(
        0.1,
        description="spread of the wave numbers across the crests over their mean; more makes the crests less even",
        gt=0.0,
        le=0.5,
        slider=(0.01, 0.3),
    )
    bandwidth_along: float = parameter(
        0.08,
        description="likewise along the crests; more makes them shorter, with more forks and ends",
        gt=0.0,
        le=0.5,
        slider=(0.01, 0.3),
    )
    sharpness: float = parameter(
        0.6,
        description="0 for crests as round as the troughs, 1 for sharp ones over troughs like bowls",
        ge=0.0,
        le=1.0,
        slider=(0.0, 1.0),
    )
