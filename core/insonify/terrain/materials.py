"""Maps of what the bed is made of: one index per cell."""

from __future__ import annotations

import numpy as np

from insonify.kernels.bed.nearest_seed import voronoi_materials
from insonify.scene.materials import FractalMap, ImageMap, Material, MaterialMap, Patches, PatternMap, Reflectivity
from insonify.scene.reliefs.fractal import Fractal
from insonify.terrain.lattice import Lattice, Map
from insonify.terrain.patterns import graded_rows, pattern_map
from insonify.terrain.pictures import picture_map
from insonify.terrain.spectra import MATERIAL_BANDS, MATERIAL_PATCHES, synthesise


def material_table(material: MaterialMap) -> tuple[tuple[str, ...], tuple[Reflectivity, ...]]:
    """Names and numbers of a map's materials, in the order of its indices."""
    materials = (material,) if isinstance(material, Material) else material.of
    if isinstance(material, PatternMap) and material.shape == "waves":
        return graded_rows(materials)
    return tuple(one.name for one in materials), tuple(one.reflectivity for one in materials)


def material_indices(material: MaterialMap, lattice: Lattice, seed: int) -> Map:
    """Index of each cell's material, (ny, nx) uint8, for the cell whose low corner is that node.

    A map repeats with its bed. What a place is made of depends on the seed and the place, not on the grid; only the
    borders of a fractal map move by a little, for a finer grid has finer waves.
    """
    if isinstance(material, Patches):
        return _patches(lattice, material.size, len(material.of), seed)
    if isinstance(material, FractalMap):
        return _bands(lattice, material.beta, len(material.of), seed)
    if isinstance(material, PatternMap):
        return pattern_map(material, lattice)
    if isinstance(material, ImageMap):
        return picture_map(material, lattice)
    return np.zeros(lattice.shape, dtype=np.uint8)


def _patches(lattice: Lattice, size: float, count: int, seed: int) -> Map:
    """Give every cell to the nearest of hashed points, one per square; squares divide the period of a periodic bed."""
    ny, nx = lattice.shape
    repeat = 0
    if lattice.periodic:
        period = nx * lattice.spacing
        repeat = max(1, round(period / size))
        size = period / repeat
    u = (lattice.x0 + (np.arange(nx) + 0.5) * lattice.spacing) / size
    v = (lattice.y0 + (np.arange(ny) + 0.5) * lattice.spacing) / size
    indices: Map = voronoi_materials(seed, MATERIAL_PATCHES, u, v, repeat, count)
    return indices


def _bands(lattice: Lattice, beta: float, count: int, seed: int) -> Map:
    """Cut a fractal field so that every material covers an equal area."""
    ny, nx = lattice.shape
    # A square field, cropped, for its waves are to be as long in x as in y.
    side = (max(ny, nx),) * 2
    field = synthesise(Fractal(beta=beta, rms=1.0), side, side, seed, MATERIAL_BANDS)[:ny, :nx]
    cuts = np.quantile(field, np.arange(1, count) / count)
    return np.searchsorted(cuts, field).astype(np.uint8)
