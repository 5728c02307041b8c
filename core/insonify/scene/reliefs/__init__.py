"""Shapes of the bed, one file a kind."""

from __future__ import annotations

from insonify.scene.base import Choice
from insonify.scene.kinds import Family

RELIEFS = Family("reliefs", "insonify.scene.reliefs")


class ReliefKind(Choice):
    """Shape of the bed."""

    family = RELIEFS
