"""Image of the bed from above: colours of the materials, shaded by the slopes, fading into the water."""

import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFilter

from insonify.arrays import Bytes, Floats, Integers, Reals, Singles
from insonify.display.picture import load_palette
from insonify.optics.light import mixed_colour, shares_of
from insonify.scene import Scene
from insonify.scene.seabed.materials.catalogue import MATERIALS
from insonify_viewer.core_types import Ground

FOG = (0.345, 0.570, 0.655)
LAMP = np.array([-0.50, 0.55, 0.67]) / np.linalg.norm([-0.50, 0.55, 0.67])
LIT = 1.3  # brightness of targets over the bed, so that they stand out
SLOPE_SHOWN = 0.42
EXAGGERATION = (0.5, 15.0)
FADE = (0.55, 0.98)
DARK = 1e-6  # diffuse share below which a material counts as black
SHADE = 0.55  # of the light, kept off by targets
TONES = (0.3, 2.5)  # limits of shown brightness: diffuse share over that of the named material


@dataclass(frozen=True, eq=False)
class BedPatch:
    """Mesh and texture of the bed around the fish."""

    centre: tuple[float, float]  # (float, float) its middle, in local metres
    points: Singles  # (n², 3) nodes of the mesh
    image: Bytes  # (pixels, pixels, 3) shaded colours, row 0 at the far y
    half: float  # half the side of the window, in metres
    depths: tuple[float, float] | None = None  # (float, float) ends of the colours of depths, in metres, if it has them


def target_colours(scene: Scene) -> Bytes:
    """Colours of the targets by their materials, (targets, 3) uint8."""
    colours = np.array([MATERIALS[target.material.name].colour for target in scene.targets]).reshape(-1, 3)
    return np.asarray(255.0 * np.minimum(colours * LIT, 1.0), dtype=np.uint8)


def depth_palette() -> Floats:
    """Colours of depths, (256, 3), from the deepest place of the bed to the shallowest."""
    return load_palette("viridis") / 255.0


def bed_image(
    ground: Ground, centre: tuple[float, float], half: float, size: int, heights: tuple[float, float] | None = None
) -> Bytes:
    """Shade the bed within a window, seen from above, in the colours of its materials or of its depth."""
    # The colours of depths lie between the lowest and the highest of ``heights``.
    offset = ((np.arange(size) + 0.5) / size * 2.0 - 1.0).astype(np.float32)
    x, y = centre[0] + half * offset, centre[1] + half * offset
    z = sample_heights(ground, x, y)
    light = _shade(z, 2.0 * half / size)
    r = np.clip((np.hypot(offset, offset[:, None]) - FADE[0]) / (FADE[1] - FADE[0]), 0.0, 1.0)
    clear = np.where(np.isnan(z), np.float32(0.0), 1.0 - r * r * (3.0 - 2.0 * r))
    light = np.nan_to_num(light) * clear
    if heights is None:
        rows, table = _materials(ground, x, y), _colours(ground)
    else:
        share = np.nan_to_num((z - heights[0]) / max(heights[1] - heights[0], DARK))
        rows, table = (255.0 * np.clip(share, 0.0, 1.0)).astype(np.uint8), depth_palette().astype(np.float32)
    image = np.empty((size, size, 3), dtype=np.uint8)
    for channel in range(3):
        tone = table[:, channel][rows] * light + np.float32(FOG[channel]) * (1.0 - clear)
        image[..., channel] = (np.clip(tone[::-1], 0.0, 1.0) * 255.0).astype(np.uint8)
    return image


def cast_shadows(patch: BedPatch, triangles: Reals) -> BedPatch:
    """Darken the picture of the bed where triangles, (n, 3, 3), keep the lamp off it."""
    size, nodes = len(patch.image), math.isqrt(len(patch.points))

    def places(corners: Reals) -> Reals:
        return (np.asarray(corners[..., :2]) - patch.centre) / (2.0 * patch.half) + 0.5

    at = np.clip((places(triangles) * (nodes - 1)).round().astype(np.int64), 0, nodes - 1)
    over = np.maximum(triangles[..., 2] - patch.points[:, 2].reshape(nodes, nodes)[at[..., 1], at[..., 0]], 0.0)
    flat = triangles[..., :2] - over[..., np.newaxis] * LAMP[:2] / LAMP[2]
    shade = Image.new("L", (size, size))
    draw = ImageDraw.Draw(shade)
    for corners in places(flat) * size:
        draw.polygon([(x, size - y) for x, y in corners.tolist()], fill=255)
    light = 1.0 - SHADE * np.asarray(shade.filter(ImageFilter.GaussianBlur(1.0)), np.float32)[..., np.newaxis] / 255.0
    return replace(patch, image=np.asarray(patch.image * light, np.uint8))


def _colours(ground: Ground) -> Singles:
    """Colours of the rows of the material table, (n, 3): that of the name, lighter or darker by the diffuse share."""
    named = [shares_of(name) for name in ground.names]
    colours = np.array([mixed_colour(shares) for shares in named])
    usual = np.array([sum(share * MATERIALS[name].diffuse for name, share in shares) for shares in named])
    ratio = np.array([row.diffuse for row in ground.reflectivities]) / np.maximum(usual, DARK)
    tone = np.sqrt(np.clip(ratio / max(float(ratio.mean()), DARK), *TONES))
    return np.asarray(colours * tone[:, np.newaxis], dtype=np.float32)


def sample_heights(ground: Ground, x: NDArray[Any], y: NDArray[Any]) -> Singles:
    """Bilinear heights on a grid along the axes."""
    ny, nx = ground.heights.shape
    j, part_y = _nodes(y, ground.y0, ground.spacing, ny, periodic=ground.periodic)
    i, part_x = _nodes(x, ground.x0, ground.spacing, nx, periodic=ground.periodic)
    z = ground.heights
    along = z[:, i] * (1 - part_x) + z[:, (i + 1) % nx] * part_x
    return np.asarray(along[j] * (1 - part_y[:, None]) + along[(j + 1) % ny] * part_y[:, None])


def _nodes(
    place: NDArray[Any], first: float, spacing: float, nodes: int, *, periodic: bool
) -> tuple[Integers, Singles]:
    """Index of the node before each coordinate, and the fraction of the cell after it; NaN outside the grid."""
    u = (np.asarray(place, dtype=np.float64) - first) / spacing
    low = np.floor(u).astype(np.int64)
    part = (u - low).astype(np.float32)
    if periodic:
        return low % nodes, part
    part[(u < 0) | (u >= nodes - 1)] = np.nan
    return np.clip(low, 0, max(nodes - 2, 0)), part


def _shade(z: Singles, spacing: float) -> Singles:
    """Hillshade of every pixel, about 1 on level bed, with slopes scaled to be visible."""
    slope_y, slope_x = np.gradient(z, np.float32(spacing))
    square = slope_x**2 + slope_y**2
    spread = float(np.sqrt(np.nanmean(square))) if np.isfinite(square).any() else 0.0
    scale = np.float32(np.clip(SLOPE_SHOWN / max(spread, 1e-9), *EXAGGERATION))
    lamp = LAMP.astype(np.float32)
    toward = (lamp[2] - scale * (lamp[0] * slope_x + lamp[1] * slope_y)) / np.sqrt(1.0 + scale**2 * square)
    return np.asarray(0.30 + 0.70 / lamp[2] * np.maximum(toward, 0.0), dtype=np.float32)


def _materials(ground: Ground, x: NDArray[Any], y: NDArray[Any]) -> Bytes:
    """Material index at each point of a grid along the axes, (ny, nx)."""
    ny, nx = ground.materials.shape
    j, _ = _nodes(y, ground.y0, ground.spacing, ny, periodic=ground.periodic)
    i, _ = _nodes(x, ground.x0, ground.spacing, nx, periodic=ground.periodic)
    return np.asarray(ground.materials[np.ix_(j, i)])
