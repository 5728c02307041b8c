"""A recorded tow."""

from __future__ import annotations

from typing import Literal

from insonify.scene.base import FilePath, parameter
from insonify.scene.motions import SingleMotion


class Recorded(SingleMotion):
    """As a file has it; what the file leaves out is as without it."""

    rank = 80
    kind: Literal["recorded"] = "recorded"
    path: FilePath = parameter(
        description="CSV with a column time (s) and any of x, y, depth, altitude (m), heading, pitch, roll (°), "
        "or a record (.nc)",
        min_length=1,
    )
