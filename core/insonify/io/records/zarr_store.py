"""Records as Zarr stores (version 3), one shard for a block of pings, written shard by shard."""

import warnings
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

import numpy as np

from insonify.arrays import Dataset
from insonify.io.file_access import check_expansion
from insonify.io.formats import FileFormat
from insonify.io.record_schema import CONVENTIONS, join_blocks
from insonify.io.records.netcdf import NUMBER

ALONG = "ping_time"
CHUNK, SHARD = 64, 1024  # pings that are read together, and pings in one file


def write_zarr(path: str | Path, blocks: Iterable[Dataset]) -> None:
    """Write a record shard by shard, so that memory does not grow with the number of pings."""
    import zarr  # slow to import, and no other format needs it

    with warnings.catch_warnings():
        # All libraries that read version 3 know consolidated metadata and text, which are not in its core.
        warnings.simplefilter("ignore", zarr.errors.UnstableSpecificationWarning)
        warnings.simplefilter("ignore", zarr.errors.ZarrUserWarning)
        for number, part in enumerate(_regrouped(blocks, SHARD)):
            place: dict[str, Any] = {"append_dim": ALONG} if number else {"mode": "w", "encoding": _layout(part)}
            # Text of any length is one type in all libraries, text of a fixed length is not.
            text = {name: each.astype(object) for name, each in part.coords.items() if each.dtype.kind == "U"}
            stored = part.assign_coords(text).assign_attrs(CONVENTIONS)
            stored.to_zarr(path, zarr_format=3, consolidated=False, **place)
        zarr.consolidate_metadata(path, zarr_format=3)


def read_zarr(path: str) -> Dataset:
    """Read a record from a Zarr store, such as `write_zarr` makes."""
    import xarray as xr  # slow to import too
    import zarr

    # Version 2 has a codec that unpickles.
    group = zarr.open_group(path, mode="r", zarr_format=3)
    check_expansion(path, sum(array.size * max(array.dtype.itemsize, NUMBER) for _, array in group.arrays()))
    with xr.open_dataset(path, engine="zarr", zarr_format=3) as record:
        return record.load()


def _layout(part: Dataset) -> dict[str, dict[str, Any]]:
    """Chunks and shards of the variables that grow with the pings."""
    return {
        str(name): {
            "chunks": tuple({ALONG: CHUNK, "channel": 1}.get(str(dim), size) for dim, size in variable.sizes.items()),
            "shards": tuple(SHARD if dim == ALONG else size for dim, size in variable.sizes.items()),
        }
        for name, variable in part.variables.items()
        if ALONG in variable.dims
    }


def _regrouped(blocks: Iterable[Dataset], size: int) -> Iterator[Dataset]:
    """Yield the pings of blocks of any lengths in blocks of a given one; the last may be shorter."""
    pending: list[Dataset] = []
    for block in blocks:
        pending.append(block)
        while sum(each.sizes[ALONG] for each in pending) >= size:
            whole = join_blocks(pending)
            yield whole.isel({ALONG: np.s_[:size]})
            rest = whole.isel({ALONG: np.s_[size:]})
            pending = [rest] if rest.sizes[ALONG] else []
    if pending:
        yield join_blocks(pending)


ZARR = FileFormat(
    "Zarr",
    (".zarr",),
    read_zarr,
    write_zarr,
    folder=True,
    isolated=True,
    remedy="give a record written by insonify",
    labelled=True,
)
