"""Speckle models, one file a kind."""

from __future__ import annotations

from insonify.scene.base import Choice
from insonify.scene.kinds import Family

SPECKLES = Family("speckles", "insonify.scene.speckles")


class SpeckleKind(Choice):
    """Interference of scatterers within a cell."""

    family = SPECKLES
