"""Jobs: what one does is named by its content; its files appear first, then the flag that says that it is done."""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any, NamedTuple, Protocol

from insonify.errors import SceneError
from insonify.io.atomic import replacing
from insonify.io.unfinished import clear_ended, clear_leftovers, remove, temporary_path

FLAGS = "jobs"  # folder of the flags below that of a survey or a data set
SHELF = 1000  # jobs whose flags share a folder
DIGITS = 7  # of a job's number
DIGEST = 12  # hexadecimal digits


class Work(Protocol):
    """Work that is cut into jobs; it is sent to the workers, and pickled for that."""

    @property
    def folder(self) -> Path:
        """Where all files go."""

    def names(self) -> Sequence[str]:
        """Names of all jobs, from `name_job`, in order."""

    def make(self, name: str, beside: Path) -> Mapping[str, Any]:
        """Do one job: write its files below a folder, where they stand as below `folder`, and tell of them.

        The same name gives the same files on every machine. What is told is kept as JSON, and ``made`` of it comes
        back to the driver.
        """

    def begun(self) -> Work:
        """Return the work with what its jobs share, made once before any of them is done."""

    def warm_up(self) -> None:
        """Compile the kernels that the jobs need."""


class Outcome(NamedTuple):
    """What a worker tells the driver of a job."""

    name: str
    made: int  # images, records


def digest_of(*parts: Any) -> str:
    """Hash what a job depends on, which JSON holds, to a short text."""
    text = json.dumps(parts, sort_keys=True, ensure_ascii=False, default=str)
    return hashlib.sha256(text.encode()).hexdigest()[:DIGEST]


def name_job(number: int, digest: str) -> str:
    """Return the name of a job, which begins with its number."""
    return f"{number:0{DIGITS}d}-{digest}"


def shelf_of(number: int) -> str:
    """Return the folder that a job shares with others of nearby numbers."""
    return f"{number // SHELF:0{DIGITS - 3}d}"


def flag_of(folder: Path, name: str) -> Path:
    """Return the path of the flag that says that a job is done."""
    return folder / FLAGS / shelf_of(int(name.partition("-")[0])) / f"{name}.json"


def done_jobs(folder: Path) -> set[str]:
    """Return the names of all jobs that are done."""
    return {path.stem for path in (folder / FLAGS).glob("*/*.json") if not path.name.startswith(".")}


def read_flag(folder: Path, name: str) -> dict[str, Any]:
    """Read what a job told when it was done."""
    told: dict[str, Any] = json.loads(flag_of(folder, name).read_text(encoding="utf-8"))
    return told


def finish(work: Work, name: str) -> Outcome:
    """Do a job that is not done yet: its files appear one by one, each whole, and its flag after them."""
    flag = flag_of(work.folder, name)
    try:
        if not flag.exists():
            flag.parent.mkdir(parents=True, exist_ok=True)
            clear_leftovers(flag)
            with _staging(flag) as beside:
                told = work.make(name, beside)
                _put_below(beside, work.folder)
            with replacing(flag) as written:
                written.write_text(json.dumps(told, ensure_ascii=False), encoding="utf-8")
        return Outcome(name, int(read_flag(work.folder, name).get("made", 0)))
    except OSError as error:
        raise OSError(error.errno, error.strerror or str(error), str(work.folder)) from None


@contextmanager
def _staging(flag: Path) -> Iterator[Path]:
    """Yield a folder beside a flag for the files of its job, and remove it afterwards."""
    beside = temporary_path(flag)
    beside.mkdir()
    try:
        yield beside
    finally:
        remove(beside)


def _put_below(beside: Path, folder: Path) -> None:
    """Move every file below one folder to its place below another; each replaces one of the same name."""
    for place, _, names in os.walk(beside):
        final = folder / Path(place).relative_to(beside)
        if names:
            final.mkdir(parents=True, exist_ok=True)
        for name in sorted(names):
            os.replace(Path(place) / name, final / name)


def clear_unfinished(folder: Path) -> None:
    """Remove what workers that have ended left of jobs that they did not finish."""
    for shelf in (folder / FLAGS).glob("*/"):
        clear_ended(shelf)


def prepare_folder(folder: Path, names: Iterable[str], what: str) -> list[str]:
    """Make the folder of a work, or take up one that holds a part of it already."""
    wanted = list(names)
    if folder.exists() and not (folder / FLAGS).is_dir() and (not folder.is_dir() or any(folder.iterdir())):
        raise SceneError(f"-o {folder}: holds other files; give a new folder, or one that this command has begun")
    done = done_jobs(folder)
    foreign = sorted(done.difference(wanted))
    if foreign:
        raise SceneError(
            f"-o {folder}: holds {len(foreign)} jobs of another {what}, or of another version of insonify, such as "
            f"{foreign[0]}; give a new folder, or the specification that it was begun with"
        )
    clear_unfinished(folder)
    return [name for name in wanted if name not in done]
