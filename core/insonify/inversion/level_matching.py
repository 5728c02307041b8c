"""Material level, gains and vertical beam that give a simulated record the level of a recorded one."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from insonify.inversion.segment_spectra import SoundedBed

# Altitudes between which the level counts: no mirror lobe reaches as far, and long slopes of the bed, which change the
# level by cot θ times their slope, have little effect.
FROM, TO = 1.5, 2.2
KNOTS = 24  # of a table of gains
MOST = 190.0  # dB, of a gain or the level of a beam

Pairs = tuple[tuple[float, float], ...]


def level_difference(recorded: SoundedBed, simulated: SoundedBed) -> float:
    """Level of a recorded bed over a simulated one, in dB: the median from 1.5 to 2.2 altitudes of slant range."""
    altitude, r = float(recorded.altitude.mean()), recorded.slant_range
    near = (r >= min(FROM * altitude, 0.9 * float(r[-1]))) & (r <= TO * altitude)
    return float(np.median(_ratio(recorded, simulated)[near]))


def correct_gains(gains: Pairs, recorded: SoundedBed, simulated: SoundedBed) -> Pairs:
    """Gains in dB by bin, changed until a simulated record has the level of a recorded one at every slant range."""
    ratio = _ratio(recorded, simulated)
    first = int(np.searchsorted(recorded.slant_range, recorded.altitude.min()))
    places = np.unique(np.linspace(min(first, ratio.size - 1), ratio.size - 1, KNOTS).astype(np.int64))
    return _added(gains, places.astype(np.float64), ratio[places])


def correct_beam(levels: Pairs, recorded: SoundedBed, simulated: SoundedBed, passes: int) -> Pairs:
    """One-way levels in dB of a vertical beam by the angle below the horizontal, changed likewise."""
    angles = recorded.level.angles
    own = np.interp(angles, simulated.level.angles, simulated.level.by_angle)
    return _added(levels, angles, (recorded.level.by_angle - own) / passes)


def _added(pairs: Pairs, places: NDArray[np.float64], more: NDArray[np.float64]) -> Pairs:
    """Piecewise linear table plus values at places."""
    levels = np.clip(more + np.interp(places, *np.array(pairs).T), -MOST, MOST)
    return tuple((round(float(place), 4), round(float(level), 3)) for place, level in zip(places, levels))


def _ratio(recorded: SoundedBed, simulated: SoundedBed) -> NDArray[np.float64]:
    """Return the recorded over the simulated level at every slant range, in dB."""
    return recorded.level.by_range - simulated.level.by_range
