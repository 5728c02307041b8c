"""Packing of a scene into the arrays that kernels take: bed, targets and tables."""
