"""Fluctuations of the received level, one file a kind."""

from __future__ import annotations

from insonify.scene.base import Choice
from insonify.scene.kinds import Family

FLUCTUATIONS = Family("fluctuations", "insonify.scene.fluctuations")


class FluctuationKind(Choice):
    """How pings differ in loudness."""

    family = FLUCTUATIONS
