"""Read records, recorded or simulated, whatever they were written as."""

from __future__ import annotations

import zipfile
from pathlib import Path

import numpy as np
import xarray as xr

from insonify.errors import SceneError
from insonify.io.record_schema import ACROSS, CHANNELS
from insonify.io.records.xtf import read_xtf

# What a record is shown by, and over which dimensions.
LAID_OUT = {"intensity": ACROSS, "slant_range": ACROSS[2:]} | {
    f"platform_{name}": ACROSS[1:2] for name in ("x", "y", "altitude")
}
UNTOLD = ("platform_altitude",)  # which may be told of some pings or none


def read_record(path: str | Path) -> xr.Dataset:
    """Read a record by the suffix of its file.

    Parameters
    ----------
    path : str or Path
        ``.xtf``, or ``.nc`` or ``.npz`` as written here.

    Returns
    -------
    Dataset
        Dimensions (channel, ping_time, range_sample), as `simulate` makes it.

    Raises
    ------
    SceneError
        One sentence with what is wrong with the file and the remedy.
    """
    path = Path(path)
    suffix = path.suffix.lower()
    if suffix == ".xtf":
        return read_xtf(path)
    if not path.is_file():
        raise SceneError(f"{path}: there is no such file; give the path of a record")
    try:
        record = _read_npz(path) if suffix == ".npz" else _read_netcdf(path)
    except (OSError, ValueError, KeyError, EOFError, zipfile.BadZipFile) as error:
        reason = " ".join(str(error).split())[:120]
        raise SceneError(f"{path}: cannot be read ({reason}); give a record written by insonify") from None
    fault = _fault(record)
    if fault is not None:
        raise SceneError(f"{path}: is no record ({fault}); give one made by insonify")
    return record


def _fault(record: xr.Dataset) -> str | None:
    """Say what keeps a file from being a record of pings that can be shown."""
    lacking = [name for name in LAID_OUT if name not in record.variables]
    if lacking:
        return f"it lacks {', '.join(lacking)}"
    for name, dimensions in LAID_OUT.items():
        if record[name].dims != dimensions or record[name].dtype.kind not in "fiu":
            return f"{name} is not of numbers over {', '.join(dimensions)}"
        if name not in UNTOLD and not np.isfinite(record[name].values).all():
            return f"{name} holds what is no number"
    sizes = tuple(record.sizes[name] for name in ACROSS)
    if sizes[0] != len(CHANNELS) or 0 in sizes:
        return "it has {} channels, {} pings and {} bins".format(*sizes)
    if record["intensity"].values.min() < 0.0:
        return "intensity is negative somewhere"
    return None if (np.diff(record["slant_range"].values, prepend=0.0) > 0.0).all() else "slant_range does not increase"


def _read_netcdf(path: Path) -> xr.Dataset:
    with xr.open_dataset(path, engine="netcdf4") as record:
        return record.load()


def _read_npz(path: Path) -> xr.Dataset:
    with np.load(path, allow_pickle=False) as stored:
        arrays = {name: stored[name] for name in stored.files}
    attributes = {name.removeprefix("attrs."): arrays.pop(name).item() for name in [*arrays] if name[:6] == "attrs."}
    sizes = dict(zip(ACROSS, arrays["intensity"].shape))
    named = {name: (_dimensions(name, values.shape, sizes), values) for name, values in arrays.items()}
    return xr.Dataset(named, attrs=attributes).set_coords([n for n in ("slant_range", "travel_time") if n in named])


def _dimensions(name: str, shape: tuple[int, ...], sizes: dict[str, int]) -> tuple[str, ...]:
    """Name the dimensions of an array, which an archive does not keep, by what it is called or by their lengths."""
    if name in sizes:
        return (name,)
    if len(shape) == len(ACROSS):
        return ACROSS
    across = ("range_sample",) if name in ("slant_range", "travel_time") else ("ping_time",)
    return across[: len(shape)]
