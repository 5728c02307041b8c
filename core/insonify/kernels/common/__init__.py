"""Shared by all kernels: decorators, cached machine code, types, hashing, range bins, scattering laws."""
