"""What is made of Gaussian fields point by point: ripples of a phase, masks of a level."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from insonify.scene.masks.patches import Patchy
from insonify.scene.reliefs.ripples import Ripples

Field = NDArray[np.float64]

FADE = 0.3  # of the rms amplitude, below which crests die down: they end where the phase goes round a point


def shape_ripples(ripples: Ripples, real: Field, imaginary: Field, level: float) -> Field:
    """Heights of ripples from a complex field, whose phase tells crests from troughs.

    Parameters
    ----------
    ripples : Ripples
        Height and shape.
    real, imaginary : float64 arrays
        The field; its phase is 0 on crests.
    level : float
        Its rms amplitude.

    Returns
    -------
    float64 array
        Metres above the mean bed. A sharp profile has crests with a corner, 4 height/wavelength steep, over parabolic
        troughs; a round one is a cosine.
    """
    phase = np.abs(np.arctan2(imaginary, real))
    sharp = 2.0 * (1.0 - phase / math.pi) ** 2 - 2.0 / 3.0  # about its own mean
    profile = np.cos(phase) + ripples.sharpness * (sharp - np.cos(phase))
    amplitude = np.hypot(real, imaginary)
    whole = np.maximum(np.hypot(amplitude, FADE * level), np.finfo(np.float64).tiny)  # a grid of no wave has no crests
    return np.asarray(0.5 * ripples.height * profile * (amplitude / whole))


def mask_share(mask: Patchy, field: Field, threshold: float) -> Field:
    """Share of a relief that a mask lets be.

    Parameters
    ----------
    mask : Patchy
        Softness of the borders.
    field : float64 array
        Smooth field of unit variance.
    threshold : float
        Its value on the borders.

    Returns
    -------
    float64 array
        From 0 outside the patches to 1 inside.
    """
    # The field's rms slope is π/size, so that a border so many sizes wide spans π times that of its values.
    share = np.clip((field - threshold) / (math.pi * mask.softness) + 0.5, 0.0, 1.0)
    return np.asarray(share * share * (3.0 - 2.0 * share))
