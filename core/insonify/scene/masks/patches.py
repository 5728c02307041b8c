"""Patches of relief."""

from __future__ import annotations

from typing import Literal

from insonify.scene.base import parameter
from insonify.scene.masks import MaskKind


class Patchy(MaskKind):
    """Smooth patches, strewn at random, outside which the relief fades out."""

    rank = 20
    kind: Literal["patches"] = "patches"
    share: float = parameter(
        0.5, description="share of the bed that the patches cover", gt=0.0, lt=1.0, slider=(0.05, 0.95)
    )
    size: float = parameter(
        10.0, unit="m", description="typical width of a patch", ge=1e-3, le=1e5, slider=(1.0, 50.0), log=True
    )
    softness: float = parameter(
        0.3,
        description="width over which the relief fades at their borders, as a share of their size",
        gt=0.0,
        le=2.0,
        slider=(0.05, 1.0),
    )
