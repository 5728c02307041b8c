"""Build the ground of a scene from its declarations, and the heights of its seabed as arrays and as a picture."""

from functools import lru_cache

import numpy as np

from insonify.array_cache import keep_arrays
from insonify.arrays import Bytes, Floats, Singles
from insonify.errors import located
from insonify.files import kept_until_changed
from insonify.io.bathymetry import LARGEST_SIDE
from insonify.io.georeference import Georeference
from insonify.scene import Scene, SceneError
from insonify.scene.seabed import Seabed
from insonify.scene.seabed.materials import MaterialMap
from insonify.scene.seabed.reliefs import HeightGrid, ReliefKind
from insonify.scene.seabed.reliefs.dem import refine
from insonify.scene.seabed.reliefs.random_relief import RandomRelief
from insonify.scene.targets import Pit
from insonify.terrain.endless_field import TILE, Nodes, gather_tiles
from insonify.terrain.endless_ground import SQUARE, AnyGround, EndlessExcerpt, EndlessGround, Tiles, nodes_between
from insonify.terrain.ground import Ground
from insonify.terrain.materials import Lattice, endless_materials, material_indices
from insonify.terrain.random_heights import Heights, endless_heights, periodic_heights

# A level bed has no period of its own: a few cells suffice unless a map of materials needs more.
FLAT_CELLS = 4
FLAT_CELLS_AT_MOST = 4096
SHOWN = 1024  # nodes along a side of the picture of endless ground
GROUNDS = 16  # endless grounds with cached tiles: a scene and its variants without an effect
FEWEST_CELLS = 3  # of a period, so that it contains a wave below the Nyquist frequency

Pits = tuple[Pit, ...]
# Heights above the datum, their lattice, and the datum.
_GridHeights = tuple[Singles, Lattice, float]
_kept_indices = keep_arrays(material_indices)


def build_ground(scene: Scene) -> AnyGround:
    """Heights and materials of the bed of a scene."""
    # Node (0, 0) of a synthetic bed is at the local (0, 0), so that the landscape does not depend on the track. Grounds
    # share cached arrays, which must not be written to.
    if scene.seabed.endless:
        return _endless_ground(scene, _kept_squares(*_endless_relief(scene), TILE))
    material = scene.seabed.material
    names, reflectivities = material.rows(scene.sonar.scattering_frequency)
    place = scene.georeference if material.on_a_map else None
    heights, lattice, datum = _heights(scene)
    return Ground(
        heights=heights if scene.seabed.relief.level else _dig(heights, lattice, scene.pits),
        materials=_kept_indices(material.layout, lattice, scene.seed, place),
        names=names,
        reflectivities=reflectivities,
        x0=lattice.x0,
        y0=lattice.y0,
        spacing=lattice.spacing,
        periodic=lattice.periodic,
        datum=datum,
    )


def build_excerpt(scene: Scene, low: tuple[float, float], high: tuple[float, float]) -> EndlessExcerpt:
    """Endless ground of a scene with one rectangle computed at once, for short-lived pictures."""
    # The fields of the rectangle are not cached; those of tiles are computed when a tile is needed.
    heights = _endless_heights(*_endless_relief(scene))
    whole = _endless_ground(scene, lambda row, column: _kept_squares(*_endless_relief(scene), TILE)(row, column))
    spacing, materials = scene.seabed.spacing, endless_materials(*_endless_map(scene))

    def make(nodes: Nodes) -> Ground:
        x0, y0 = nodes.column * spacing, nodes.row * spacing
        return whole.part(heights(nodes).astype(np.float32), materials(nodes), x0, y0, periodic=False)

    return EndlessExcerpt(**vars(whole), make=make, rectangle=make(nodes_between(low, high, spacing)))


def _endless_ground(scene: Scene, heights: Tiles) -> EndlessGround:
    """Endless ground with given tiles of heights."""
    seabed = scene.seabed
    names, reflectivities = seabed.material.rows(scene.sonar.scattering_frequency)
    return EndlessGround(
        heights=heights,
        materials=_kept_map_tiles(*_endless_map(scene)),
        squares=lambda row, column: _kept_squares(*_endless_relief(scene), SQUARE)(row, column),
        names=names,
        reflectivities=reflectivities,
        spacing=seabed.spacing,
        datum=-seabed.depth,
    )


def _endless_relief(scene: Scene) -> tuple[tuple[RandomRelief, ...], float, int, Pits]:
    """Return what the heights of endless ground depend on."""
    return scene.seabed.random_reliefs, scene.seabed.spacing, scene.seed, scene.pits


def _endless_heights(parts: tuple[RandomRelief, ...], spacing: float, seed: int, pits: Pits) -> Heights:
    """Heights of endless ground with the pits around its targets."""
    heights = endless_heights(parts, spacing, seed)

    def pitted(nodes: Nodes) -> Floats:
        x = spacing * (nodes.column + np.arange(nodes.columns, dtype=np.float64))
        y = spacing * (nodes.row + np.arange(nodes.rows, dtype=np.float64))[:, None]
        return np.asarray(sum((pit.heights(x, y) for pit in pits), heights(nodes)))

    return pitted if pits else heights


def _dig(heights: Singles, lattice: Lattice, pits: Pits) -> Singles:
    """Heights with the pits around targets, which a periodic bed repeats."""
    if not pits:
        return heights
    x, y = (first + lattice.spacing * np.arange(n) for first, n in zip((lattice.x0, lattice.y0), heights.shape[::-1]))
    change: Floats = np.zeros(heights.shape)
    for pit in pits:
        away = [x - pit.x, y - pit.y]
        if lattice.periodic:
            away = [(d + 0.5 * size) % size - 0.5 * size for d, size in zip(away, lattice.size)]
        change += pit.heights(pit.x + away[0], pit.y + away[1][:, None])
    return (heights + change).astype(np.float32)


def _endless_map(scene: Scene) -> tuple[MaterialMap, float, float, int, Georeference | None]:
    """Return what the materials of endless ground depend on: map, period of the relief, spacing, seed, coordinates."""
    seabed, material = scene.seabed, scene.seabed.material
    place = scene.georeference if material.on_a_map else None
    return material.layout, seabed.random_reliefs[0].period, seabed.spacing, scene.seed, place


def cells_of_period(period: float, spacing: float) -> int:
    """Return the number of cells along one side of a period of relief."""
    cells = round(period / spacing)
    if cells < FEWEST_CELLS:
        raise SceneError(
            f"seabed.relief.period: {period:g} m spans {cells} cells of seabed.spacing {spacing:g} m and "
            f"contains no wave; lengthen it to at least {FEWEST_CELLS} cells"
        )
    return cells


def _heights(scene: Scene) -> _GridHeights:
    seabed = scene.seabed
    relief, mean = seabed.relief, -seabed.depth
    if relief.level:
        with located("seabed.material."):
            shape = seabed.material.level_shape(seabed.spacing, FLAT_CELLS, FLAT_CELLS_AT_MOST)
        return np.zeros(shape, dtype=np.float32), Lattice(shape, seabed.spacing), mean
    if seabed.random_reliefs:
        return *_kept_period(seabed.random_reliefs, seabed.spacing, scene.seed), mean
    seed = scene.seed if relief.detail else 0
    return _kept_samples(relief, seabed.spacing, scene.world.origin, mean, seed)


@keep_arrays
def _kept_period(parts: tuple[RandomRelief, ...], spacing: float, seed: int) -> tuple[Singles, Lattice]:
    period = parts[0].period
    cells = cells_of_period(period, spacing)
    shape = (cells, cells)
    # The period is exact; where it is no whole number of cells, the spacing is adjusted.
    return periodic_heights(parts, shape, shape, seed).astype(np.float32), Lattice(shape, period / cells)


def sample_heights(
    relief: ReliefKind, spacing: float, origin: tuple[float, float] | None = None, seed: int = 1
) -> HeightGrid:
    """Sample a bed that is not random, with random detail on top of a measured one."""
    # The measured heights are interpolated bilinearly to the grid of the detail, which begins at the corner of the
    # measured grid and repeats from there.
    grid = relief.sample(spacing, origin)
    if not relief.detail:
        return grid
    period = relief.detail[0].period
    cells = cells_of_period(period, min(spacing, grid.spacing))
    cells += period / cells > grid.spacing  # no coarser than what was measured
    step = period / cells
    nodes = max(int((count - 1) * grid.spacing / step) + 1 for count in grid.heights.shape)
    if nodes > LARGEST_SIDE:
        raise SceneError(
            f"seabed.spacing: {spacing:g} m makes {nodes} nodes along a side of the measured bed; "
            f"widen it to {step * nodes / LARGEST_SIDE:.3g} m or crop the bed to {LARGEST_SIDE * step:.4g} m"
        )
    heights = refine(refine(grid.heights, grid.spacing / step).T, grid.spacing / step).T
    detail = periodic_heights(relief.detail, (cells, cells), (cells, cells), seed)
    rows, columns = (np.arange(count) % cells for count in heights.shape)
    return HeightGrid(heights + detail[np.ix_(rows, columns)], step, grid.x0, grid.y0)


@keep_arrays
def _kept_samples(
    relief: ReliefKind, spacing: float, origin: tuple[float, float] | None, mean: float, seed: int
) -> _GridHeights:
    grid = sample_heights(relief, spacing, origin, seed)
    ny, nx = grid.heights.shape
    lattice = Lattice((ny, nx), grid.spacing, grid.x0, grid.y0, periodic=not relief.measured)
    if not relief.measured:
        return grid.heights.astype(np.float32), lattice, mean
    datum = float(np.nanmean(grid.heights))
    return (grid.heights - datum).astype(np.float32), lattice, datum


_kept_relief = lru_cache(maxsize=GROUNDS)(_endless_heights)


@lru_cache(maxsize=2 * GROUNDS)
def _kept_squares(parts: tuple[RandomRelief, ...], spacing: float, seed: int, pits: Pits, side: int) -> Tiles:
    """Squares of some nodes a side: tiles, or the smaller squares of `EndlessGround`."""
    heights = _kept_relief(parts, spacing, seed, pits)
    return keep_arrays(lambda row, column: heights(Nodes(row * side, column * side, side, side)).astype(np.float32))


@kept_until_changed(maxsize=GROUNDS)
def _kept_map_tiles(layout: MaterialMap, period: float, spacing: float, seed: int, place: Georeference | None) -> Tiles:
    materials = endless_materials(layout, period, spacing, seed, place)
    return keep_arrays(lambda row, column: materials(Nodes.of_tile(row, column)))


def relief(seabed: Seabed, shape: tuple[int, int] | None = None, *, seed: int = 1) -> Floats:
    """Heights of a seabed above its mean.

    Parameters
    ----------
    seabed : Seabed
        Depth, spacing and relief.
    shape : (ny, nx), optional
        Samples of one period along y and x, or nodes of endless ground from the origin; the grid of the seabed when
        left out. The same seed gives the same landscape on every shape; its rms is exact on the grid of the seabed.
    seed : int
        Seed of the landscape.

    Returns
    -------
    (ny, nx) float64
        Metres above the mean bed, NaN where there is none; axis 0 is y, axis 1 is x, both increasing.

    Raises
    ------
    SceneError
        If a shape is given for a measured bed, which has its own, if it has no nodes, or if the bed cannot be built.
    """
    if shape is not None and min(shape) < 1:
        raise SceneError(f"shape: {shape} has no nodes; give at least (1, 1)")
    if seabed.endless:
        heights_of = endless_heights(seabed.random_reliefs, seabed.spacing, seed)
        # Tile by tile, so that any shape takes little memory.
        return gather_tiles(lambda *place: heights_of(Nodes.of_tile(*place)), (0, 0), shape or (SHOWN, SHOWN))
    if seabed.random_reliefs:
        cells = cells_of_period(seabed.random_reliefs[0].period, seabed.spacing)
        return periodic_heights(seabed.random_reliefs, shape or (cells, cells), (cells, cells), seed)
    if seabed.relief.level:
        return np.zeros(shape or (FLAT_CELLS, FLAT_CELLS))
    if seabed.relief.detail and shape is None:
        heights = sample_heights(seabed.relief, seabed.spacing, seed=seed).heights
    else:
        heights = seabed.relief.sample(seabed.spacing, shape=shape).heights
    return np.asarray(heights - np.nanmean(heights)) if seabed.relief.measured else heights


def relief_picture(scene: Scene) -> Bytes:
    """Heights of the bed of a scene as grey levels."""
    ground = build_ground(scene)
    if isinstance(ground, EndlessGround):
        heights = gather_tiles(ground.heights, (0, 0), (SHOWN, SHOWN))[::-1]
    else:
        heights = ground.heights[::-1]
    if heights.shape[1] <= FLAT_CELLS and (heights == heights[:, :1]).all():
        heights = np.tile(heights, (1, 256 // heights.shape[1]))
    low, high = np.nanmin(heights), np.nanmax(heights)
    if high == low:
        return np.zeros(heights.shape, dtype=np.uint8)
    return np.rint(np.nan_to_num((heights - low) / (high - low)) * 255.0).astype(np.uint8)
