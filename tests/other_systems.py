"""Plugin of pytest that imitates Windows or macOS on Linux: ``PYTHONPATH=tests pytest -p other_systems``.

INSONIFY_SYSTEM names the system: ``windows`` (without it) or ``macos``. To modules of this checkout, and in processes
that they start, the names that the system lacks are missing from `os`, `signal` and their kin, whole modules cannot be
imported, and ``sys.platform`` is that of the system. Libraries see the system as it is. Whoever makes a file, the
system's rules of names hold; on Windows no open file is replaced or removed, and a path has at most 259 characters.

What libraries in C do (Qt, VTK, HDF5, GDAL), how fonts look and how a window behaves cannot be imitated.

PYTEST_DONT_REWRITE: it is imported before pytest in the processes that pytest-xdist starts.
"""

import builtins
import errno
import fcntl
import importlib.metadata
import io
import multiprocessing
import os
import re
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator, Mapping
from functools import lru_cache
from pathlib import Path
from types import ModuleType
from typing import Any

SYSTEM = "INSONIFY_SYSTEM"
CHECKOUT = str(Path(__file__).resolve().parents[1])
OWN = tuple(os.path.join(CHECKOUT, folder, "") for folder in ("core", "app", "tests"))
LONGEST_PATH = 259  # characters, on Windows
RESERVED = {"CON", "PRN", "AUX", "NUL", *(f"{port}{number}" for port in ("COM", "LPT") for number in range(1, 10))}
FORBIDDEN = re.compile(r'[<>:"|?*\\\x00-\x1f]|[. ]$')
# Of `os`, in the order of its documentation: processes and users, scheduling, files.
LINUX_ALONE = {
    "os": (
        "sched_getaffinity sched_setaffinity sched_getscheduler sched_setscheduler sched_getparam sched_setparam "
        "getxattr setxattr listxattr removexattr memfd_create eventfd copy_file_range splice "
        "posix_fadvise posix_fallocate getrandom pipe2 setresuid setresgid pidfd_open unshare setns O_DIRECT "
        "O_TMPFILE O_PATH O_NOATIME"
    ),
    "signal": "sigtimedwait sigwaitinfo pidfd_send_signal SIGPWR SIGPOLL SIGSTKFLT SIGRTMIN SIGRTMAX",
}
POSIX_ALONE = {
    "os": (
        "fork forkpty register_at_fork posix_spawn posix_spawnp wait waitid wait3 wait4 WNOHANG WIFEXITED WEXITSTATUS "
        "getuid geteuid getgid getegid getgroups getresuid getresgid setuid setgid seteuid setegid initgroups ctermid "
        "killpg getpgid getpgrp setpgid setsid getsid tcgetpgrp tcsetpgrp nice getpriority setpriority PRIO_PROCESS "
        "sysconf sysconf_names confstr getloadavg uname sched_yield chroot chown lchown fchown fchmod fchdir chflags "
        "lockf mkfifo mknod major minor makedev statvfs fstatvfs pathconf fpathconf pread pwrite preadv pwritev readv "
        "writev sendfile openpty O_NONBLOCK O_NOFOLLOW O_DIRECTORY O_CLOEXEC O_SYNC O_DSYNC O_NOCTTY EX_OK EX_USAGE"
    ),
    "signal": (
        "alarm pause setitimer getitimer ITIMER_REAL ITIMER_VIRTUAL siginterrupt pthread_kill pthread_sigmask "
        "SIG_BLOCK SIG_SETMASK SIG_UNBLOCK sigpending sigwait SIGKILL SIGHUP SIGQUIT SIGALRM SIGUSR1 SIGUSR2 SIGCHLD "
        "SIGPIPE SIGCONT SIGSTOP SIGTSTP SIGXCPU SIGXFSZ SIGWINCH SIGBUS"
    ),
    "time": "tzset clock_gettime clock_settime CLOCK_MONOTONIC",
    "socket": "AF_UNIX socketpair",
}
# A request by Ctrl-Break ends one process here; on Windows, its group.
WINDOWS_ALONE: dict[str, dict[str, Any]] = {
    "signal": {"CTRL_BREAK_EVENT": signal.SIGTERM},
    "subprocess": {"CREATE_NEW_PROCESS_GROUP": 0x200, "BELOW_NORMAL_PRIORITY_CLASS": 0x4000},
}
POSIX_MODULES = {"fcntl", "grp", "posix", "pty", "pwd", "resource", "syslog", "termios", "tty"}
SYSTEMS = {
    "windows": ("win32", "nt", [LINUX_ALONE, POSIX_ALONE], POSIX_MODULES),
    "macos": ("darwin", "posix", [LINUX_ALONE], set()),
}


class Imitated(ModuleType):
    """A module as another system has it; what is set by a test is set in the module itself."""

    def __init__(self, real: ModuleType, missing: dict[str, Any], changed: dict[str, Any]) -> None:
        super().__init__(real.__name__)
        self.__dict__.update(_real=real, _missing=missing, _changed=changed, _before={})

    def __getattr__(self, name: str) -> Any:
        if name in self._changed:
            return self._changed[name]
        found = getattr(self._real, name)
        if name in self._missing and found is self._missing[name]:
            raise AttributeError(f"module {self._real.__name__!r} of this system has no attribute {name!r}")
        return found

    def __setattr__(self, name: str, value: Any) -> None:
        if hasattr(self._real, name):
            self._before.setdefault(name, getattr(self._real, name))
        setattr(self._real, name, value)

    def __delattr__(self, name: str) -> None:
        if name in self._before:  # set by a test, which now takes it back
            setattr(self._real, name, self._before.pop(name))
        else:
            delattr(self._real, name)

    def __dir__(self) -> list[str]:
        return [name for name in dir(self._real) if hasattr(self, name)]


def imitate(name: str) -> None:
    """Let this process, and all that it starts, be of another system."""
    platform, kind, lacking, modules = SYSTEMS[name]
    imitated = {}
    for module in ("os", "signal", "time", "socket", "subprocess", "sys"):
        real = __import__(module)
        names = " ".join(each.get(module, "") for each in lacking).split()
        missing = {one: getattr(real, one) for one in names if hasattr(real, one)}
        changed = {"os": {"name": kind}, "sys": {"platform": platform}}.get(module, {})
        changed |= WINDOWS_ALONE.get(module, {}) if name == "windows" else {}
        imitated[module] = Imitated(real, missing, changed)
    _hide_from_imports(imitated | ({"msvcrt": _msvcrt()} if name == "windows" else {}), modules)
    _hide_system_files()
    sys.addaudithook(FileRules(windows=name == "windows").check)
    _imitate_in_children(name)
    multiprocessing.set_start_method("spawn", force=True)


def _msvcrt() -> ModuleType:
    """Return what this checkout uses of a module of Windows: locks on parts of files."""
    module = ModuleType("msvcrt")

    def locking(descriptor: int, mode: int, count: int) -> None:
        del mode, count
        try:
            fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            raise PermissionError(errno.EACCES, os.strerror(errno.EACCES)) from None

    module.__dict__.update(LK_NBLCK=2, locking=locking)
    return module


def _is_own(module: dict[str, Any] | None) -> bool:
    """Whether a module's globals are those of a module of this checkout."""
    return bool(module) and str(module.get("__file__", "")).startswith(OWN) and module["__file__"] != __file__


def _hide_from_imports(imitated: Mapping[str, ModuleType], modules: set[str]) -> None:
    """Let imports in modules of this checkout find the imitated modules, and others not at all."""
    before = builtins.__import__

    def find(name: str, globals: Any = None, locals: Any = None, fromlist: Any = (), level: int = 0) -> ModuleType:
        if level == 0 and _is_own(globals):
            if name in modules:
                raise ModuleNotFoundError(f"No module named {name!r} on this system", name=name)
            if name in imitated:
                return imitated[name]
        return before(name, globals, locals, fromlist, level)

    builtins.__import__ = find


def _hide_system_files() -> None:
    """Let modules of this checkout find no /proc and no /sys."""
    before: Callable[..., Any] = io.open

    def opened(file: Any, *rest: Any, **named: Any) -> Any:
        if str(file).startswith(("/proc/", "/sys/")):
            frame = sys._getframe(1)
            while frame.f_back is not None and "pathlib" in frame.f_code.co_filename:
                frame = frame.f_back
            if _is_own(frame.f_globals):
                raise FileNotFoundError(errno.ENOENT, os.strerror(errno.ENOENT), str(file))
        return before(file, *rest, **named)

    io.open = builtins.open = opened  # type: ignore[assignment]


class FileRules:
    """Rules of a system for names of files, checked whenever Python opens, renames or removes one."""

    def __init__(self, windows: bool) -> None:
        self._windows = windows

    def check(self, event: str, given: tuple[Any, ...]) -> None:
        """Raise OSError for what the system would refuse; called by Python before it does something."""
        opens_new = event == "open" and isinstance(given[2], int) and given[2] & os.O_CREAT
        if opens_new or (event == "os.mkdir" and given[2] == -1):
            self._check_new(given[0])
        elif event == "os.rename" and given[2:] == (-1, -1):
            self._check_new(given[1])
            self._check_closed(given[0], given[1])
        elif event == "os.remove" and given[1] == -1:
            self._check_closed(given[0])

    def _check_new(self, path: Any) -> None:
        """Raise OSError for a name that cannot be made."""
        if not isinstance(path, (str, os.PathLike)):
            return
        whole = Path(os.path.abspath(path))
        if whole.parts[1:2] in (("dev",), ("proc",)):
            return
        if self._windows:
            if len(str(whole)) > LONGEST_PATH:
                raise FileNotFoundError(errno.ENOENT, f"path of {len(str(whole))} characters", str(whole))
            for part in whole.parts[1:]:
                if FORBIDDEN.search(part) or part.partition(".")[0].upper() in RESERVED:
                    raise OSError(errno.EINVAL, "name that this system does not allow", str(whole))
        if twin := _twin(whole):
            raise FileExistsError(errno.EEXIST, f"on this system the same as {twin!r}", str(whole))

    def _check_closed(self, *paths: Any) -> None:
        """Raise PermissionError for a file that this process has open, and for a folder with such a file."""
        if not self._windows:
            return
        for named in (os.path.realpath(os.fsdecode(path)) for path in paths if isinstance(path, (str, os.PathLike))):
            if any(file == named or file.startswith(f"{named}{os.sep}") for file in _open_files()):
                raise PermissionError(errno.EACCES, "The file is being used by another process", named)


def _twin(path: Path) -> str:
    """Return the name of another file of the same folder whose name differs in case alone; empty if there is none."""
    lowered = path.name.lower()
    if lowered == path.name.upper().lower() and path.name.isascii() and not any(map(str.isalpha, path.name)):
        return ""
    try:
        present = os.listdir(path.parent)
    except OSError:
        return ""
    return next((name for name in present if name != path.name and name.lower() == lowered), "")


def _open_files() -> Iterator[str]:
    """Files that this process has open or mapped."""
    for number in os.listdir("/proc/self/fd"):
        try:
            yield os.readlink(f"/proc/self/fd/{number}")
        except OSError:
            continue
    for line in Path("/proc/self/maps").read_text(encoding="utf-8", errors="replace").splitlines():
        yield line.split(maxsplit=5)[5] if line.count("/") else ""


def _imitate_in_children(name: str) -> None:
    """Let every Python that is started import this module before anything else."""
    before = subprocess.Popen.__init__

    def start(self: Any, args: Any, *rest: Any, **named: Any) -> None:
        named.pop("creationflags", None)
        if _is_python(args):
            given = named.get("env")
            environment = dict(os.environ if given is None else given)
            paths = [str(Path(__file__).with_name("imitated")), *environment.get("PYTHONPATH", "").split(os.pathsep)]
            if "DISPLAY" not in environment:  # VTK, which is Linux's own, would look for it
                environment.setdefault("VTK_DEFAULT_OPENGL_WINDOW", "vtkEGLRenderWindow")
            named["env"] = environment | {SYSTEM: name, "PYTHONPATH": os.pathsep.join(filter(None, paths))}
        before(self, args, *rest, **named)

    subprocess.Popen.__init__ = start  # type: ignore[method-assign]


@lru_cache
def _scripts() -> set[str]:
    return {entry.name for entry in importlib.metadata.entry_points(group="console_scripts")}


def _is_python(args: Any) -> bool:
    """Whether a command starts the Python of this environment, by itself or by a script of it."""
    if isinstance(args, (str, bytes)):
        return False
    first = Path(os.fsdecode(next(iter(args), "")))
    return str(first) == sys.executable or (first.parent == Path(sys.executable).parent and first.name in _scripts())


imitate(os.environ.get(SYSTEM, "windows"))
