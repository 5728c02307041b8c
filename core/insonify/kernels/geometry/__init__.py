"""Solids, triangles, bounding volume hierarchy, and the cross-sections that a plane cuts."""
