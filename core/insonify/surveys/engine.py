"""Jobs of a survey or a data set: each is done once, by any worker of a scheduler, and leaves whole files.

A job is named by the content of what it depends on. Its files appear first, then the flag that marks it as done.
"""

import hashlib
import json
import math
import os
import sys
import time
from asyncio import CancelledError
from collections import Counter, deque
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from queue import Empty, SimpleQueue
from tempfile import TemporaryDirectory
from typing import Any, NamedTuple, Protocol, Self

from insonify.errors import SceneError
from insonify.io.atomic import clear_ended, terminated_cleanly, unfinished_folder
from insonify.io.object_store import in_store
from insonify.progress import open_progress
from insonify.surveys.schedulers import Workers, connected

SHELVED = "[0-9]*/*.json"  # within the folder of flags; what is being written beside them may vanish
FLAGS = "jobs"  # folder of the flags below that of a survey or a data set
SHELF = 1000  # jobs whose flags share a folder
DIGITS = 7  # of a job's number
DIGEST = 12  # hexadecimal digits
AHEAD = 3  # jobs in flight for each thread of a worker, which hides the latency of the driver
PATIENCE = 60.0  # s, until there is a worker
RECOUNT = 5.0  # s, after which the workers are counted again
CLOSING = 30.0  # s for the workers to end
INTERRUPTED = 130
MOST_TRIES = 4
ENDED = "its worker process ended four times in a row, possibly out of memory; use fewer workers"


class Work(Protocol):
    """Work that is divided into jobs; it is pickled and sent to the workers."""

    @property
    def folder(self) -> Path:
        """Folder of all files."""

    def names(self) -> Sequence[str]:
        """Names of all jobs, from `name_job`, in order."""

    def make(self, name: str, beside: Path) -> Mapping[str, Any]:
        """Do one job: write its files below a folder as they stand below `folder`, and return its report.

        The same name gives the same files on every machine with the same build. The report is kept as JSON; Its
        ``made`` counts what was made, and is sent back to the driver.
        """

    def begun(self) -> Self:
        """Return the work with what its jobs share, made once before any of them is done."""

    def warm_up(self) -> None:
        """Compile the kernels that the jobs need."""


class Outcome(NamedTuple):
    """Job that has ended."""

    name: str
    made: int = 0  # images or records
    failure: str = ""  # reason why it could not be done


def digest_of(*parts: Any) -> str:
    """Hash what a job depends on, as JSON, to a short text."""
    text = json.dumps(parts, sort_keys=True, ensure_ascii=False, default=str)
    return hashlib.sha256(text.encode()).hexdigest()[:DIGEST]


def name_job(number: int, digest: str) -> str:
    """Return the name of a job, which begins with its number."""
    return f"{number:0{DIGITS}d}-{digest}"


def job_number(name: str) -> int:
    """Return the number of a job by its name."""
    return int(name.partition("-")[0])


def shelf_of(number: int) -> str:
    """Return the folder that a job shares with others of nearby numbers."""
    return f"{number // SHELF:0{DIGITS - 3}d}"


def flag_of(folder: Path, name: str) -> Path:
    """Return the path of the flag that marks a job as done; it contains the report of the job."""
    return folder / FLAGS / shelf_of(job_number(name)) / f"{name}.json"


def done_jobs(folder: Path) -> set[str]:
    """Return the names of all jobs that are done."""
    return {path.stem for path in (folder / FLAGS).glob(SHELVED) if not path.name.startswith(".")}


def read_flag(folder: Path, name: str) -> dict[str, Any]:
    """Read the report of a job that is done."""
    report: dict[str, Any] = json.loads(flag_of(folder, name).read_text(encoding="utf-8"))
    return report


def finish(work: Work, name: str) -> Outcome:
    """Do a job that is not done yet: its files appear one by one, each whole, and its flag after them."""
    flag = flag_of(work.folder, name)
    try:
        if not flag.exists():
            if not in_store(flag):
                flag.parent.mkdir(parents=True, exist_ok=True)
            with TemporaryDirectory() if in_store(flag) else unfinished_folder(flag) as folder:
                beside, written = Path(folder, "files"), Path(folder, flag.name)
                beside.mkdir()
                report = work.make(name, beside)
                for place, _, files in os.walk(beside):
                    for file in sorted(files):
                        made = Path(place, file)
                        _put(made, work.folder / made.relative_to(beside).as_posix())
                written.write_text(json.dumps(report, ensure_ascii=False), encoding="utf-8", newline="")
                _put(written, flag)
        return Outcome(name, int(read_flag(work.folder, name).get("made", 0)))
    except OSError as error:
        raise OSError(error.errno, error.strerror or str(error), str(work.folder)) from None


def _put(file: Path, final: Path) -> None:
    """Move a file to its place, where it replaces one of the same name."""
    if in_store(final):
        final.write_bytes(file.read_bytes())
    else:
        final.parent.mkdir(parents=True, exist_ok=True)
        file.replace(final)


def prepare_folder(folder: Path, names: Sequence[str], what: str) -> list[str]:
    """Make the folder of a work, or resume one that contains a part of it; return the jobs that are missing."""
    if folder.exists() and not (folder / FLAGS).is_dir() and (not folder.is_dir() or any(folder.iterdir())):
        raise SceneError(f"-o {folder}: contains other files; give a new folder, or that of an earlier run")
    done = done_jobs(folder)
    foreign = sorted(done.difference(names))
    if foreign:
        raise SceneError(
            f"-o {folder}: contains {len(foreign)} jobs of another {what}, or of another version of insonify, such as "
            f"{foreign[0]}; give a new folder, or the specification of the earlier run"
        )
    _clear_unfinished(folder)
    return [name for name in names if name not in done]


def _clear_unfinished(folder: Path) -> None:
    """Remove what ended workers left of unfinished jobs."""
    if not in_store(folder):
        for shelf in (folder / FLAGS).glob("*/"):
            clear_ended(shelf)


def run_jobs(
    work: Work, names: Sequence[str], scheduler: str, progress: Callable[[Outcome], object]
) -> tuple[Outcome, ...]:
    """Do jobs on a scheduler's workers; return those that could not be done."""
    # If a worker ends, another one does its job, up to three times. A job that cannot be done stops no other; a file
    # that cannot be written stops them all.
    failures = []
    try:
        with terminated_cleanly(CLOSING), connected(scheduler) as client, _watched(client, scheduler):
            workers = Workers(client, work.folder / FLAGS, scheduler)
            begun = _begin(client, workers, work, scheduler)
            for outcome in _outcomes(client, workers, begun, names):
                progress(outcome)
                if outcome.failure:
                    failures.append(outcome)
    finally:
        _clear_unfinished(work.folder)
    return tuple(failures)


@contextmanager
def _watched(client: Any, scheduler: str) -> Iterator[None]:
    """Say it in one sentence if the scheduler ends, which cancels all that it was to do."""
    try:
        yield
    except (Exception, CancelledError):
        if client.status == "running":
            raise
        raise SceneError(
            f"--scheduler {scheduler}: the scheduler has ended or cannot be reached; finished jobs are kept: "
            "start a scheduler with workers and repeat the command to resume"
        ) from None


def _begin(client: Any, workers: Workers, work: Work, scheduler: str) -> Work:
    """Let a worker make what jobs share, and one of each machine compile the kernels, which the others then read."""
    try:
        client.wait_for_workers(1, timeout=PATIENCE)
    except TimeoutError:
        raise SceneError(
            f"--scheduler {scheduler}: no worker connected within {PATIENCE:g} s; start workers with 'dask worker'"
        ) from None
    workers.count()
    if not workers.threads:
        raise SceneError(f"--scheduler {scheduler}: no worker may do these jobs; give another folder, or other workers")
    machines = {address.rpartition(":")[0]: address for address in workers.threads}
    begun: Work = _result(client.submit(work.begun, workers=list(machines.values())[:1], pure=False))
    warm = [client.submit(begun.warm_up, workers=[one], pure=False) for one in machines.values()]
    client.gather(warm, errors="skip")  # a scene that cannot be made is reported by its job
    return begun


class _Flight(NamedTuple):
    """Job that has been given to workers."""

    name: str
    future: Any
    workers: frozenset[str]


def _outcomes(client: Any, workers: Workers, work: Work, names: Iterable[str]) -> Iterator[Outcome]:
    """Outcomes of jobs as they end; as many are in flight as keep the workers busy."""
    ended: SimpleQueue[Any] = SimpleQueue()
    flying: dict[str, _Flight] = {}
    tries: Counter[str] = Counter()
    waiting, counted = deque(names), -math.inf
    while waiting or flying:
        if time.monotonic() - counted > RECOUNT:
            counted = time.monotonic()
            workers.count()
            for flight in [one for one in flying.values() if not one.workers & workers.threads.keys()]:
                del flying[flight.future.key]
                flight.future.cancel()
                waiting.appendleft(flight.name)
        while waiting and len(flying) < AHEAD * sum(workers.threads.values()):
            name = waiting.popleft()
            tries[name] += 1
            if tries[name] > MOST_TRIES:
                yield Outcome(name, failure=ENDED)
                continue
            future = client.submit(finish, work, name, workers=list(workers.threads), pure=False)
            flying[future.key] = _Flight(name, future, frozenset(workers.threads))
            future.add_done_callback(ended.put)
        with suppress(Empty):
            future = ended.get(timeout=RECOUNT)
            if future.key not in flying:  # given to other workers meanwhile
                continue
            name = flying.pop(future.key).name
            if outcome := _outcome(future, name):
                del tries[name]
                yield outcome
            else:  # it ended, but so did its worker before the outcome was fetched
                waiting.appendleft(name)


def _result(future: Any, patience: float | None = None) -> Any:
    """Return the result of a worker; raise what stops all jobs, and TimeoutError where the result is lost."""
    error = future.exception(patience)
    if isinstance(error, ImportError) or "deserializ" in str(error):
        raise SceneError(
            f"--scheduler: a worker cannot read its jobs ({type(error).__name__}); install the same versions of "
            "insonify, Python and dask there as here"
        )
    if error is not None:
        raise error
    return future.result(patience)


def _outcome(future: Any, name: str) -> Outcome | None:
    """Outcome of a job that has ended, None if it is lost; raises what stops all jobs."""
    try:
        outcome: Outcome = _result(future, RECOUNT)
    except SceneError as error:
        if error is not future.exception():
            raise
        return Outcome(name, failure=str(error))
    except TimeoutError:
        if future.status == "error":
            raise
        return None
    except Exception as error:
        if type(error).__name__ != "KilledWorker":
            raise
        return Outcome(name, failure=ENDED)
    return outcome


class Ended(NamedTuple):
    """Work whose jobs have all been tried."""

    done: list[str]  # jobs that are done, in order
    failures: tuple[Outcome, ...]  # those that could not be done

    def refuse_failures(self) -> None:
        """Raise an error of one sentence if some jobs could not be done."""
        if self.failures:
            first, total = min(self.failures), len(self.done) + len(self.failures)
            raise SceneError(
                f"{len(self.failures)} of {total} jobs failed, the others are finished; "
                f"job {job_number(first.name)}: {first.failure}"
            )


def work_on(work: Work, what: str, scheduler: str, unit: str = "job") -> Ended:
    """Do the jobs of a work that are not done yet, and show their progress; an interruption ends the program."""
    names = list(work.names())
    missing = prepare_folder(work.folder, names, what)
    if not missing:
        return Ended(names, ())
    done = len(names) - len(missing)
    progress = open_progress("", len(names), unit, done=done)

    def advance(outcome: Outcome) -> None:
        nonlocal done
        done += not outcome.failure
        progress.advance(1)

    try:
        failures = run_jobs(work, missing, scheduler, advance)
    except (KeyboardInterrupt, SystemExit) as leaving:
        progress.close()
        sentence = f"interrupted; {done} of {len(names)} {unit}s are finished and kept; repeat the command to resume"
        sys.stderr.write(f"insonify: {sentence}\n")
        if isinstance(leaving, SystemExit):
            raise
        raise SystemExit(INTERRUPTED) from None
    finally:
        progress.close()
    failed = {failure.name for failure in failures}
    return Ended([name for name in names if name not in failed], failures)
