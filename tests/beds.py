"""Small scenes for tests, packed for the kernels straight from arrays."""

import itertools
import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from insonify.kernels.common.range_bins import mean_over_centre
from insonify.kernels.common.types import (
    FRUSTUM,
    NO_DECAY,
    SONAR,
    SPHERE,
    BeamPattern,
    Bed,
    Mesh,
    Poses,
    RangeDecay,
    SceneArrays,
    Solids,
    plain_pattern,
)
from insonify.kernels.geometry.bvh import build_mesh
from insonify.packing.scene_arrays import make_limits

NO_MESH = build_mesh(np.zeros((0, 3, 3)), np.zeros(0, np.int64), np.zeros(0, np.int64))
Sphere = tuple[tuple[float, float, float], float]  # centre, radius
Cylinder = tuple[tuple[float, float, float], tuple[float, float, float], float]  # ends of the axis, radius
Frustum = tuple[tuple[float, float, float], tuple[float, float, float], float, float]  # and the radius of its last end


def bed_of(
    heights: ArrayLike, spacing: float = 1.0, *, x0: float = 0.0, y0: float = 0.0, periodic: bool = False
) -> Bed:
    """Bed of one material from (ny, nx) heights above the datum."""
    z = np.ascontiguousarray(heights, dtype=np.float32)
    finite = z[np.isfinite(z)]
    return Bed(
        heights=z,
        transposed=np.ascontiguousarray(z.T),
        materials=np.zeros(z.shape, dtype=np.uint8),
        x0=float(x0),
        y0=float(y0),
        spacing=float(spacing),
        periodic=periodic,
        low=float(finite.min()) if finite.size else 0.0,
        high=float(finite.max()) if finite.size else 0.0,
    )


def solids_of(bodies: Sequence[Sphere | Cylinder | Frustum] = (), material: int = 0) -> Solids:
    """Spheres (centre, radius), cylinders (end, end, radius) and cones (end, end, radius, radius), a target each."""
    n = len(bodies)
    solids = Solids(
        shape=np.zeros(n, dtype=np.int64),
        start=np.zeros((n, 3)),
        axis=np.zeros((n, 3)),
        length=np.zeros(n),
        radius=np.array([body[min(len(body) - 1, 2)] for body in bodies], dtype=np.float64),
        taper=np.zeros(n),
        material=np.full(n, material, dtype=np.int64),
        target=np.arange(n),
    )
    for k, body in enumerate(bodies):
        solids.shape[k] = SPHERE if len(body) == 2 else FRUSTUM
        solids.start[k] = body[0]
        if len(body) > 2:
            along = np.subtract(body[1], body[0])
            solids.length[k] = np.linalg.norm(along)
            solids.axis[k] = along / solids.length[k]
            solids.taper[k] = (body[-1] - body[2]) / solids.length[k]
    return solids


def mesh_of(vertices: ArrayLike, faces: ArrayLike, *, target: int = 0) -> Mesh:
    """Mesh of the first material from vertices (n, 3) and counter-clockwise faces (m, 3)."""
    corners = np.asarray(vertices, dtype=np.float64)[np.asarray(faces)]
    rows = np.zeros(len(corners), np.int64)
    return build_mesh(corners, rows, rows + target)


# Faces of a box whose corners are in the order of `box_corners`.
BOX_FACES = (
    (0, 1, 3), (0, 3, 2), (4, 6, 7), (4, 7, 5), (0, 4, 5), (0, 5, 1),
    (2, 3, 7), (2, 7, 6), (1, 5, 7), (1, 7, 3), (0, 2, 6), (0, 6, 4),
)  # fmt: skip


def box_corners(low: Sequence[float], high: Sequence[float]) -> np.ndarray:
    """Corners of a box along the axes, (8, 3)."""
    return np.array(list(itertools.product(*zip(low, high))))


def box_mesh(low: Sequence[float], high: Sequence[float], *, target: int = 0) -> Mesh:
    return mesh_of(box_corners(low, high), BOX_FACES, target=target)


def icosphere(halvings: int, radius: float = 1.0, centre: ArrayLike = (0.0, 0.0, 0.0)) -> tuple[np.ndarray, np.ndarray]:
    """Vertices and counter-clockwise faces of an icosahedron whose faces are quartered and pushed out to a sphere."""
    import trimesh  # 1 s, which most tests do without

    ball = trimesh.creation.icosphere(halvings, radius)
    return np.asarray(ball.vertices) + np.asarray(centre), np.asarray(ball.faces)


def tabulated_pattern(extent: ArrayLike, energy: ArrayLike, **fields: Any) -> BeamPattern:
    """Beam of energies (rows, columns), a row per range, at sines evenly spaced within an extent about its centre."""
    extent, energy = np.atleast_1d(np.asarray(extent, float)), np.atleast_2d(np.asarray(energy, float))
    steps = (energy[:, 1:] + energy[:, :-1]) * (extent[:, None] / (energy.shape[1] - 1))
    integral = np.concatenate([np.zeros((len(extent), 1)), np.cumsum(steps, axis=1)], axis=1)
    return plain_pattern()._replace(tabulated=True, extent=extent, energy=energy, integral=integral, **fields)


def gaussian_pattern(
    width: float,
    *,
    squint: float = 0.0,
    vertical_width: float = 0.5,
    two_way: bool = True,
    near_width: float | None = None,
    **vertically: Any,
) -> BeamPattern:
    """Gaussian beam of a one-way -3 dB width in radians; ``near_width`` is its width at 5 m and nearer."""
    widths = [width] if near_width is None else [near_width, 0.5 * (near_width + width), width]
    sines = np.sin(0.5 * np.array(widths))
    energy = 2.0 ** (-(2.0 if two_way else 1.0) * (4.0 * np.linspace(-1.0, 1.0, 401)) ** 2)
    return tabulated_pattern(
        4.0 * sines,
        np.tile(energy, (len(sines), 1)),
        centre=float(np.sin(squint)),
        first_range=5.0,
        s_vertical=float(np.sin(0.5 * vertical_width)),
        two_way=two_way,
        **vertically,
    )


def arrays_of(
    heights: ArrayLike,
    spacing: float = 1.0,
    *,
    solids: Sequence[Sphere | Cylinder | Frustum] = (),
    mesh: Mesh | None = None,
    law: int = SONAR,
    half_width: float = 0.0,
    pattern: BeamPattern | None = None,
    bins: int = 1000,
    bin_length: float = 0.05,
    reflectivity: Sequence[tuple[float, float, float]] = ((1.0, 0.0, 1.0),),
    spreading: bool = False,
    **bed: Any,
) -> SceneArrays:
    """Scene over (ny, nx) heights; everything is of the first material, and the range factor 1 unless spreading."""
    centres = (np.arange(bins) + 0.5) * bin_length
    decay = RangeDecay(4.0, 0.0) if spreading else NO_DECAY
    return SceneArrays(
        bed=bed_of(heights, spacing, **bed),
        solids=solids_of(solids),
        mesh=mesh or NO_MESH,
        reflectivity=np.array(reflectivity, dtype=np.float64),
        interface=np.tile([0.0, 1.0], (len(reflectivity), 1)),
        law=law,
        half_width=half_width,
        pattern=pattern or plain_pattern(),
        limits=make_limits(reflectivity, pattern or plain_pattern(), bin_length),
        bins=bins,
        bin_length=bin_length,
        range_factor=centres**-decay.spreading * mean_over_centre(bins, decay),
        range_decay=decay,
    )


def poses_of(
    x: ArrayLike,
    y: ArrayLike,
    z: ArrayLike,
    heading: ArrayLike = 0.0,
    pitch: ArrayLike = 0.0,
    roll: ArrayLike = 0.0,
) -> Poses:
    """Poses from numbers or arrays that broadcast together; angles in radians."""
    given = (x, y, z, heading, pitch, roll)
    columns = np.broadcast_arrays(*(np.atleast_1d(np.asarray(c, dtype=np.float64)) for c in given))
    return Poses(*(np.ascontiguousarray(column) for column in columns))


def rough(ny: int, nx: int, rms: float = 0.05, seed: int = 1) -> np.ndarray:
    """Periodic rough heights of zero mean with an amplitude spectrum f⁻¹·⁴ and the given rms, (ny, nx)."""
    rng = np.random.default_rng(seed)
    fy, fx = np.fft.fftfreq(ny, 1.0 / ny)[:, None], np.fft.rfftfreq(nx, 1.0 / nx)
    amplitude = np.maximum(np.hypot(fx, fy), 1.0) ** -1.4
    amplitude[0, 0] = 0.0
    heights = np.fft.irfft2(amplitude * np.exp(2j * np.pi * rng.random(amplitude.shape)), s=(ny, nx))
    return np.asarray(heights * (rms / heights.std()))


def pipe_edges(
    gap: float, *, altitude: float = 10.0, offset: float = 30.0, radius: float = 0.5
) -> tuple[float, float, float, float]:
    """Slant ranges of a pipe over a level bed: its near side and tangent, the beginning and end of its shadow."""
    drop = altitude - gap - radius
    distance = math.hypot(offset, drop)
    angle, half = math.atan2(drop, offset), math.asin(radius / distance)
    begins = altitude / math.sin(angle + half) if angle + half < math.pi / 2.0 else altitude
    ends = altitude / math.sin(angle - half) if angle > half else math.inf
    return distance - radius, math.sqrt(distance**2 - radius**2), begins, ends


def rough_arrays(half_width: float = 0.0, **options: Any) -> SceneArrays:
    """Scene over a rough bed that repeats after 25.6 m, heard for 30 m."""
    settings: dict[str, Any] = {"bins": 300, "bin_length": 0.1, "periodic": True, **options}
    return arrays_of(rough(256, 256), 0.1, half_width=half_width, **settings)
