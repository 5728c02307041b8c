"""Records on disk."""

from insonify.io.atomic import replacing
from insonify.io.records.netcdf import append_to, write_netcdf
from insonify.io.records.npz import write_npz
from insonify.io.records.reading import read_record

__all__ = ["append_to", "read_record", "replacing", "write_netcdf", "write_npz"]
