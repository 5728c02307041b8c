"""Receivers over a level bed, as declared by the default scene but for some fields, and moments of what they record."""

import math
from typing import Any

import numpy as np

from beds import arrays_of
from insonify.receiver import Reception, receive
from insonify.receiver.reception import assemble
from insonify.receiver.stage import ReceiverSetup
from insonify.scene import Scene, edit, load_scene

RAYLEIGH = math.sqrt(4.0 / math.pi - 1.0)  # variation of Rayleigh amplitudes


def scene_with(name: str = "default", /, **changes: Any) -> Scene:
    """A bundled scene with changes: two underscores in a name stand for a dot."""
    return edit(load_scene(name), {path.replace("__", "."): value for path, value in changes.items()})


def reception(
    bins: int,
    bin_length: float = 0.05,
    *,
    altitude: float = 10.0,
    depth: float = 20.0,
    half_width: float = 0.0,
    spreading: bool = False,
    **changes: Any,
) -> Reception:
    arrays = arrays_of(np.zeros((4, 4)), bins=bins, bin_length=bin_length, half_width=half_width, spreading=spreading)
    return assemble(ReceiverSetup(scene_with(**changes), arrays, altitude, depth))


def received(traced: np.ndarray, bin_length: float = 0.05, **settings: Any) -> np.ndarray:
    """Record of traced echoes, from ping 0 on."""
    return receive(reception(traced.shape[2], bin_length, **settings), traced, np.arange(len(traced)))


def decibels(ratio: Any) -> Any:
    return 10.0 * np.log10(ratio)


def variation(energy: np.ndarray) -> float:
    """Standard deviation of amplitudes over their mean."""
    amplitude = np.sqrt(energy.astype(float))
    return float(amplitude.std() / amplitude.mean())


def correlation(energy: np.ndarray, lag: int, axis: int) -> float:
    """Correlation of energies of mean 1 so many samples apart."""
    centred = np.moveaxis(energy - 1.0, axis, 0)
    return float((centred[lag:] * centred[: len(centred) - lag]).mean() / (centred**2).mean())


def field_correlation(
    wavelength: float, length: float, taper: str, ways: int, r: float, lags: np.ndarray
) -> np.ndarray:
    """Correlation of the waves of a line of scatterers at r by exact distances from every element of an array."""
    place = (np.arange(600) + 0.5) / 600.0 - 0.5
    shapes = {
        "uniform": np.ones(600),
        "cosine": np.cos(np.pi * place),
        "hamming": 0.54 + 0.46 * np.cos(2 * np.pi * place),
    }
    step, reach = min(0.002, wavelength * r / 16.0 / length), max(2.0 * length, 10.0 * wavelength * r / length)
    x, wave_number = np.arange(-reach, reach, step), 2.0 * math.pi / wavelength
    away = np.exp(1j * wave_number * (np.hypot(r, x) - r))
    field = sum(w * np.exp(1j * wave_number * (np.hypot(r, x - u * length) - r)) for u, w in zip(place, shapes[taper]))
    density = np.abs(np.fft.fft(field * (field if ways == 2 else away), 4 * x.size)) ** 2
    found = np.fft.ifft(density)[: x.size]
    return np.asarray(np.interp(lags, step * np.arange(x.size), np.abs(found / found[0])))
