"""All Numba and nothing else; sees arrays and NamedTuples, never a Scene."""
