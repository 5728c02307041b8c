"""Records on disk in files of any format, chosen by suffix and checked when read.

A format is one module here that holds a `FileFormat`.
"""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np

from insonify.arrays import Dataset
from insonify.io.file_access import FileFault
from insonify.io.formats import FormatRegistry
from insonify.io.record_block import Record, as_block, as_dataset
from insonify.io.record_schema import ACROSS, CHANNELS

__all__ = ["RECORDS", "read_record", "write_record"]

RECORDS: FormatRegistry[Record] = FormatRegistry("a record", "insonify.io.records", "insonify.record_formats")
# Variables that drawing needs, with their dimensions.
NEEDED = {"intensity": ACROSS, "slant_range": ACROSS[2:]} | {
    f"platform_{name}": ACROSS[1:2] for name in ("x", "y", "altitude")
}
OPTIONAL_VALUES = ("platform_altitude",)  # may be NaN for some pings or all


def read_record(path: str | Path, frequency: float | None = None) -> Dataset:
    """Read a record by the suffix of its file."""
    # lazy: it imports xarray
    from insonify.io import record_plot  # noqa: F401

    selected: dict[str, Any] = {} if frequency is None else {"frequency": frequency}
    with RECORDS.guarded(path, "give a record written by insonify"):
        if selected and "frequency" not in RECORDS.selects(str(path)):
            raise FileFault("has a single frequency", "leave the frequency out")
        record = as_dataset(RECORDS.read(str(path), **selected))
        fault = _fault(record)
        if fault is not None:
            raise FileFault(f"is not a record ({fault})", "give one made by insonify")
    return record


def write_record(path: str | Path, blocks: Iterable[Record], **options: str) -> None:
    """Write a record by the suffix of its file."""
    turned = as_block if RECORDS.writer_of(Path(path)).of_blocks else as_dataset
    RECORDS.write(Path(path), map(turned, blocks), **options)


def _fault(record: Dataset) -> str | None:
    """Return why a dataset cannot be drawn as a record; None if it can."""
    lacking = [name for name in NEEDED if name not in record.variables]
    if lacking:
        return f"it lacks {', '.join(lacking)}"
    for name, dimensions in NEEDED.items():
        if record[name].dims != dimensions or record[name].dtype.kind not in "fiu":
            return f"{name} is not an array of numbers over {', '.join(dimensions)}"
        # Values that are read later have been checked by their format.
        later = record[name].encoding.get("deferred", False)
        if not (name in OPTIONAL_VALUES or later or np.isfinite(record[name].values).all()):
            return f"{name} holds values that are not finite"
    sizes = tuple(record.sizes[name] for name in ACROSS)
    if sizes[0] != len(CHANNELS) or 0 in sizes:
        return "it has {} channels, {} pings and {} bins".format(*sizes)
    if not record["intensity"].encoding.get("deferred") and record["intensity"].values.min() < 0.0:
        return "intensity is negative somewhere"
    return None if (np.diff(record["slant_range"].values, prepend=0.0) > 0.0).all() else "slant_range does not increase"
