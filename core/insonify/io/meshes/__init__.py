"""Readers of shapes made of triangles."""

from insonify.io.meshes.read import FORMATS, read_mesh

__all__ = ["FORMATS", "read_mesh"]
