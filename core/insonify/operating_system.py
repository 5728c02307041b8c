"""What operating systems do differently: names and locks of files; processes, their time and end; interrupts.

Other modules are the same on every system, apart from `cores`, `compiler.cache_folder` and the check for a
display in the viewer. A system that lacks something goes without it, as each function says.
"""

import contextlib
import os
import re
import signal
import subprocess
import sys
import threading
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, BinaryIO, cast

if sys.platform == "win32":
    import msvcrt
else:
    import fcntl

# What Windows takes for a device, whatever follows its first dot, and characters and ends that it allows in no name.
DEVICES = {"CON", "PRN", "AUX", "NUL", *(f"{port}{number}" for port in ("COM", "LPT") for number in range(1, 10))}
FORBIDDEN = re.compile(r'[<>:"|?*/\\\x00-\x1f]|[. ]$')
LONGEST_PATH = 259  # characters, on Windows where longer ones have not been enabled
LOCKED_BYTE = 2**30  # byte that is locked where locks concern bytes, which could otherwise not be read
LOWER = 5  # steps of niceness, each some 20 % of a processor's share


def is_portable(name: str) -> bool:
    """Whether a file or folder may have a name on every system."""
    return bool(name) and not FORBIDDEN.search(name) and name.partition(".")[0].upper() not in DEVICES


def fault_of_path(path: Path) -> str:
    """Return why this system makes no file of a path; empty if it does."""
    if sys.platform != "win32":
        return ""
    if not is_portable(path.name):
        return f"{path.name!r} is not a name of a file on Windows"
    length = len(os.path.abspath(path))
    return f"its whole path has {length} characters, too many for Windows" if length > LONGEST_PATH else ""


def lock_file(file: BinaryIO, exclusive: bool = True) -> bool | None:
    """Lock a file until it is closed: whether it is locked now, or None where the disk has no locks."""
    try:
        if sys.platform == "win32":
            file.seek(LOCKED_BYTE)
            msvcrt.locking(file.fileno(), msvcrt.LK_NBLCK, 1)
            file.seek(0)
        else:
            fcntl.flock(file, (fcntl.LOCK_EX if exclusive else fcntl.LOCK_SH) | fcntl.LOCK_NB)
    except (BlockingIOError, PermissionError):
        return False
    except OSError:
        return None
    return True


def processor_time(process: int) -> tuple[float, bool]:
    """Processor time of a process in seconds, and whether it runs or waits for a processor; Linux alone tells."""
    if sys.platform == "linux":
        with contextlib.suppress(OSError):
            stat = Path(f"/proc/{process}/stat").read_text(encoding="ascii", errors="replace")
            state, *fields = stat.rpartition(")")[2].split()
            return (int(fields[10]) + int(fields[11])) / os.sysconf("SC_CLK_TCK"), state == "R"
    return 0.0, False


@contextlib.contextmanager
def ended_after(seconds: float) -> Iterator[None]:
    """Let the system end this process if a block takes longer, also in a loop that is not in Python; not on Windows."""
    if sys.platform == "win32":
        yield
        return
    signal.signal(signal.SIGALRM, signal.SIG_DFL)
    signal.setitimer(signal.ITIMER_REAL, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)


@contextlib.contextmanager
def limited_memory(bytes_more: int) -> Iterator[None]:
    """Let allocations in a block fail beyond a number of bytes more than the process has now; on Linux alone."""
    present = _private_bytes()
    if sys.platform != "linux" or present is None:
        yield
        return
    # lazy: not on every system
    import resource

    soft, hard = resource.getrlimit(resource.RLIMIT_DATA)
    most = present + bytes_more
    resource.setrlimit(resource.RLIMIT_DATA, (most if hard == resource.RLIM_INFINITY else min(most, hard), hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_DATA, (soft, hard))


def _private_bytes() -> int | None:
    """Bytes of this process that count towards RLIMIT_DATA; None where the system does not tell."""
    try:
        status = Path("/proc/self/status").read_text(encoding="ascii", errors="replace")
    except OSError:
        return None
    return int(status.partition("VmData:")[2].split()[0]) * 1024


@contextlib.contextmanager
def interrupts_blocked() -> Iterator[None]:
    """Block interrupts within; threads and processes that are started within never receive any. Not on Windows."""
    # A terminal sends Ctrl-C to the driver and to the workers; the driver ends the workers.
    if sys.platform == "win32":
        yield
        return
    # lazy: only workers of surveys and data sets need it
    from multiprocessing import resource_tracker

    # It unblocks interrupts when it starts, otherwise together with the first process.
    resource_tracker.ensure_running()
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def call_after_fork(renew: Callable[[], object]) -> None:
    """Call a function in every process that a fork makes of this one, where threads and locks are left behind."""
    if sys.platform != "win32":
        os.register_at_fork(after_in_child=renew)


def interrupt_main_thread(number: int) -> None:
    """Send a signal so that the main thread wakes where it waits, where the system can."""
    if sys.platform == "win32":
        signal.raise_signal(number)
    else:
        signal.pthread_kill(cast("int", threading.main_thread().ident), number)


def lower_priority(process: int = 0) -> None:
    """Lower the priority of the calling thread, or of a process that just started, and of the threads that it starts.

    Only Linux has priorities of single threads by niceness.
    """
    if sys.platform == "linux":
        os.setpriority(os.PRIO_PROCESS, process, os.getpriority(os.PRIO_PROCESS, process) + LOWER)


def apart() -> dict[str, Any]:
    """Options of `subprocess.Popen` for a process that `end_apart` can end together with those that it starts."""
    if sys.platform == "win32":
        return {"creationflags": subprocess.CREATE_NEW_PROCESS_GROUP | subprocess.BELOW_NORMAL_PRIORITY_CLASS}
    return {"start_new_session": True}


def end_apart(process: subprocess.Popen[Any], at_once: bool = False) -> None:
    """Ask a process that was started `apart` to end, with those that it started, or end it at once."""
    if process.poll() is not None:
        return
    if sys.platform != "win32":
        with contextlib.suppress(ProcessLookupError):  # it ended just now
            os.killpg(process.pid, signal.SIGKILL if at_once else signal.SIGTERM)
        return
    try:
        if at_once:
            process.kill()
        else:
            process.send_signal(signal.CTRL_BREAK_EVENT)
    except OSError:  # a program without a console cannot send it
        process.kill()
