"""Autocorrelation from a file."""

from __future__ import annotations

from typing import Literal

from insonify.scene.autocorrelations import AutocorrelationKind
from insonify.scene.base import FilePath, parameter


class AutocorrelationFile(AutocorrelationKind):
    """Straight lines between the points of a file, 0 beyond the last."""

    rank = 40
    kind: Literal["file"] = "file"
    path: FilePath = parameter(description="CSV with a column lag (m) and one autocorrelation, from 0, 1", min_length=1)
