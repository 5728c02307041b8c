"""Maps of the materials of a bed, one index per cell, and the random fields from which they are thresholded."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from statistics import NormalDist

import numpy as np

from insonify.errors import located
from insonify.io.georeference import Georeference
from insonify.kernels.bed.voronoi import voronoi_materials
from insonify.kernels.common.streams import MATERIAL_BANDS, MATERIAL_PATCHES
from insonify.scene.seabed.materials import MaterialMap
from insonify.scene.seabed.reliefs.fractal import Fractal
from insonify.terrain.endless_field import EndlessField, Nodes
from insonify.terrain.lattice import Lattice, Map
from insonify.terrain.periodic_relief import unmasked_heights

Cuts = tuple[float, ...]
NO_NODES = Nodes(0, 0, 0, 0)


@dataclass(frozen=True)
class BedCells(Lattice):
    """Cells of a bed, and the random fields over them from which maps of materials are made.

    The material of a place depends on the seed and the place, not on the grid; only the borders of bands move slightly,
    because a finer grid has finer waves.
    """

    seed: int = 0  # seed of the random fields
    place: Georeference | None = None  # place of the local (0, 0) on Earth

    def patches(self, size: float, count: int) -> Map:
        """Assign every cell to the nearest of hashed points, one per square; squares divide the period of a bed."""
        ny, nx = self.shape
        repeat = 0
        if self.periodic:
            period = nx * self.spacing
            repeat = max(1, round(period / size))
            size = period / repeat
        u = (self.x0 + (np.arange(nx) + 0.5) * self.spacing) / size
        v = (self.y0 + (np.arange(ny) + 0.5) * self.spacing) / size
        indices: Map = voronoi_materials(self.seed, MATERIAL_PATCHES, u, v, repeat, count)
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
    """Cells of some nodes of endless ground, and the random fields over them."""

    nodes: Nodes = NO_NODES  # the nodes
    period: float = 0.0  # metres beyond which a fractal field is smooth

    def bands(self, beta: float, count: int) -> Map:
        """Split a fractal field by height into bands of equal expected area."""
        field = _endless_field(beta, self.period, self.spacing, self.seed)
        cuts = [NormalDist().inv_cdf(k / count) * math.sqrt(field.variance) for k in range(1, count)]
        return np.searchsorted(cuts, field.values(self.nodes)).astype(np.uint8)


def material_indices(material: MaterialMap, lattice: Lattice, seed: int, place: Georeference | None = None) -> Map:
    """Row of the table of materials for each cell, (ny, nx) uint8, for the cell whose low corner is that node.

    A map repeats with its bed.
    """
    cells = BedCells(lattice.shape, lattice.spacing, lattice.x0, lattice.y0, lattice.periodic, seed, place)
    with located("seabed.material"):
        return material.indices(cells)


def endless_materials(
    material: MaterialMap, period: float, spacing: float, seed: int, place: Georeference | None = None
) -> Callable[[Nodes], Map]:
    """Return a function of some nodes, which maps their materials; fractal fields are smooth beyond a period."""

    def indices(nodes: Nodes) -> Map:
        x0, y0 = nodes.column * spacing, nodes.row * spacing
        cells = EndlessCells(nodes.shape, spacing, x0, y0, False, seed, place, nodes, period)
        with located("seabed.material"):
            return material.indices(cells)

    return indices


@lru_cache(maxsize=2)
def _endless_field(beta: float, period: float, spacing: float, seed: int) -> EndlessField:
    fractal = Fractal(beta=beta, period=period, clamp="soft", coefficients="gaussian", extent="endless")
    return EndlessField(fractal.bands(), spacing, seed, MATERIAL_BANDS)
