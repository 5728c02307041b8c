"""Numba kernels of all tracers: they work on arrays and NamedTuples alone, never on a Scene."""

import insonify.compiler  # noqa: F401  # before Numba, whose settings it changes
