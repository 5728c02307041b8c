"""Records on disk: a format is one module here that holds a `FileFormat`."""

from insonify.io.records.files import RECORDS, read_record, write_record

__all__ = ["RECORDS", "read_record", "write_record"]
