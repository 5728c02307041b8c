"""Cores that this process may use: its affinity, the quota of its control group, and the limit that its user sets."""

import math
import os
from collections.abc import Iterator
from functools import cache
from multiprocessing import parent_process
from pathlib import Path

from insonify.errors import SceneError, is_count
from insonify.operating_system import call_after_fork

VARIABLE = "INSONIFY_THREADS"
GROUPS = Path("/proc/self/cgroup")
MOUNT = Path("/sys/fs/cgroup")


@cache
def most_threads() -> int:
    """Return the greatest number of threads that work at a time: `INSONIFY_THREADS`, or else the usable cores."""
    declared = os.environ.get(VARIABLE, "").strip()
    if not declared:
        return usable_cores()
    if not (is_count(declared) and int(declared) > 0):
        raise SceneError(
            f"{VARIABLE}: {declared!r} is not a number of threads; set it to a whole number from 1, or unset it"
        )
    return int(declared)


def default_threads() -> int:
    """Return the number of threads that work at a time if the caller names none: all, but one in a worker process."""
    # A process that `multiprocessing` started is one of several as a rule: of a pool, of a data loader, of a cluster.
    return 1 if parent_process() is not None and not os.environ.get(VARIABLE, "").strip() else most_threads()


def usable_cores() -> int:
    """Return the number of cores that this process may keep busy, by its affinity and its control group's quota."""
    allowed = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    return math.ceil(max(1.0, min(float(allowed), _quota())))


def _quota() -> float:
    """Cores' worth of time that the control groups of this process grant it; infinite if they set no limit."""
    try:
        rows = [line.split(":", 2) for line in GROUPS.read_text(encoding="utf-8").splitlines()]
    except OSError:
        return math.inf
    return min((quota for row in rows if len(row) == 3 for quota in _quotas_above(row[1], row[2])), default=math.inf)


def _quotas_above(controllers: str, group: str) -> Iterator[float]:
    """Quotas of a control group and of those above it; the row of version 2 names no controllers, version 1 does."""
    if controllers and "cpu" not in controllers.split(","):
        return
    root = MOUNT / "cpu" if controllers else MOUNT
    place = Path(os.path.normpath(root / group.lstrip("/")))
    for folder in (place, *place.parents):
        if not folder.is_relative_to(root):
            return
        names = ("cpu.cfs_quota_us", "cpu.cfs_period_us") if controllers else ("cpu.max",)
        try:
            granted, period = " ".join((folder / name).read_text(encoding="utf-8") for name in names).split()
        except (OSError, ValueError):
            continue
        if granted not in ("max", "-1"):
            yield int(granted) / int(period)


call_after_fork(most_threads.cache_clear)
