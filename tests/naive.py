"""Slow, obvious twins of the kernels: plain Python and NumPy, dense sampling instead of geometry."""

import math
from collections.abc import Sequence

import numpy as np
from scipy import ndimage

from brute_force import bodies_of, strength
from insonify.kernels.common.types import BED, LIGHT, PORT, SPHERE, Bed, SceneArrays, Solids

NOTHING = -2


def heights(bed: Bed, x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Bilinear heights above the datum, NaN where there is no bed."""
    places = [np.subtract(y, bed.y0) / bed.spacing, np.subtract(x, bed.x0) / bed.spacing]
    mode = "grid-wrap" if bed.periodic else "constant"
    return ndimage.map_coordinates(bed.heights.astype(float), places, order=1, mode=mode, cval=np.nan)


def height(bed: Bed, x: float, y: float) -> float:
    """Likewise at one place."""
    return float(heights(bed, np.array([x]), np.array([y]))[0])


def gradients(bed: Bed, x: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Gradient of the bed, by differences well inside a cell."""
    h = 1e-5 * bed.spacing
    return (
        (heights(bed, x + h, y) - heights(bed, x - h, y)) / (2 * h),
        (heights(bed, x, y + h) - heights(bed, x, y - h)) / (2 * h),
    )


def body_depth(solids: Solids, k: int, point: np.ndarray) -> np.ndarray:
    """Distance from a body's surface, negative inside; points are (..., 3)."""
    offset = point - solids.start[k]
    if solids.shape[k] == SPHERE:
        return np.linalg.norm(offset, axis=-1) - solids.radius[k]
    along = offset @ solids.axis[k]
    radius = solids.radius[k] + solids.taper[k] * along
    across = np.linalg.norm(offset - along[..., None] * solids.axis[k], axis=-1) - radius
    return np.maximum(across, np.maximum(-along, along - solids.length[k]))


def cast(arrays: SceneArrays, origin: Sequence[float], direction: Sequence[float], step: float) -> tuple[float, int]:
    """First hit of one ray on bed and solids, by tiny steps and bisection: (distance, target, BED or NOTHING)."""
    o, d = np.asarray(origin, dtype=float), np.asarray(direction, dtype=float)
    d = d / np.linalg.norm(d)
    reach = arrays.bins * arrays.bin_length
    t = np.arange(0.0, reach + step, step)
    met = inside(arrays, o + t[:, None] * d) != NOTHING
    first = int(np.argmax(met))
    if first == 0:  # from inside, or nowhere
        return math.inf, NOTHING
    near, far = t[first - 1], t[first]
    while far - near > 1e-13 * max(1.0, far):
        middle = 0.5 * (near + far)
        if middle in (near, far):
            break
        near, far = (near, middle) if inside(arrays, (o + middle * d)[None])[0] != NOTHING else (middle, far)
    return (float(far), int(inside(arrays, (o + far * d)[None])[0])) if far <= reach else (math.inf, NOTHING)


def inside(arrays: SceneArrays, points: np.ndarray) -> np.ndarray:
    """What points (n, 3) lie in: a target, BED or NOTHING."""
    what = np.full(len(points), NOTHING)
    for k in range(arrays.solids.shape.size):
        first = (what == NOTHING) & (body_depth(arrays.solids, k, points) <= 0)
        what[first] = arrays.solids.target[k]
    what[points[:, 2] <= heights(arrays.bed, points[:, 0], points[:, 1])] = BED
    return what


def plane_samples(
    arrays: SceneArrays, pose: tuple[float, float, float], ex: float, ey: float, samples_per_cell: int
) -> dict[str, np.ndarray]:
    """Everything heard in one vertical half-plane: short pieces of bed and bodies.

    Returns columns: ground range x, slant range r, length on the plane seen along the ray (r dθ), cosine of the
    incidence, change of slant range over the piece, material.
    """
    px, py, pz = pose
    reach = arrays.bins * arrays.bin_length
    n = math.ceil(reach / arrays.bed.spacing * samples_per_cell)
    edges = np.arange(n + 1) * (reach / n)
    # Heights above the sonar of the pieces' ends and middles.
    z = heights(arrays.bed, px + edges * ex, py + edges * ey) - pz
    x = 0.5 * (edges[1:] + edges[:-1])
    gx, gy = gradients(arrays.bed, px + x * ex, py + x * ey)
    area = np.sqrt(1 + gx**2 + gy**2)
    dx, dz = np.diff(edges), np.diff(z)
    zm = 0.5 * (z[1:] + z[:-1])
    r = np.hypot(x, zm)
    cos_incidence = ((gx * ex + gy * ey) * x - zm) / (r * area)
    slope = np.where(np.isnan(zm), -np.inf, zm / x)
    horizon = np.maximum.accumulate(np.concatenate([[-np.inf], slope[:-1]]))
    heard = np.isfinite(zm) & (slope > horizon)
    hits = _bodies_in_plane(arrays, pose, ex, ey)
    angle = np.arctan2(zm, x)
    if hits is not None:
        blocked = np.interp(angle, hits["angle"], hits["r"], left=np.inf, right=np.inf)
        heard &= ~(blocked < r)
    columns = {
        "x": x, "r": r, "seen": np.abs(x * dz - zm * dx) / r, "cos": cos_incidence,
        "dr": np.abs(np.hypot(edges[1:], z[1:]) - np.hypot(edges[:-1], z[:-1])),
        "material": _materials(arrays.bed, px + x * ex, py + x * ey),
    }  # fmt: skip
    out = {name: column[heard] for name, column in columns.items()}
    if hits is None:
        return out
    # A body is heard where the bed's horizon up to there is lower.
    before = np.clip(np.searchsorted(x, hits["x"]) - 1, -1, None)
    running = np.maximum.accumulate(slope)
    ridge = np.where(before < 0, -np.inf, running[before])
    clear = np.isfinite(hits["r"]) & (np.tan(hits["angle"]) > ridge)
    return {name: np.concatenate([out[name], hits[name][clear]]) for name in out}


def _materials(bed: Bed, x: np.ndarray, y: np.ndarray) -> np.ndarray:
    ny, nx = bed.heights.shape
    i, j = np.floor((x - bed.x0) / bed.spacing).astype(int), np.floor((y - bed.y0) / bed.spacing).astype(int)
    return bed.materials[j % ny, i % nx].astype(int)


def _bodies_in_plane(
    arrays: SceneArrays, pose: tuple[float, float, float], ex: float, ey: float, angles: int = 20001
) -> dict[str, np.ndarray] | None:
    """Nearest body along a fine fan of launch angles, from the equations of sphere and cylinder."""
    origin, bodies = np.asarray(pose), bodies_of(arrays)
    if not bodies:
        return None
    angle = np.linspace(-np.pi / 2, np.pi / 2, angles)
    direction = np.column_stack([np.cos(angle) * ex, np.cos(angle) * ey, np.sin(angle)])
    # Concentrate the fan on what there is to see.
    coarse = np.min([meet(origin, direction)[0] for meet in bodies], axis=0)
    seen = np.flatnonzero(np.isfinite(coarse))
    if seen.size == 0:
        return None
    angle = np.linspace(angle[max(seen[0] - 1, 0)], angle[min(seen[-1] + 1, angles - 1)], angles)
    direction = np.column_stack([np.cos(angle) * ex, np.cos(angle) * ey, np.sin(angle)])
    every = [meet(origin, direction) for meet in bodies]
    nearest = np.argmin([hit[0] for hit in every], axis=0)
    pick = np.arange(angles)
    r = np.array([hit[0] for hit in every])[nearest, pick]
    cos_incidence = np.array([hit[1] for hit in every])[nearest, pick]
    step = angle[1] - angle[0]
    with np.errstate(invalid="ignore"):
        seen_length, dr = r * step, np.abs(np.gradient(np.where(np.isfinite(r), r, np.nan)))
    dr = np.where(np.isnan(dr), 0.0, dr)
    materials = np.concatenate([arrays.solids.material, arrays.mesh.material])
    return {
        "angle": angle, "x": np.where(np.isfinite(r), r, 0.0) * np.cos(angle), "r": r, "seen": seen_length,
        "cos": cos_incidence, "dr": dr, "material": materials[nearest],
    }  # fmt: skip


def range_factor(arrays: SceneArrays, r: np.ndarray) -> np.ndarray:
    """Spreading and absorption at slant ranges."""
    return r**-arrays.range_decay.spreading * np.exp(-arrays.range_decay.loss * r / arrays.bin_length)


def naive_ping(
    arrays: SceneArrays,
    pose_x: float,
    pose_y: float,
    pose_z: float,
    heading: float,
    *,
    samples_per_cell: int = 200,
    azimuths: Sequence[float] = (0.0,),
) -> np.ndarray:
    """One ping by brute force, (2, bins).

    ``azimuths`` are the middles of equal wedges about athwart (radians, positive towards the bow). A knife is the one
    at 0; for a fan give many, spread evenly over (-π/2, π/2): what is outside the cone |cos θ sin φ| <= sin(w/2)
    counts nothing, so that they need to be fine against the beam.
    """
    out = np.zeros((2, arrays.bins))
    fan = arrays.half_width > 0.0
    wedge = math.pi / len(azimuths) if len(azimuths) < 2 else azimuths[1] - azimuths[0]
    for side in (0, 1):
        for azimuth in azimuths:
            turned = heading + (math.pi / 2 - azimuth if side == PORT else azimuth - math.pi / 2)
            ex, ey = (0.0 if abs(c) < 1e-12 else c for c in (math.cos(turned), math.sin(turned)))
            s = plane_samples(arrays, (pose_x, pose_y, pose_z), ex, ey, samples_per_cell)
            share = _share_of_beam(arrays, s, azimuth, wedge) if fan else np.ones_like(s["x"])
            out[side] += _deposit(arrays, s, share, wedge if fan else 0.0)
    return out


def _share_of_beam(arrays: SceneArrays, s: dict[str, np.ndarray], azimuth: float, wedge: float) -> np.ndarray:
    """How much of a wedge of azimuths is inside the cone, sample by sample."""
    widest = np.arcsin(np.minimum(math.sin(arrays.half_width) * s["r"] / np.maximum(s["x"], 1e-300), 1.0))
    low, high = abs(azimuth) - wedge / 2, abs(azimuth) + wedge / 2
    return np.clip((widest - low) / (high - low), 0.0, 1.0)


def _deposit(arrays: SceneArrays, s: dict[str, np.ndarray], share: np.ndarray, wedge: float) -> np.ndarray:
    value = np.zeros_like(s["x"])
    for m, numbers in enumerate(arrays.reflectivity):
        value = np.where(s["material"] == m, strength(np.maximum(s["cos"], 0.0), tuple(numbers), arrays.law), value)
    if arrays.law == LIGHT:
        energy = value * s["dr"] / arrays.bin_length
        if wedge:
            s_beam = math.sin(arrays.half_width)
            energy *= wedge / (2 * np.arcsin(np.minimum(s_beam * s["r"] / np.maximum(s["x"], 1e-300), 1.0)))
    else:
        width = s["x"] * wedge if wedge else 1.0
        energy = value * s["seen"] * width / np.maximum(s["cos"], 1e-9)
    energy *= range_factor(arrays, s["r"])
    k = np.floor(s["r"] / arrays.bin_length).astype(int)
    ok = (k < arrays.bins) & (s["cos"] > 0)
    return np.bincount(k[ok], weights=(energy * share)[ok], minlength=arrays.bins)
