"""Noise of sea and receiver, one file a kind."""

from __future__ import annotations

from insonify.scene.base import Choice
from insonify.scene.kinds import Family

NOISES = Family("noises", "insonify.scene.receiver.noises")


class NoiseKind(Choice):
    """Noise that is received without any echo."""

    family = NOISES

    @property
    def mean_level(self) -> float | None:
        """Mean level in dB of Gaussian noise; None for silence."""
        return None
