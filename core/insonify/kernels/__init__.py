"""Numba kernels of all tracers: they work on arrays and NamedTuples alone, never on a Scene."""

import os

# Where colorama is installed, Numba replaces standard output and error for a moment whenever it words an error of its
# type inference, thousands of times as it compiles. The streams belong to all threads: what another thread writes
# meanwhile is lost to whoever has redirected them. Numba reads this as it is imported.
os.environ.setdefault("NUMBA_DISABLE_ERROR_MESSAGE_HIGHLIGHTING", "1")
