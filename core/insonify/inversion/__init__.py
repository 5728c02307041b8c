"""Inversion of a record: relief, material and speckle of a bed whose simulated record resembles it."""
