"""Meshes of triangles: a format is one module here that holds a `FileFormat`."""

from insonify.io.meshes.mesh import MESHES, has_area, read_mesh

__all__ = ["MESHES", "has_area", "read_mesh"]
