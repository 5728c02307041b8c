"""Priority of the threads that work beside the window."""

from __future__ import annotations

import os
import sys

LOWER = 5  # steps of niceness, each some 20 % of a processor's share


def yield_to_window(process: int = 0) -> None:
    """Lower the priority of the calling thread, or of a process that just started, and of the threads that it starts.

    Tracing keeps all processors busy, on which the main thread would have to wait for its turn. Only Linux has
    priorities of single threads that go by niceness.
    """
    if sys.platform == "linux":
        os.setpriority(os.PRIO_PROCESS, process, os.getpriority(os.PRIO_PROCESS, process) + LOWER)
