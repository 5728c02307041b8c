"""Inversion of a record: relief, material and speckle of a bed with a similar simulated record."""
