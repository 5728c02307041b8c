"""Absorption formulas, one file a kind."""

from __future__ import annotations

from insonify.scene.base import Choice
from insonify.scene.kinds import Family

ABSORPTIONS = Family("absorptions", "insonify.scene.absorptions")


class AbsorptionKind(Choice):
    """Absorption of sound by the water."""

    family = ABSORPTIONS
