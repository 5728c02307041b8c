"""The resolution cell of a bin: its width along the track, and the volume of water and area of sea surface in it."""

import math

import numpy as np

from insonify.acoustics.flat_bed import along_track_width
from insonify.arrays import Floats
from insonify.kernels.beam.pattern import vertical_responses
from insonify.kernels.common.range_bins import mean_over_centre
from insonify.kernels.common.types import EVERY_GRAZING, SceneArrays

ELEVATIONS = 1440  # over half a turn


def bin_centres(arrays: SceneArrays) -> Floats:
    """Return the true slant ranges of the centres of the bins, (bins,) in metres."""
    return (np.arange(arrays.bins, dtype=np.float64) + 0.5) * np.float64(arrays.bin_length)


def along_track_angle(arrays: SceneArrays) -> Floats:
    """Equivalent width of the two-way beam pattern b along the track, ∫ b ds, of every bin."""
    if arrays.half_width <= 0.0:
        return 1.0 / bin_centres(arrays)
    if not arrays.pattern.tabulated:
        return np.full(arrays.bins, 2.0 * np.sin(arrays.half_width))
    return _at_bins(arrays, arrays.pattern.integral[:, -1])


def coherence_angle(arrays: SceneArrays) -> Floats:
    """Equivalent width of the directions that interfere, (∫ b ds)² / ∫ b² ds, (bins,) in radians."""
    angle = along_track_angle(arrays)
    if arrays.half_width <= 0.0 or not arrays.pattern.tabulated:
        return angle
    pattern = arrays.pattern
    squares = 2.0 * pattern.extent * np.trapezoid(pattern.energy**2, axis=1) / (pattern.energy.shape[1] - 1)
    return angle**2 / _at_bins(arrays, squares)


def axial_response(arrays: SceneArrays) -> Floats:
    """Two-way response of the beam along the track on its axis, below 1 in the near field, of every bin."""
    pattern = arrays.pattern
    return (
        _at_bins(arrays, pattern.energy[:, pattern.energy.shape[1] // 2]) if pattern.tabulated else np.ones(arrays.bins)
    )


def volume_echo(arrays: SceneArrays, altitude: float, depth: float) -> Floats:
    """Volume reverberation of one side for a scattering strength of 1 m⁻¹, of every bin."""
    r = bin_centres(arrays)
    elevation = np.linspace(-0.5 * math.pi, 0.5 * math.pi, ELEVATIONS + 1)
    response = vertical_at(arrays, 0.5 * (elevation[1:] + elevation[:-1]))
    below = np.concatenate([[0.0], np.cumsum(response)]) * math.pi / ELEVATIONS
    top, bottom = np.arcsin(np.minimum(max(depth, 0.0) / r, 1.0)), -np.arcsin(np.minimum(altitude / r, 1.0))
    about = np.interp(top, elevation, below) - np.interp(bottom, elevation, below)
    return along_track_angle(arrays) * about * r**2 * arrays.bin_length * _centre_factor(arrays)


def surface_echo(arrays: SceneArrays, depth: float) -> Floats:
    """Surface reverberation of one side for a scattering strength of 1 m² per m², of every bin."""
    height = max(depth, 0.0)
    edges = np.maximum(np.arange(arrays.bins + 1) * arrays.bin_length, height)
    x = np.sqrt((edges - height) * (edges + height))  # never of a negative number, as a difference of squares may be
    centre, r = 0.5 * (x[1:] + x[:-1]), np.maximum(0.5 * (edges[1:] + edges[:-1]), 1e-9)
    width = along_track_width(arrays, centre, r)
    return width * vertical_at(arrays, np.arcsin(np.minimum(height / r, 1.0))) * np.diff(x) * _centre_factor(arrays)


def _centre_factor(arrays: SceneArrays) -> Floats:
    """Spreading and absorption at the centres of the bins."""
    return arrays.range_factor / mean_over_centre(arrays.bins, arrays.range_decay)


def _at_bins(arrays: SceneArrays, values: Floats) -> Floats:
    """Values of the rows of the pattern, interpolated at the slant ranges of the bins."""
    pattern = arrays.pattern
    place = np.log2(np.maximum(bin_centres(arrays) / pattern.first_range, 1.0)) * pattern.per_octave
    return np.interp(np.minimum(place, values.size - 1.0), np.arange(values.size), values)


def vertical_at(arrays: SceneArrays, elevation: Floats) -> Floats:
    """Two-way response of the vertical beam at elevations above the horizontal."""
    if arrays.pattern.vertical == EVERY_GRAZING:
        return np.ones_like(elevation)
    responses = np.empty_like(elevation)
    vertical_responses(arrays.pattern, elevation, responses)
    return responses
