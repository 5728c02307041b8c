"""Noise of sea and receiver, one file a kind."""

from __future__ import annotations

from insonify.scene.base import Choice
from insonify.scene.kinds import Family

NOISES = Family("noises", "insonify.scene.noises")


class NoiseKind(Choice):
    """What is heard without any echo."""

    family = NOISES
