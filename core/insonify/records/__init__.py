"""Records on disk."""

from insonify.records.atomic import replacing
from insonify.records.netcdf import append_to, write_netcdf
from insonify.records.npz import write_npz
from insonify.records.reading import read_record

__all__ = ["append_to", "read_record", "replacing", "write_netcdf", "write_npz"]
