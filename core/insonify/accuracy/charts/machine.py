"""Machine and versions on which a measurement of time depends."""

from __future__ import annotations

import platform
from importlib.metadata import version
from pathlib import Path

from insonify.cores import usable_cores


def describe_machine() -> str:
    """Describe the processor, its cores and the versions of the software."""
    parts = (
        _processor(),
        f"{usable_cores()} cores, one thread used",
        platform.system(),
        f"Python {platform.python_version()}",
        f"Numba {version('numba')}",
        f"insonify {version('insonify')}",
    )
    return ", ".join(parts)


def _processor() -> str:
    """Name of the processor, as well as the system tells it."""
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8", errors="replace").splitlines()
    except OSError:
        lines = []
    names = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
    return names[0] if names else platform.processor() or platform.machine()
