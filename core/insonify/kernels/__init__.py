"""Numba kernels of all tracers: they work on arrays and NamedTuples alone, never on a Scene."""
