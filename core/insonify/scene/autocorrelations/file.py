"""Autocorrelation from a file."""

from __future__ import annotations

from typing import Literal

import numpy as np
from pydantic import ValidationError

from insonify.errors import SceneError
from insonify.files import kept_until_changed
from insonify.io.file_access import guarded, read_text
from insonify.scene.autocorrelations import AutocorrelationKind
from insonify.scene.autocorrelations.table import Points, TabledAutocorrelation, density_of_points, feature_of_points
from insonify.scene.base import FilePath, parameter
from insonify.scene.reliefs.spectrum import Density


class AutocorrelationFile(AutocorrelationKind):
    """Autocorrelation by straight lines between the points of a file, 0 beyond the last."""

    rank = 40
    kind: Literal["file"] = "file"
    path: FilePath = parameter(description="CSV with a column lag (m) and one autocorrelation, from 0, 1", min_length=1)

    @property
    def feature(self) -> float:
        """Frequency over which the spectrum changes, from how far the autocorrelation reaches."""
        return feature_of_points(read_autocorrelation(self.path))

    def density(self, variance: float) -> Density:
        """Spectral density of straight lines between the points of the file."""
        return density_of_points(read_autocorrelation(self.path), variance)


@kept_until_changed(maxsize=4)
def read_autocorrelation(path: str) -> Points:
    """Read the points of an autocorrelation from a CSV file."""
    with guarded(lambda fault, remedy: _refusal(path, fault), ""):
        rows = np.genfromtxt(read_text(path).splitlines(), delimiter=",", comments="#", dtype=np.float64, ndmin=2)
    # A line of names comes out as NaN.
    rows = rows[1:] if len(rows) and np.isnan(rows[0]).all() else rows
    if rows.shape[1] != 2 or not np.isfinite(rows).all():
        raise _refusal(path, "is not two columns of numbers")
    try:
        return TabledAutocorrelation(points=tuple((float(lag), float(value)) for lag, value in rows)).points
    except ValidationError:
        raise _refusal(path, "does not begin at 0, 1 and go on to larger lags") from None


def _refusal(path: str, fault: str) -> SceneError:
    return SceneError(f"seabed.relief.function.path: {path!r} {fault}; give a CSV with a lag in m and a value a line")
