"""File formats by suffix: a format is one module of its package, or comes with an installed package."""

import os
from collections.abc import Callable, Iterable
from contextlib import AbstractContextManager
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any, Generic, NamedTuple, TypeVar, cast

from insonify.errors import SceneError
from insonify.io.atomic import replacing
from insonify.io.file_access import check_expansion, check_folder, check_regular, guarded
from insonify.io.isolation import run_isolated
from insonify.plugins import extensions

Content = TypeVar("Content")


class WriteOption(NamedTuple):
    """A choice that a format offers when it is written, which becomes an option of the commands that write."""

    name: str  # keyword of the format's ``write``; the option is ``--name``
    choices: tuple[str, ...]  # the first is the default
    description: str  # one line for help texts


@dataclass(frozen=True)
class FileFormat(Generic[Content]):
    """How files of some suffixes are read and written."""

    description: str  # name of the format, such as "netCDF"
    suffixes: tuple[str, ...]  # in lower case, each with its dot
    # Takes the path of a regular file and returns its content; None if the format is only written. It may raise
    # anything: `FormatRegistry.read` makes one sentence of it.
    read: Callable[..., Content] | None = None
    # Takes a path, an iterable of successive parts and the options; None if the format is only read. It writes a
    # new file, which replaces the old one when it is complete.
    write: Callable[..., None] | None = None
    options: tuple[WriteOption, ...] = ()  # choices of writing
    selects: tuple[str, ...] = ()  # keywords of ``read`` that select a part of the content, such as ``frequency``
    folder: bool = False  # whether a file of the format is a folder
    isolated: bool = False  # whether it is read in a process of its own, because its library may crash
    converter: str = ""  # of a format that is neither read nor written: the program that converts it to one that is
    remedy: str = "export it again"  # what to do with a file that its library cannot read
    # Of a record: whether the labels of its bins and the variables of targets are written too.
    labelled: bool = False
    of_blocks: bool = False  # of a record: whether it is written from `RecordBlock`, without Datasets


class FormatRegistry(Generic[Content]):
    """The formats of one kind of content.

    Every `FileFormat` at the top level of a module of the package belongs to the registry. So do formats, and modules
    that hold formats, which installed packages announce as entry points of the group. Modules are imported when the
    formats are first used; they import what is slow to load within their readers and writers.
    """

    def __init__(self, contents: str, package: str, group: str, error: str = "{path}: {fault}; {remedy}") -> None:
        self.contents, self.package, self.group, self.error = contents, package, group, error
        self._formats: list[FileFormat[Content]] | None = None

    def formats(self) -> list[FileFormat[Content]]:
        """Return all formats; where two share a suffix the first counts."""
        if self._formats is None:
            holders = extensions(self.package, self.group)
            found = [each for holder in holders for each in (holder, *getattr(holder, "__dict__", {}).values())]
            unique = dict.fromkeys(each for each in found if type(each) is FileFormat)
            self._formats = sorted(unique, key=lambda each: not each.labelled)  # first those that keep everything
        return self._formats

    def readable(self) -> tuple[str, ...]:
        """Suffixes of the formats that can be read."""
        return self.suffixes("read")

    def writable(self) -> tuple[str, ...]:
        """Suffixes of the formats that can be written."""
        return self.suffixes("write")

    def suffixes(self, trait: str) -> tuple[str, ...]:
        """Suffixes of the formats that have a trait: ``read``, ``write``, ``folder``, ``labelled`` or ``converter``."""
        return tuple(suffix for each in self.formats() if getattr(each, trait) for suffix in each.suffixes)

    def describe(self, suffixes: Iterable[str]) -> str:
        """List suffixes with the names of their formats, for help texts: ``.nc (netCDF), .npz (NumPy arrays)``."""
        names = {suffix: each.description for each in self.formats() for suffix in each.suffixes}
        return ", ".join(f"{suffix} ({names[suffix]})" for suffix in suffixes)

    def read(self, path: str, alternative: str = "", **selected: Any) -> Content:
        """Read a file by its suffix."""
        found = self.format_of(path, alternative)
        with self.guarded(path, found.remedy):
            check = check_folder if found.folder else check_regular
            check(path, f"give the path of {self.contents}{alternative}")
            check_expansion(path, 0 if found.folder else os.path.getsize(path))  # sparse files
            read = cast("Callable[..., Content]", found.read)
            return run_isolated(read, path) if found.isolated else read(path, **selected)

    def format_of(self, path: str, alternative: str = "") -> FileFormat[Content]:
        """Return the format in which a file is read, by its suffix."""
        suffix = Path(path).suffix.lower()
        found = [each for each in self.formats() if suffix in each.suffixes]
        readable = next((each for each in found if each.read), None)
        foreign = next((each for each in found if each.converter), None)
        if readable is not None:
            return readable
        if foreign is not None:
            fault = f"is in the format {foreign.description}, which is not read here"
            raise self.refusal(path, fault, foreign.converter)
        known = f"give a file that ends in one of {', '.join(self.readable())}{alternative}"
        raise self.refusal(path, "is not a format known here", known)

    def selects(self, path: str) -> tuple[str, ...]:
        """Return the keywords by which a part of a file can be selected when it is read."""
        suffix = Path(path).suffix.lower()
        return tuple(name for each in self.formats() if suffix in each.suffixes for name in each.selects)

    def options(self, suffix: str | None = None) -> tuple[WriteOption, ...]:
        """Return the choices of the formats that can be written: of all, or of the one with a suffix."""
        written = [
            each for each in self.formats() if each.write and (suffix is None or suffix.lower() in each.suffixes)
        ]
        return tuple(option for each in written for option in each.options)

    def write(self, path: Path, parts: Iterable[Content], **options: str) -> None:
        """Write a file by its suffix, which must be one of `writable`; it appears only when it is complete."""
        write = self.writer_of(path).write
        with replacing(path) as beside:
            cast("Callable[..., None]", write)(beside, parts, **options)

    def writer_of(self, path: Path) -> FileFormat[Content]:
        """Return the format in which a file is written; its suffix must be one of `writable`."""
        return next(each for each in self.formats() if each.write and path.suffix.lower() in each.suffixes)

    def guarded(self, path: str | Path, remedy: str = "export it again") -> AbstractContextManager[None]:
        """Turn every error of a block that reads or checks a file into one sentence about that file."""
        return guarded(partial(self.refusal, path), remedy)

    def refusal(self, path: str | Path, fault: str, remedy: str) -> SceneError:
        """Return one sentence with the fault of a file and the remedy."""
        return SceneError(self.error.format(path=path, fault=fault, remedy=remedy))
