"""Small scenes for tests, packed for the kernels straight from arrays."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from insonify.kernels.types import FRUSTUM, SONAR, SPHERE, Bed, Poses, Problem, Solids, empty_mesh, plain_pattern

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


def problem_of(
    heights: ArrayLike,
    spacing: float = 1.0,
    *,
    x0: float = 0.0,
    y0: float = 0.0,
    periodic: bool = False,
    solids: Sequence[Sphere | Cylinder | Frustum] = (),
    law: int = SONAR,
    half_width: float = 0.0,
    bins: int = 1000,
    bin_length: float = 0.05,
    reflectivity: Sequence[tuple[float, float, float]] = ((1.0, 0.0, 1.0),),
    spreading: bool = False,
) -> Problem:
    """Problem over (ny, nx) heights; everything is of the first material, and the range factor 1 unless spreading."""
    centres = (np.arange(bins) + 0.5) * bin_length
    return Problem(
        bed=bed_of(heights, spacing, x0=x0, y0=y0, periodic=periodic),
        solids=solids_of(solids),
        mesh=empty_mesh(),
        reflectivity=np.array(reflectivity, dtype=np.float64),
        interface=np.tile([0.0, 1.0], (len(reflectivity), 1)),
        law=law,
        half_width=half_width,
        pattern=plain_pattern(),
        bins=bins,
        bin_length=bin_length,
        range_factor=centres**-4.0 if spreading else np.ones(bins),
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
