"""Time-varied gains, one file a kind."""

from __future__ import annotations

from insonify.scene.base import Choice
from insonify.scene.kinds import Family

GAINS = Family("gains", "insonify.scene.gains")


class GainKind(Choice):
    """Time-varied gain."""

    family = GAINS
