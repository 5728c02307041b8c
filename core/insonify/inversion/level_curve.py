"""Level of a record by slant range and by grazing angle, without Lambert's law."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from insonify.display.normalisation import estimate_median_curve

Field = NDArray[np.float64]
RISE = 1.5  # highest over lowest altitude from which range and angle can be told apart
BLOCK = (16, 4)  # pings and bins whose median counts
RANGE_KNOTS, ANGLE_KNOTS = 24, 20
RIDGE = 0.3  # blocks that speak for no effect of the angle, at every knot
ROUNDS, SPREAD = 12, 1.0  # of reweighting, and the residual in dB from which blocks count less: targets, shadows
STEEPEST = 85.0  # degrees


class LevelCurve(NamedTuple):
    """Level of a record, in dB: that of its range plus that of its grazing angle, besides Lambert's sin² θ."""

    by_range: Field  # (bins,) gain, spreading, absorption and material
    # (n,) vertical beam and the bed's own law of scattering, by the grazing angle in degrees; zero throughout for
    # a level track, where angle and range are one.
    angles: Field
    by_angle: Field

    def intensity(self, altitude: Field, slant_range: Field) -> Field:
        """Intensity of the bed under every ping, (pings, bins)."""
        sine = _sine(altitude, slant_range)
        level = self.by_range + np.interp(np.degrees(np.arcsin(sine)), self.angles, self.by_angle)
        return np.asarray(10.0 ** (level / 10.0) * sine**2)


def fit_level_curve(
    intensity: NDArray[np.float32], altitude: Field, bin_length: float, *, separate: bool
) -> LevelCurve:
    """Fit the level of a record: its median at every slant range, and what follows the grazing angle instead."""
    r = np.asarray((np.arange(intensity.shape[2]) + 0.5) * bin_length)
    lowest = int(np.argmin(altitude))
    median = estimate_median_curve(intensity, altitude, bin_length)[lowest, 0]
    upright = median / _sine(altitude[[lowest]], r)[0] ** 2
    plain = LevelCurve(10.0 * np.log10(np.maximum(upright, 1e-300)), np.array([0.0, 90.0]), np.zeros(2))
    if not separate or altitude.max() < RISE * altitude.min():
        return plain
    return _separate(intensity, altitude, r, plain)


def _separate(intensity: NDArray[np.float32], altitude: Field, r: Field, plain: LevelCurve) -> LevelCurve:
    """Separate the effects of range and angle in the medians of blocks, by robust least squares."""
    relative = np.mean(intensity, axis=0, dtype=np.float64) / plain.intensity(altitude, r)
    angle = np.degrees(np.arcsin(_sine(altitude, r)))
    blocks, angles = _blocks(relative), np.mean(_blocks(angle), axis=-1)
    ranges = np.broadcast_to(np.mean(_blocks(np.broadcast_to(r, angle.shape)), axis=-1), angles.shape)
    level = 10.0 * np.log10(np.maximum(np.median(blocks, axis=-1), 1e-30))
    bed = (np.max(_blocks(angle), axis=-1) < STEEPEST) & (level > -100.0)
    far = np.linspace(r[0], r[-1], RANGE_KNOTS)
    steep = np.linspace(angles[bed].min(), angles[bed].max(), ANGLE_KNOTS)
    design = np.hstack([_hats(ranges[bed], far), _hats(angles[bed], steep)])
    found = _solve(design, level[bed])
    by_angle = found[RANGE_KNOTS:] - found[RANGE_KNOTS:].mean()
    by_range = np.interp(r, far, found[:RANGE_KNOTS]) + found[RANGE_KNOTS:].mean()
    return LevelCurve(plain.by_range + by_range, steep, by_angle)


def _solve(design: Field, level: Field) -> Field:
    """Least absolute deviations by reweighting, with a weak pull of all effects to zero."""
    pull = RIDGE * np.eye(design.shape[1])
    weight = np.ones(level.size)
    few = csr_array(design)  # at most four knots of 44 count for a block
    for _ in range(ROUNDS):
        weighted = few.T.multiply(weight)
        found = np.linalg.solve((weighted @ few).toarray() + pull, weighted @ level)
        weight = 1.0 / np.maximum(np.abs(level - few @ found), SPREAD)
    return np.asarray(found)


def _hats(values: Field, knots: Field) -> Field:
    """Weights of the knots at values between them, (values, knots)."""
    return np.stack([np.interp(values, knots, one) for one in np.eye(knots.size)], axis=1)


def _blocks(values: Field) -> Field:
    """Cut a field into blocks, (rows, columns, samples)."""
    rows, columns = (size // step for size, step in zip(values.shape, BLOCK))
    cut = values[: rows * BLOCK[0], : columns * BLOCK[1]].reshape(rows, BLOCK[0], columns, BLOCK[1])
    return cut.swapaxes(1, 2).reshape(rows, columns, -1)


def _sine(altitude: Field, slant_range: Field) -> Field:
    """Sine of the grazing angle, (pings, bins), 1 above the bed."""
    return np.asarray(np.minimum(altitude[:, None] / slant_range, 1.0))
