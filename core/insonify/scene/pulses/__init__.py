"""Transmitted pulses, one file a kind."""

from __future__ import annotations

from insonify.scene.base import Choice
from insonify.scene.kinds import Family

PULSES = Family("pulses", "insonify.scene.pulses")


class PulseKind(Choice):
    """A transmitted pulse."""

    family = PULSES
