"""The ground of a scene: heights and materials on one grid."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from insonify.arrays import Booleans, Bytes, Floats, Singles
from insonify.scene.seabed.materials.catalogue import Reflectivity

FARTHEST_CELL = 2.0**52  # cells; beyond, float64 cannot resolve integers


@dataclass(frozen=True, eq=False)
class Ground:
    """Heights and materials of a bed."""

    # (ny, nx) metres above the datum, NaN where there is no bed; axis 0 is y, axis 1 is x, both increasing.
    heights: Singles
    materials: Bytes  # (ny, nx) row of ``reflectivities`` of the cell with its low corner at the node
    names: tuple[str, ...]  # names of the materials
    reflectivities: tuple[Reflectivity, ...]  # scattering parameters of the materials
    x0: float  # local coordinates of node (0, 0), in metres
    y0: float
    spacing: float  # metres between nodes
    periodic: bool  # whether the bed repeats after nx by ny cells; if not, there is no bed outside
    datum: float  # world height of the mean bed, in metres (negative under water)

    def around(self, centre: tuple[float, float], half: float) -> Self:
        """Ground of a square around a point: this ground itself, which is stored as a whole."""
        return self

    def thinned(self, every: int) -> Self:
        """Return the bed thinned to every n-th node along each axis, with node (0, 0); a level bed gets wider cells."""
        if every == 1:
            return self
        is_level = len(self.reflectivities) == 1 and bool((self.heights == self.heights[0, 0]).all())
        step = 1 if self.periodic and is_level else every
        return replace(
            self,
            heights=np.ascontiguousarray(self.heights[::step, ::step]),
            materials=np.ascontiguousarray(self.materials[::step, ::step]),
            spacing=every * self.spacing,
        )

    def height_at(self, x: Floats, y: Floats) -> Floats:
        """Bilinear height above the datum, NaN where there is no bed or float64 cannot resolve cells."""
        return self._interpolated(*self._in_cells(x, y))

    def _in_cells(self, x: Floats, y: Floats) -> tuple[Floats, ...]:
        """Coordinates in cells from the first node."""
        u = (np.asarray(x, dtype=np.float64) - self.x0) / self.spacing
        return u, (np.asarray(y, dtype=np.float64) - self.y0) / self.spacing

    def _interpolated(self, u: Floats, v: Floats) -> Floats:
        ny, nx = self.heights.shape
        inside = resolves_cells(u, v)
        if not self.periodic:
            inside &= (u >= 0) & (u <= nx - 1) & (v >= 0) & (v <= ny - 1)
        u, v = np.where(inside, u, 0.0), np.where(inside, v, 0.0)
        i, j = np.floor(u).astype(np.int64), np.floor(v).astype(np.int64)
        if self.periodic:
            rows, columns = (j % ny, (j + 1) % ny), (i % nx, (i + 1) % nx)
        else:
            # The last node closes the last cell.
            i, j = np.minimum(i, max(nx - 2, 0)), np.minimum(j, max(ny - 2, 0))
            rows, columns = (j, np.minimum(j + 1, ny - 1)), (i, np.minimum(i + 1, nx - 1))
        z = self.heights
        return np.where(inside, bilinear(lambda k, m: z[rows[k], columns[m]], u - i, v - j), np.nan)

    height_at_once = height_at  # because the whole bed is stored

    def height_near(self, x: Floats, y: Floats) -> Floats:
        """Bilinear height above the datum; outside the bed the height of the nearest bed."""
        u, v = self._in_cells(x, y)
        if not self.periodic:
            # In cells: rounding may put a coordinate in metres beyond the last node.
            ny, nx = self.heights.shape
            u, v = np.clip(u, 0.0, nx - 1.0), np.clip(v, 0.0, ny - 1.0)
        return self._whole._interpolated(u, v)

    @cached_property
    def _whole(self) -> Self:
        """The same ground with holes filled by the nearest heights."""
        holes = np.isnan(self.heights)
        if not holes.any():
            return self
        from scipy.ndimage import distance_transform_edt

        rows, columns = distance_transform_edt(holes, return_distances=False, return_indices=True)
        return replace(self, heights=self.heights[rows, columns])


def resolves_cells(u: Floats, v: Floats) -> Booleans:
    """Whether float64 resolves cells at coordinates in cells from the first node."""
    return (np.abs(u) < FARTHEST_CELL) & (np.abs(v) < FARTHEST_CELL)


def bilinear(corner: Callable[[int, int], NDArray[Any]], fu: NDArray[Any], fv: NDArray[Any]) -> NDArray[Any]:
    """Bilinear interpolation within cells."""
    low = corner(0, 0) * (1 - fu) + corner(0, 1) * fu
    high = corner(1, 0) * (1 - fu) + corner(1, 1) * fu
    return np.asarray(low * (1 - fv) + high * fv)
