"""The bed as an image: colours of its materials, shaded by its slopes, fading into the water."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from insonify.terrain.ground import Ground

FOG = (0.345, 0.570, 0.655)
COLOURS = {
    "silt": (0.47, 0.45, 0.38),
    "fine_sand": (0.83, 0.74, 0.55),
    "medium_sand": (0.80, 0.68, 0.47),
    "coarse_sand": (0.72, 0.58, 0.40),
    "sandy_gravel": (0.60, 0.53, 0.45),
    "cobble": (0.50, 0.48, 0.45),
    "rock": (0.40, 0.39, 0.39),
    "concrete": (0.66, 0.66, 0.64),
    "steel": (0.50, 0.52, 0.55),
}
LAMP = np.array([-0.50, 0.55, 0.67]) / np.linalg.norm([-0.50, 0.55, 0.67])
SLOPE_SHOWN = 0.42
EXAGGERATION = (0.5, 15.0)
FADE = (0.55, 0.98)


def bed_image(ground: Ground, centre: tuple[float, float], half: float, size: int) -> NDArray[np.uint8]:
    """Shade the bed within a window, seen from above.

    Parameters
    ----------
    ground : Ground
        Heights and materials.
    centre : (float, float)
        Middle of the window, in local metres.
    half : float
        Half its side, in metres.
    size : int
        Pixels a side.

    Returns
    -------
    (size, size, 3) uint8
        Row 0 at the far y. Slopes are exaggerated so that faint ripples show.
    """
    offset = (np.arange(size) + 0.5) / size * 2.0 - 1.0
    u, v = np.meshgrid(offset, offset)
    x, y = centre[0] + half * u.ravel(), centre[1] + half * v.ravel()
    z = ground.height_at(x, y).reshape(size, size)
    light = _shade(z, 2.0 * half / size)
    colour = _material_colours(ground, x, y).reshape(size, size, 3) * light[..., None]
    r = np.clip((np.hypot(u, v) - FADE[0]) / (FADE[1] - FADE[0]), 0.0, 1.0)
    fog = (r * r * (3.0 - 2.0 * r))[..., None]
    fog = np.where(np.isnan(z)[..., None], 1.0, fog)
    colour = np.nan_to_num(colour) * (1.0 - fog) + np.array(FOG) * fog
    return np.asarray((np.clip(colour[::-1], 0.0, 1.0) * 255.0).astype(np.uint8))


def _shade(z: NDArray[np.float64], spacing: float) -> NDArray[np.float64]:
    """Light on every pixel, about 1 on the level, with slopes scaled to a visible size."""
    slope_y, slope_x = np.gradient(z, spacing)
    spread = float(np.sqrt(np.nanmean(slope_x**2 + slope_y**2))) if np.isfinite(slope_x).any() else 0.0
    scale = float(np.clip(SLOPE_SHOWN / max(spread, 1e-9), *EXAGGERATION))
    gx, gy = slope_x * scale, slope_y * scale
    toward = (LAMP[2] - LAMP[0] * gx - LAMP[1] * gy) / np.sqrt(1.0 + gx**2 + gy**2)
    return np.asarray(0.30 + 0.70 * np.clip(toward, 0.0, None) / LAMP[2])


def _material_colours(ground: Ground, x: NDArray[np.float64], y: NDArray[np.float64]) -> NDArray[np.float64]:
    """Colour of the material at each place, (n, 3)."""
    ny, nx = ground.materials.shape
    i = np.floor((x - ground.x0) / ground.spacing).astype(np.int64)
    j = np.floor((y - ground.y0) / ground.spacing).astype(np.int64)
    if ground.periodic:
        i, j = i % nx, j % ny
    table = np.array([COLOURS.get(name, COLOURS["medium_sand"]) for name in ground.names])
    return np.asarray(table[ground.materials[np.clip(j, 0, ny - 1), np.clip(i, 0, nx - 1)]])
