"""Access to files of unknown origin: regular files only, bounded sizes, errors of libraries in one sentence."""

import codecs
import difflib
import errno
import glob
import logging
import os
import re
import stat
import threading
import tomllib
import warnings
from collections.abc import Callable, Collection, Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, BinaryIO, cast

from insonify.errors import FileWarning, SceneError, warn_caller
from insonify.operating_system import call_after_fork

LEAST_EXPANSION = 2**28  # bytes that any file may expand to
EXPANSION = 64  # and its own bytes times this, which is more than measurements are compressed
LARGEST_TEXT = 2**28  # bytes of a text file
MISSING = "does not exist"
LARGEST_TOML = 2**22  # bytes of a TOML file: 20,000 targets
MOST_PARTS, LONGEST_KEY = 100, 1000  # parts of a dotted key, for which a parser takes quadratic time; characters of one
MOST_BITS = 1000  # of a whole number; a float takes no more
# Text up to a key of more parts: strings over several lines, comments, keys and values, and what is between them.
_PART, _DOT = r"""(?:[\w-]++|"(?:[^"\\\n]|\\.)*+"?+|'[^'\n]*+'?+)""", r"[ \t]*+\.[ \t]*+"
_SHORT_KEYS = re.compile(
    rf'''(?:"""(?:[^"\\]|\\[\s\S]|"{{1,2}}+(?!"))*+"*+|\'{{3}}(?:[^']|'{{1,2}}+(?!'))*+'*+|\#[^\n]*+'''
    rf"|{_PART}(?:{_DOT}{_PART}){{0,{MOST_PARTS - 1}}}+(?!{_DOT}{_PART})|[^\w\"'#-]++)*+"
)
_lock = threading.RLock()
# A logger without a handler writes to standard error.
for _library in ("trimesh", "rasterio", "PIL", "fiona", "matplotlib"):
    logging.getLogger(_library).addHandler(logging.NullHandler())


class FileFault(Exception):
    """Fault of a file with its remedy; `guarded` turns both into one sentence."""

    def __init__(self, fault: str, remedy: str) -> None:
        super().__init__(fault, remedy)
        self.fault, self.remedy = fault, remedy

    def __str__(self) -> str:
        return f"{self.fault}; {self.remedy}"


_TOO_DEEP = FileFault("is nested too deeply", "write fewer tables in tables")
_TOO_LARGE = FileFault("has a whole number of hundreds of digits", "write a smaller one")


@contextmanager
def guarded(refusal: Callable[[str, str], SceneError], remedy: str) -> Iterator[None]:
    """Turn every error of a block that reads a file into one sentence, and keep warnings off the terminal."""
    caught: list[warnings.WarningMessage] = []
    try:
        with one_at_a_time(), warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("ignore")
            warnings.simplefilter("always", FileWarning)
            yield
    except SceneError:
        raise
    except FileFault as error:
        raise refusal(error.fault, error.remedy) from None
    except Exception as error:  # libraries raise errors of many types
        raise refusal(f"cannot be read ({reason(error)})", remedy) from error
    for warning in caught:  # those of libraries are left out
        warn_caller(cast("Warning", warning.message))


def warn_of_file(path: str, remarks: Iterable[str]) -> None:
    """Warn of what is doubtful in a file that is used, in one line."""
    if sentence := "; ".join(remarks):
        warn_caller(FileWarning(f"{path}: {sentence}"))


def read_named(what: str, name: str, path: Path, *, form: str, bundled: Collection[str], largest: int) -> str:
    """Read the text of a file that is given by its path or by the name of a bundled one."""

    def refuse(fault: str, remedy: str) -> SceneError:
        if fault == MISSING:
            close = difflib.get_close_matches(name, bundled, n=1)
            guess = f"did you mean {close[0]!r}? Otherwise " if close else ""
            fault, remedy = "no such file", f"{guess}give a {form} file or one of {', '.join(bundled)}"
        return SceneError(f"{what} {name!r}: {fault}; {remedy}")

    with guarded(refuse, f"give a readable {form} file"):
        return read_text(path, largest=largest)


@contextmanager
def disk_errors() -> Iterator[None]:
    """Raise an OSError where netCDF raises a RuntimeError because the disk is full or gone."""
    try:
        yield
    except RuntimeError as error:
        raise OSError(errno.EIO, f"could not be written ({error})") from error


def one_at_a_time() -> threading.RLock:
    """Return the lock for HDF5 and for the filter of warnings, neither of which allows two threads at once."""
    return _lock


def reason(error: Exception) -> str:
    """Return the beginning of an error's message on one line, or the error's name where it has none."""
    if isinstance(error, MemoryError):
        return "it does not fit in memory"
    if isinstance(error, UnicodeDecodeError):
        return f"it is not text in {error.encoding.upper()}"
    text = error.strerror if isinstance(error, OSError) and error.strerror else str(error)
    return " ".join(text.split())[:120] or type(error).__name__


def check_regular(path: str | Path, remedy: str = "give the path of a file") -> None:
    """Raise FileFault for folders, devices, pipes and missing files, without opening them."""
    try:
        _check_mode(os.stat(path).st_mode, remedy)
    except (FileNotFoundError, NotADirectoryError):
        raise FileFault(MISSING, remedy) from None


def check_folder(path: str | Path, remedy: str = "give the path of a folder") -> None:
    """Raise FileFault unless a path is a folder of folders and regular files alone."""
    if not os.path.isdir(path):
        raise FileFault(MISSING, remedy)
    for place, folders, files in os.walk(path):
        for name in (*folders, *files):
            mode = os.lstat(os.path.join(place, name)).st_mode
            if not (stat.S_ISDIR(mode) or stat.S_ISREG(mode)):
                raise FileFault(f"contains {name[:80]!r}, which is not a regular file", "remove that")


def open_regular(path: str | Path) -> BinaryIO:
    """Open a regular file for reading; never waits, as the opening of a pipe does."""
    check_regular(path)
    return open(path, "rb", opener=_open_at_once)


def read_text(path: str | Path, encoding: str = "utf-8-sig", largest: int = LARGEST_TEXT) -> str:
    """Read a text file of limited size, with line ends of any system."""
    with open_regular(path) as file:
        content = file.read(largest + 1)
    if len(content) > largest:
        raise FileFault(f"is a text of more than {largest // 10**6} MB", "thin it")
    if content[:2] in (codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE):  # as some programs on Windows export tables
        encoding = "utf-16"
    return content.removeprefix(codecs.BOM_UTF8).decode(encoding).replace("\r\n", "\n").replace("\r", "\n")


def parse_toml(text: str) -> dict[str, Any]:
    """Parse TOML text; raises FileFault for what is not valid, and for what would take too long or cannot be shown."""
    if len(text) > LARGEST_TOML:
        raise FileFault(f"is a text of more than {LARGEST_TOML // 2**20} MB", "thin it")
    if (short := _SHORT_KEYS.match(text)) and short.end() < len(text):
        raise FileFault(f"has a key of more than {MOST_PARTS} parts", "write fewer tables in tables")
    try:
        values = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise FileFault(f"is not valid TOML ({error})", "correct that line") from None
    except RecursionError:
        raise _TOO_DEEP from None
    except ValueError:  # `int` takes no more than some thousand digits
        raise _TOO_LARGE from None
    pending: list[tuple[Any, int]] = [(values, 0)]
    while pending:
        value, depth = pending.pop()
        if isinstance(value, (dict, list)) and depth > MOST_PARTS:
            raise _TOO_DEEP
        if isinstance(value, dict):
            if longest := next((key for key in value if len(key) > LONGEST_KEY), ""):
                raise FileFault(f"has a key of {len(longest)} characters, '{longest[:20]}…'", "shorten it")
            pending += [(child, depth + 1) for child in value.values()]
        elif isinstance(value, list):
            pending += [(child, depth + 1) for child in value]
        elif isinstance(value, int) and value.bit_length() > MOST_BITS:
            raise _TOO_LARGE
    return values


def largest_expansion(path: str | Path) -> int:
    """Bytes that the content of a file may take in memory; a sparse file counts by what is stored of it."""
    return max(LEAST_EXPANSION, EXPANSION * stored_bytes(path))


def stored_bytes(path: str | Path) -> int:
    """Bytes that a file, or all files of a folder, take on the disk, at most their lengths."""
    if os.path.isdir(path):
        return sum(stored_bytes(os.path.join(place, name)) for place, _, files in os.walk(path) for name in files)
    status = os.stat(path)
    return min(status.st_size, 512 * getattr(status, "st_blocks", status.st_size))


def check_expansion(path: str | Path, expanded: int) -> None:
    """Raise FileFault, before memory is allocated, for a file that declares far more data than it stores."""
    if expanded > largest_expansion(path):
        raise FileFault(
            f"announces {expanded / 1e9:.3g} GB, {EXPANSION} times more than it stores",
            "save it without compression, or crop it",
        )


def check_companions(path: str | Path) -> None:
    """Raise FileFault if a device or a pipe beside a file has the same stem: a library would open it."""
    file = Path(path)
    for other in file.parent.glob(f"{glob.escape(file.stem)}.*"):
        if not (other.is_file() or other.is_dir() or not other.exists()):
            raise FileFault(f"has {other.name!r} beside it, which is not a regular file", "remove that")


def companion(path: str | Path, name: str) -> Path:
    """Return the path of a file that another file refers to, which must lie beside it or in a folder there."""
    folder = Path(path).resolve().parent
    found = (folder / name).resolve() if "\0" not in name else folder
    if not found.is_relative_to(folder) or Path(name).is_absolute() or found == folder:
        raise FileFault(f"refers to {name[:80]!r}", "keep what it refers to beside it, under a relative path")
    return found


def _open_at_once(path: str, flags: int) -> int:
    """Open a path that may have come to name a pipe since it was checked."""
    descriptor = os.open(path, flags | getattr(os, "O_NONBLOCK", 0))
    try:
        _check_mode(os.fstat(descriptor).st_mode, "give the path of a file")
    except BaseException:
        os.close(descriptor)
        raise
    return descriptor


def _check_mode(mode: int, remedy: str) -> None:
    if stat.S_ISDIR(mode):
        raise FileFault(f"cannot be read ({os.strerror(errno.EISDIR)})", remedy)
    if not stat.S_ISREG(mode):
        raise FileFault("is a device or a pipe, not a file", remedy)


def _renew_lock() -> None:
    global _lock
    _lock = threading.RLock()


call_after_fork(_renew_lock)  # the thread with the lock does not exist in the new process
