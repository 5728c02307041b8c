"""A level bed."""

from __future__ import annotations

from typing import Literal

from insonify.scene.seabed.reliefs import ReliefKind


class Flat(ReliefKind):
    """A level bed without relief."""

    rank = 10
    level = True
    kind: Literal["flat"] = "flat"
