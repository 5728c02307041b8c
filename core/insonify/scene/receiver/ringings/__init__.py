"""Ringing of the transducer after transmission, one file a kind."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from insonify.scene.base import Choice
from insonify.scene.kinds import Family

RINGINGS = Family("ringings", "insonify.scene.receiver.ringings")


class RingingKind(Choice):
    """What the receiver takes in of its own transmission."""

    family = RINGINGS

    def decibels(self, time: NDArray[np.float64]) -> NDArray[np.float64] | None:
        """Level in dB re the source at 1 m at times (s) after transmission; None where nothing rings."""
        del time
        return None
