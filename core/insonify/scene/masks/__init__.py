"""Masks of a relief, one file a kind: where on the bed it is."""

from __future__ import annotations

from insonify.scene.base import Choice
from insonify.scene.kinds import Family

MASKS = Family("masks", "insonify.scene.masks")


class MaskKind(Choice):
    """Where a relief is, of a bed that is level elsewhere."""

    family = MASKS
