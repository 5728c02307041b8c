"""A level bed."""

from typing import Literal

from insonify.scene.seabed.reliefs import ReliefKind


class Flat(ReliefKind):
    """A level bed without relief."""

    rank = 10
    level = True
    kind: Literal["flat"] = "flat"
