"""A straight tow."""

from __future__ import annotations

from typing import Literal

from insonify.scene.track.motions import SingleMotion


class Straight(SingleMotion):
    """A level tow at constant speed."""

    rank = 10
    moves = False
    keeps_line = True
    kind: Literal["straight"] = "straight"
