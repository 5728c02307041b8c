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
