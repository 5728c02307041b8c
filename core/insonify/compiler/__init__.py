"""Compilation of kernels by Numba: decorators, cached machine code, parts compiled once, and progress."""
