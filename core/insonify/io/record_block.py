"""Successive pings of a record as plain arrays: the data of a Dataset, without the time that xarray takes to import."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from insonify.arrays import Dataset


class RecordVariable(NamedTuple):
    """A variable of a record."""

    dims: tuple[str, ...]  # names of its dimensions
    values: NDArray[Any]
    attributes: Mapping[str, Any]

    def along(self, *dims: str) -> NDArray[Any]:
        """Return the values with the dimensions in an order."""
        return self.values.transpose([self.dims.index(name) for name in dims])


@dataclass(frozen=True, eq=False)
class RecordBlock:
    """Successive pings of a record."""

    variables: Mapping[str, RecordVariable]  # by name, coordinates too, in the order of a Dataset
    coordinates: tuple[str, ...]  # names of the coordinates among them
    attributes: Mapping[str, Any]  # of the record

    @property
    def sizes(self) -> dict[str, int]:
        """Length of each dimension."""
        each = self.variables.values()
        return {name: size for one in each for name, size in zip(one.dims, one.values.shape)}

    def to_dataset(self) -> Dataset:
        """Return the pings as a Dataset, which shares the arrays."""
        # lazy: xarray takes longer to import than a preview takes to trace
        import xarray as xr

        # lazy: it imports xarray
        from insonify.io import record_plot  # noqa: F401

        # With `fastpath` xarray does not check whether arrays are in memory, for which it imports dask.array where Dask
        # is installed. Times have to be converted.
        variables = {
            name: xr.Variable(*each, fastpath=each.values.dtype.kind not in "Mm")
            for name, each in self.variables.items()
        }
        return xr.Dataset(variables, attrs=self.attributes).set_coords(self.coordinates)


Record: TypeAlias = "RecordBlock | Dataset"


def make_record_block(
    data: Mapping[str, Any], coordinates: Mapping[str, Any], attributes: Mapping[str, Any]
) -> RecordBlock:
    """Make a block from variables as a Dataset takes them."""
    variables = {}
    for name, given in {**data, **coordinates}.items():
        dims, values, text = given if isinstance(given, tuple) else (name, given, {})
        variables[name] = RecordVariable((dims,) if isinstance(dims, str) else tuple(dims), np.asarray(values), text)
    named = [name for name, each in variables.items() if each.dims == (name,)]
    return RecordBlock(variables, tuple(dict.fromkeys([*coordinates, *named])), attributes)


def as_block(record: Record) -> RecordBlock:
    """Return a block or a Dataset as a block, which shares the arrays."""
    if isinstance(record, RecordBlock):
        return record
    variables = {
        str(name): RecordVariable(tuple(map(str, each.dims)), each.values, each.attrs)
        for name, each in record.variables.items()
    }
    return RecordBlock(variables, tuple(map(str, record.coords)), record.attrs)


def as_dataset(record: Record) -> Dataset:
    """Return a block or a Dataset as a Dataset."""
    return record.to_dataset() if isinstance(record, RecordBlock) else record
