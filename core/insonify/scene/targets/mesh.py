"""Shapes from files of triangles."""

import math
from typing import Any

import numpy as np

from insonify.arrays import Floats
from insonify.errors import located
from insonify.files import kept_until_changed
from insonify.io.meshes import bounds_bodies, read_mesh
from insonify.scene.base import FilePath, parameter
from insonify.scene.targets import Posed
from insonify.scene.targets.shape import Outline, Shape


class MeshFile(Posed, kind="mesh", rank=5):
    """A shape from a file of triangles; its centre is that of the bounding box before it is turned."""

    path: FilePath = parameter(
        description="OBJ, STL, PLY, glTF or GLB file, x ahead and z up (glTF: y up), or the name of a bundled mesh",
        min_length=1,
    )
    scale: float = parameter(1.0, "metres per unit of the file", ge=1e-6, le=1e6, slider=(0.01, 100.0), log=True)

    def shape(self) -> Shape:
        """Return the file's triangles, in metres about their centre."""
        corners = _read(self.path)
        centre = 0.5 * (corners.min(axis=(0, 1)) + corners.max(axis=(0, 1)))
        return Shape(triangles=self.scale * (corners - centre), closed=_measured(self.path)[2])

    @property
    def sizes(self) -> dict[str, tuple[str, ...]]:
        """Its scale."""
        return {"resize": ("scale",)}

    @property
    def outline(self) -> Outline:
        """Measures of the shape; each version of the file is measured once."""
        size, count, _ = _measured(self.path)
        half = (0.5 * self.scale * size).tolist()
        return Outline(half=tuple(half), triangles=count)

    @classmethod
    def suited_to(cls, reach: float, path: str) -> dict[str, Any]:
        """Choose the file, and a power of ten as scale so that the mesh is no larger than the slant range."""
        extent = float(np.ptp(_read(path), axis=(0, 1)).max())
        return {"path": path, "scale": 10.0 ** min(0, math.floor(math.log10(reach / extent)))}


@kept_until_changed(maxsize=64)
def _measured(path: str) -> tuple[Floats, int, bool]:
    """Size of the bounding box in units of the file, number of triangles, and whether they bound bodies."""
    corners = _read(path)
    return corners.max(axis=(0, 1)) - corners.min(axis=(0, 1)), len(corners), bounds_bodies(path)


def _read(path: str) -> Floats:
    with located("path: "):
        return read_mesh(path)
