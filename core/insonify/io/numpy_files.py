"""Arrays in files of NumPy; headers are checked before memory is allocated, and pickles are never read."""

import math
import zipfile
from typing import IO, Any, Self

import numpy as np
from numpy.typing import NDArray

from insonify.io.file_access import FileFault, check_expansion, open_regular

LONGEST_HEADER = 10_000  # characters
HEADERS = {(1, 0): np.lib.format.read_array_header_1_0, (2, 0): np.lib.format.read_array_header_2_0}
SUFFIX = ".npy"  # of the members of an archive
KINDS = "fiucbUSmM"  # of numbers, text and times
PACKED = (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED)


def read_npy(path: str) -> NDArray[Any]:
    """Read an array."""
    with open_regular(path) as file:
        length = file.seek(0, 2)
        file.seek(0)
        _check_header(file, length)
        check_expansion(path, length)
        file.seek(0)
        return np.asarray(np.load(file, allow_pickle=False))


class Archive:
    """Arrays of an ``.npz`` file, each read when it is used."""

    def __init__(self, path: str) -> None:
        self.file = open_regular(path)
        try:
            self._zip = zipfile.ZipFile(self.file)
            members = [member for member in self._zip.infolist() if member.filename.endswith(SUFFIX)]
            self._members = {member.filename.removesuffix(SUFFIX): member for member in members}
            check_expansion(path, sum(member.file_size for member in members))
        except BaseException:
            self.file.close()
            raise

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *error: object) -> None:
        self.file.close()

    @property
    def names(self) -> list[str]:
        """Names of the arrays, in the order of the file."""
        return list(self._members)

    def __getitem__(self, name: str) -> NDArray[Any]:
        member = self._members[name]
        if member.flag_bits & 1 or member.compress_type not in PACKED:
            raise FileFault(f"holds {name[:80]!r} encrypted or packed in an unusual way", "save it with numpy.savez")
        with self._zip.open(member) as file:
            _check_header(file, member.file_size)
        with self._zip.open(member) as file:
            return np.asarray(np.load(file, allow_pickle=False))


def _check_header(file: IO[bytes], length: int) -> None:
    """Raise FileFault for an array of objects or records, or of a size that does not match the file."""
    remedy = "save it with numpy.save or numpy.savez as plain numbers"
    version = np.lib.format.read_magic(file)
    if version not in HEADERS:
        raise FileFault(f"cannot be read (it is of version {version[0]}.{version[1]}, not a plain array)", remedy)
    try:
        shape, _, kind = HEADERS[version](file, max_header_size=LONGEST_HEADER)
    except Exception:  # a header is Python text; its parser raises errors of many types
        raise FileFault("cannot be read (its header is damaged)", remedy) from None
    if kind.kind not in KINDS:
        raise FileFault(f"cannot be read (it holds {str(kind)[:80]} values)", remedy)
    announced = math.prod(shape) * kind.itemsize
    if min(shape, default=0) < 0 or announced != length - file.tell():
        fault = f"it announces {str(shape)[:80]} values and holds {length - file.tell()} bytes"
        raise FileFault(f"cannot be read ({fault})", remedy)
