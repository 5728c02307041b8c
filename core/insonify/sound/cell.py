"""The cell a bin hears: how wide it is along the track, and what of the water and the sea surface lies in it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from insonify.kernels.types import Problem
from insonify.sound.flat_bed import along_track_width

Curve = NDArray[np.float64]


def bin_centres(problem: Problem) -> Curve:
    """Return the true slant range of the bins' centres, (bins,) in metres."""
    return (np.arange(problem.bins, dtype=np.float64) + 0.5) * np.float64(problem.bin_length)


def along_track_angle(problem: Problem) -> Curve:
    """Angle along the track that the beam takes in, weighted by its two-way sensitivity.

    Returns
    -------
    (bins,) float64
        In radians, of the sine: 2 sin(w/2) for a fan of width w; 1 m / r for a knife, which is 1 m wide at any range.
    """
    r = bin_centres(problem)
    if problem.half_width <= 0.0:
        return 1.0 / r
    if not problem.pattern.tabled:
        return np.full(problem.bins, 2.0 * np.sin(problem.half_width))
    pattern = problem.pattern
    rows = pattern.extent.size
    place = np.log2(np.maximum(r / pattern.first_range, 1.0)) * pattern.per_octave
    return np.interp(np.minimum(place, rows - 1.0), np.arange(rows), pattern.integral[:, -1])


def volume_echo(problem: Problem, altitude: float, depth: float) -> Curve:
    """Echo of water that scatters 1 m⁻¹, in every bin of one side.

    Parameters
    ----------
    problem : Problem
        Beam, bins and range factors.
    altitude, depth : float
        Height of the sonar above the bed and its depth, in metres.

    Returns
    -------
    (bins,) float64
        Ψ r² Δr times what range takes: with the pulse's taps, S_v + 10 log(Ψ r² cτ/2) (Urick, Principles of
        Underwater Sound, §8.4). Ψ is the two-way equivalent solid angle of one side, less what lies above a flat sea
        surface or beneath a level bed: about the track as axis a solid angle is the sine along it times the angle
        about it, here from −asin(altitude/r) to asin(depth/r).
    """
    r = bin_centres(problem)
    about = np.arcsin(np.minimum(altitude / r, 1.0)) + np.arcsin(np.minimum(max(depth, 0.0) / r, 1.0))
    return along_track_angle(problem) * about * r**2 * problem.bin_length * problem.range_factor


def surface_echo(problem: Problem, depth: float) -> Curve:
    """Echo of a flat sea surface that scatters 1 m² per m², in every bin of one side.

    Parameters
    ----------
    problem : Problem
        Beam, bins and range factors.
    depth : float
        Of the sonar, in metres.

    Returns
    -------
    (bins,) float64
        Area of the part of the ring that the beam takes in, times what range takes; 0 nearer than the surface.
    """
    edges = np.maximum(np.arange(problem.bins + 1) * problem.bin_length, max(depth, 0.0))
    x = np.sqrt(edges**2 - max(depth, 0.0) ** 2)
    centre, r = 0.5 * (x[1:] + x[:-1]), np.maximum(0.5 * (edges[1:] + edges[:-1]), 1e-9)
    return along_track_width(problem.half_width, centre, r) * np.diff(x) * problem.range_factor
