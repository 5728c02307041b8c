"""Cells of a bed and the materials of them, by index, with the random fields from which maps are thresholded."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from statistics import NormalDist

import numpy as np

from insonify.arrays import Floats
from insonify.errors import located
from insonify.io.georeference import Georeference
from insonify.kernels.bed.voronoi import voronoi_materials
from insonify.kernels.common.streams import MATERIAL_BANDS, MATERIAL_PATCHES
from insonify.scene.seabed.materials import Map, MaterialMap
from insonify.scene.seabed.reliefs.fractal import Fractal
from insonify.terrain.endless_field import EndlessField, Nodes
from insonify.terrain.random_heights import unmasked_heights

NO_NODES = Nodes(0, 0, 0, 0)


@dataclass(frozen=True)
class Lattice:
    """Number, spacing and position of the cells of a bed."""

    shape: tuple[int, int]  # cells along y and x
    spacing: float  # metres between nodes
    x0: float = 0.0  # local coordinates of node (0, 0), in metres
    y0: float = 0.0
    periodic: bool = True  # whether the bed repeats

    @property
    def size(self) -> tuple[float, float]:
        """Extent along x and y in metres, the periods of a periodic bed."""
        return self.shape[1] * self.spacing, self.shape[0] * self.spacing

    def centres(self) -> tuple[Floats, Floats]:
        """Local x and y of the centres of the cells, (nx,) and (ny,), in metres."""
        ny, nx = self.shape
        x = self.x0 + (np.arange(nx, dtype=np.float64) + 0.5) * self.spacing
        y = self.y0 + (np.arange(ny, dtype=np.float64) + 0.5) * self.spacing
        return x, y


@dataclass(frozen=True)
class BedCells(Lattice):
    """Cells of a bed, and random fields over them for maps of materials.

    The material at a point depends on the seed and the point, not on the grid; only the borders of bands move slightly,
    because a finer grid has finer waves.
    """

    seed: int = 0  # seed of the random fields
    place: Georeference | None = None  # map coordinates of the local (0, 0)

    def patches(self, size: float, count: int) -> Map:
        """Assign every cell to the nearest of random points, one per square; squares divide the period of a bed."""
        repeat = 0
        if self.periodic:
            repeat = max(1, round(self.size[0] / size))
            size = self.size[0] / repeat
        x, y = self.centres()
        indices: Map = voronoi_materials(self.seed, MATERIAL_PATCHES, x / size, y / size, repeat, count)
        return indices

    def bands(self, beta: float, count: int) -> Map:
        """Split a fractal field by height into bands of equal area."""
        ny, nx = self.shape
        # A square field is cropped, so that waves are as long in x as in y.
        side = (max(ny, nx),) * 2
        field = unmasked_heights(Fractal(beta=beta, rms=1.0), side, side, self.seed, MATERIAL_BANDS)[:ny, :nx]
        cuts = np.quantile(field, np.arange(1, count) / count)
        return np.searchsorted(cuts, field).astype(np.uint8)


@dataclass(frozen=True)
class EndlessCells(BedCells):
    """Cells of some nodes of endless ground, and random fields over them."""

    nodes: Nodes = NO_NODES  # the nodes
    period: float = 0.0  # metres, longest waves of a fractal field

    def bands(self, beta: float, count: int) -> Map:
        """Split a fractal field by height into bands of equal expected area."""
        field = _endless_field(beta, self.period, self.spacing, self.seed)
        cuts = [NormalDist().inv_cdf(k / count) * math.sqrt(field.variance) for k in range(1, count)]
        return np.searchsorted(cuts, field.values(self.nodes)).astype(np.uint8)


def material_indices(material: MaterialMap, lattice: Lattice, seed: int, place: Georeference | None = None) -> Map:
    """Row of the table of materials for each cell, (ny, nx) uint8; the low corner of a cell is its node."""
    cells = BedCells(lattice.shape, lattice.spacing, lattice.x0, lattice.y0, lattice.periodic, seed, place)
    with located("seabed.material."):
        return material.indices(cells)


def endless_materials(
    material: MaterialMap, period: float, spacing: float, seed: int, place: Georeference | None = None
) -> Callable[[Nodes], Map]:
    """Return a function of nodes, which maps their materials; fractal fields have no waves longer than a period."""

    def indices(nodes: Nodes) -> Map:
        x0, y0 = nodes.column * spacing, nodes.row * spacing
        cells = EndlessCells(nodes.shape, spacing, x0, y0, False, seed, place, nodes, period)
        with located("seabed.material."):
            return material.indices(cells)

    return indices


@lru_cache(maxsize=2)
def _endless_field(beta: float, period: float, spacing: float, seed: int) -> EndlessField:
    fractal = Fractal(beta=beta, period=period, clamp="soft", coefficients="gaussian", extent="endless")
    return EndlessField(fractal.bands(), spacing, seed, MATERIAL_BANDS)
