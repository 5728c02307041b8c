"""Reverberation of water and surface, one file a kind."""

from __future__ import annotations

from insonify.scene.base import Choice
from insonify.scene.kinds import Family

REVERBERATIONS = Family("reverberations", "insonify.scene.reverberations")


class ReverberationKind(Choice):
    """Echoes of the water and its surface."""

    family = REVERBERATIONS
