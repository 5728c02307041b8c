"""The cell a bin hears: how wide it is along the track, and what of the water and the sea surface lies in it."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from insonify.kernels.beam import vertical_sensitivities
from insonify.kernels.types import EVERY_GRAZING, Problem
from insonify.sound.flat_bed import along_track_width

Curve = NDArray[np.float64]
ELEVATIONS = 1440  # over half a turn


def bin_centres(problem: Problem) -> Curve:
    """Return the true slant range of the bins' centres, (bins,) in metres."""
    return (np.arange(problem.bins, dtype=np.float64) + 0.5) * np.float64(problem.bin_length)


def along_track_angle(problem: Problem) -> Curve:
    """Angle along the track that the beam takes in, by its two-way sensitivity b: ∫ b ds.

    Returns
    -------
    (bins,) float64
        In radians, of the sine s: 2 sin(w/2) for a fan of width w; 1 m / r for a knife, which is 1 m wide at any range.
    """
    if problem.half_width <= 0.0:
        return 1.0 / bin_centres(problem)
    if not problem.pattern.tabled:
        return np.full(problem.bins, 2.0 * np.sin(problem.half_width))
    return _of_rows(problem, problem.pattern.integral[:, -1])


def coherence_angle(problem: Problem) -> Curve:
    """Angle over which the echoes that interfere are spread: (∫ b ds)² / ∫ b² ds, (bins,) in radians."""
    angle = along_track_angle(problem)
    if problem.half_width <= 0.0 or not problem.pattern.tabled:
        return angle
    pattern = problem.pattern
    squares = 2.0 * pattern.extent * np.trapezoid(pattern.energy**2, axis=1) / (pattern.energy.shape[1] - 1)
    return angle**2 / _of_rows(problem, squares)


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
        Underwater Sound, on reverberation). Ψ is the two-way equivalent solid angle of one side, less what lies above
        a flat sea surface or beneath a level bed: about the track as axis a solid angle is the sine along it times the
        angle about it, here from −asin(altitude/r) to asin(depth/r).
    """
    r = bin_centres(problem)
    elevation = np.linspace(-0.5 * math.pi, 0.5 * math.pi, ELEVATIONS + 1)
    heard = _vertical(problem, 0.5 * (elevation[1:] + elevation[:-1]))
    below = np.concatenate([[0.0], np.cumsum(heard)]) * math.pi / ELEVATIONS
    top, bottom = np.arcsin(np.minimum(max(depth, 0.0) / r, 1.0)), -np.arcsin(np.minimum(altitude / r, 1.0))
    about = np.interp(top, elevation, below) - np.interp(bottom, elevation, below)
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
        Area of the part of the ring that the beam takes in, by its sensitivity, times what range takes; 0 nearer than
        the surface.
    """
    height = max(depth, 0.0)
    edges = np.maximum(np.arange(problem.bins + 1) * problem.bin_length, height)
    x = np.sqrt(edges**2 - height**2)
    centre, r = 0.5 * (x[1:] + x[:-1]), np.maximum(0.5 * (edges[1:] + edges[:-1]), 1e-9)
    width = along_track_width(problem, centre, r)
    return width * _vertical(problem, np.arcsin(np.minimum(height / r, 1.0))) * np.diff(x) * problem.range_factor


def _of_rows(problem: Problem, values: NDArray[np.float64]) -> Curve:
    """Interpolate a value of each of the pattern's rows at the bins' slant ranges."""
    pattern = problem.pattern
    place = np.log2(np.maximum(bin_centres(problem) / pattern.first_range, 1.0)) * pattern.per_octave
    return np.interp(np.minimum(place, values.size - 1.0), np.arange(values.size), values)


def _vertical(problem: Problem, elevation: NDArray[np.float64]) -> NDArray[np.float64]:
    """Two-way sensitivity of the vertical beam at elevations above the horizontal."""
    if problem.pattern.vertical == EVERY_GRAZING:
        return np.ones_like(elevation)
    heard = np.empty_like(elevation)
    vertical_sensitivities(problem.pattern, elevation, heard)
    return heard
