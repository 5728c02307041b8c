"""Priority of the threads that work beside the window."""

from __future__ import annotations

import os
import sys

LOWER = 5  # steps of niceness, each some 20 % of a processor's share


def yield_to_window() -> None:
    """Lower the priority of the calling thread, and of those that it starts, so that it does not delay the window.

    Tracing keeps all processors busy, on which the main thread would have to wait for its turn. Only Linux has
    priorities of single threads that go by niceness.
    """
    if sys.platform == "linux":
        os.setpriority(os.PRIO_PROCESS, 0, os.getpriority(os.PRIO_PROCESS, 0) + LOWER)
