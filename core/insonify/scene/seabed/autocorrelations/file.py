"""Autocorrelation from a file."""

from __future__ import annotations

from typing import Literal

import numpy as np
from pydantic import ValidationError

from insonify.errors import SceneError
from insonify.files import kept_until_changed
from insonify.io.file_access import guarded, read_text
from insonify.scene.base import FilePath, parameter
from insonify.scene.seabed.autocorrelations.table import LinearAutocorrelation, Points, TabledAutocorrelation


class AutocorrelationFile(LinearAutocorrelation):
    """Autocorrelation interpolated linearly between the points of a file, 0 beyond the last."""

    rank = 40
    kind: Literal["file"] = "file"
    path: FilePath = parameter(description="CSV with a column lag (m) and one autocorrelation, from 0, 1", min_length=1)

    def tabulated(self) -> Points:
        """Read the points of the file."""
        return read_autocorrelation(self.path)


@kept_until_changed(maxsize=4)
def read_autocorrelation(path: str) -> Points:
    """Read the points of an autocorrelation from a CSV file."""
    with guarded(lambda fault, remedy: _refusal(path, fault), ""):
        rows = np.genfromtxt(read_text(path).splitlines(), delimiter=",", comments="#", dtype=np.float64, ndmin=2)
    # genfromtxt reads a line of names as NaN.
    rows = rows[1:] if len(rows) and np.isnan(rows[0]).all() else rows
    if rows.shape[1] != 2 or not np.isfinite(rows).all():
        raise _refusal(path, "is not two columns of numbers")
    try:
        return TabledAutocorrelation(points=tuple((float(lag), float(value)) for lag, value in rows)).points
    except ValidationError:
        raise _refusal(path, "does not begin at 0, 1 and continue to larger lags") from None


def _refusal(path: str, fault: str) -> SceneError:
    return SceneError(f"seabed.relief.function.path: {path!r} {fault}; give a CSV with a lag in m and a value a line")
