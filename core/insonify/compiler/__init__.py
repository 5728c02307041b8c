"""Compilation of kernels by Numba: decorators, machine code on disk, a child process that compiles, and progress."""

import os

from insonify.foreign_settings import NUMBA, ignore_settings

# Where colorama is installed, Numba replaces standard output and error for a moment whenever it words an error of its
# type inference, thousands of times as it compiles. The streams belong to all threads: what another thread writes
# meanwhile would be lost. Numba reads this as it is imported.
os.environ.setdefault("NUMBA_DISABLE_ERROR_MESSAGE_HIGHLIGHTING", "1")
ignore_settings(NUMBA)
