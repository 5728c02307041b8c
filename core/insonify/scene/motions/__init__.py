"""Motions of the fish, one file a kind."""

from __future__ import annotations

from insonify.scene.base import Choice
from insonify.scene.kinds import Family

MOTIONS = Family("motions", "insonify.scene.motions")


class MotionKind(Choice):
    """How the fish strays from its line."""

    family = MOTIONS


class SingleMotion(MotionKind):
    """One motion, which may be at work together with others."""
