"""Autocorrelations of heights, one file a kind."""

from __future__ import annotations

from insonify.scene.base import Choice
from insonify.scene.kinds import Family

AUTOCORRELATIONS = Family("autocorrelations", "insonify.scene.autocorrelations")


class AutocorrelationKind(Choice):
    """Autocorrelation of heights over the lag."""

    family = AUTOCORRELATIONS
