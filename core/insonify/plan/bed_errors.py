"""What a record misses of a rough bed, by the spectrum of its echo, predicted to first order."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray
from scipy import special

from insonify.plan import laws
from insonify.plan.detail import ALONG, AWAY, Detail, detail_of
from insonify.plan.view import View
from insonify.scene.seabed import Seabed
from insonify.sound.straightness import Bending

Field = NDArray[np.float64]
RANGES = 4  # beyond 1.4 altitudes, at which an error is looked at
BEYOND = 1.4


class Echo:
    """Spectrum of a bed's echo, at some ranges beyond 1.4 altitudes; each echo's mean is 1.

    Parameters
    ----------
    view : View
        Heights, ranges, bins and beam.
    detail : Detail
        Waves of the bed.
    """

    def __init__(self, view: View, detail: Detail) -> None:
        near = min(BEYOND * view.altitude, view.reach)
        r = near + (view.reach - near) * (np.arange(RANGES) + 0.5) / RANGES
        x = np.sqrt(np.maximum(r**2 - view.altitude**2, (0.1 * view.altitude) ** 2))
        self._view, self._share = view, r / view.reach
        self._detail, self._bin = detail, (view.bin_length * r / x)[:, None]
        self._cot = (x / view.altitude)[:, None]
        self._width = 2.0 * r[:, None] * np.sin(view.half_width)
        # Lambert's law squares the sine of the grazing angle; of light it is the sine itself.
        self._per_slope = (1.0 if view.light else 4.0) * self._cot**2
        fx, fy = detail.fx, detail.fy
        within = self._per_slope * np.sinc(fx.T * self._bin) ** 2
        # (RANGES, FX, FY): variance of the echo by frequency, before the beam
        self._waves = within[:, :, None] * detail.slopes
        self._shadows = self._of_shadows()
        self._beam = 1.0 / (1.0 + 2.0 * (np.pi * fy * self._width) ** 2)
        along = self._waves.sum(axis=1) + self._of_materials() + self._shadows
        self._square = 1.0 + (along * self._beam).sum(axis=1)
        self._along = along / self._square[:, None]

    def _of_shadows(self) -> Field:
        """Variance of what shadows with sharp edges cut out, by the share of slopes steeper than sound comes."""
        detail = self._detail
        share = 0.5 * special.erfc(1.0 / np.maximum(self._cot * detail.steepness * laws.SHADOWING, 1e-9))
        length = laws.SHADOW_CELLS * detail.spacing
        density = 4.0 * length / (1.0 + (2.0 * np.pi * detail.fy * length) ** 2)
        return np.asarray(share * density * detail.steps * length / (length + self._bin))

    def _of_materials(self) -> Field:
        """Variance of what borders of materials do, which run aslant through bins."""
        return np.asarray(self._detail.materials / (1.0 + (2.0 * self._detail.fy * self._bin) ** 2))

    def of_planes(self, planes: Field) -> Field:
        """Error of so many planes, (n,) shares of the record."""
        worth = laws.WORTH[self._view.beam] * np.asarray(planes, dtype=np.float64)
        count = worth[:, None, None]
        fy, width = self._detail.fy, self._width
        turns = fy * width / count
        mean = 1.0 / np.maximum(np.pi * fy * width, 1e-9)
        # A comb of planes for the mean over the beam: sin(πfW) (1 / K sin(πfW/K) − 1 / πfW), mean square.
        missed = 0.5 * (1.0 / (count * np.sin(np.pi * np.minimum(turns, 0.5))) - mean) ** 2
        missed = np.where(turns < 0.5, np.minimum(missed, 1.0 / count), 1.0 / count)
        return np.asarray(np.hypot(np.sqrt((self._along * missed).sum(axis=2).mean(axis=1)), self._left(planes)))

    def _left(self, planes: Field) -> Field:
        """Error of planes over a bed without detail."""
        count = np.asarray(planes)
        left = laws.LEFT + laws.LEFT_STEEP / self._cot[-1, 0] ** 2 if self._view.beam == "fan" else 0.0
        return np.where(count > 1, np.where(count <= laws.LEFT_UP_TO, left, 0.0), laws.LEFT_BY_ONE)

    def of_thinning(self, every: int) -> float:
        """Error of a bed of every so many nodes, a share of the record."""
        if every == 1:
            return 0.0
        if not self._detail.slopes.any():
            cells = every * self._detail.spacing / self._view.bin_length
            near = laws.LEVEL_NEAR * (every * self._detail.spacing / self._view.altitude) ** 2
            return max(min(laws.LEVEL * cells**laws.LEVEL_ORDER, laws.LEVEL_MOST), near)
        detail = self._detail
        limit = 0.5 / (every * detail.spacing)
        lost = (self._waves * _lost(every)).sum(axis=1)
        # Long cells are flat where the bed bends, which bins as long as they are do not tell.
        bends = self._per_slope * (detail.slopes * _bends(every)).sum(axis=0)
        lost += bends / (1.0 + (2.0 * limit * self._bin) ** 2)
        # What is too fine for the coarse nodes comes back as long waves that neither bin nor beam averages.
        folded = self._per_slope[:, 0] * (detail.heights * _folded(every)).sum() * (2.0 * np.pi * limit) ** 2 / 3.0
        folded /= (1.0 + 2.0 * limit * self._bin[:, 0]) * (1.0 + 2.0 * limit * self._width[:, 0])
        error = ((lost * self._beam).sum(axis=1) + folded) / self._square
        return float(np.sqrt(error.mean()))

    def of_shift(self, bending: Bending) -> float:
        """Error of sound that is taken to go straight: echoes lie elsewhere and are louder or fainter."""
        shift = bending.shift * self._share
        turned = 4.0 * np.sin(np.pi * self._detail.fx.T * shift[:, None]) ** 2
        moved = ((self._waves * turned[:, :, None]).sum(axis=1) * self._beam).sum(axis=1) / self._square
        sharp = (self._along - self._waves.sum(axis=1) / self._square[:, None]) * self._beam
        moved += np.maximum(sharp.sum(axis=1), 0.0) * np.minimum(shift / self._bin[:, 0], 2.0)
        level = bending.level * (self._cot[:, 0] / self._cot[-1, 0]) ** 2
        return float(np.sqrt((moved + level**2).mean()))


@lru_cache(maxsize=16)
def _lost(every: int) -> Field:
    """Share of each wave that coarse nodes lose: all of what is too fine for them, of the rest what they flatten."""
    across, along = np.minimum(ALONG, 0.5), AWAY
    gain = np.sinc(along * every) * np.sinc(across * every) ** 2 / (np.sinc(along) * np.sinc(across) ** 2)
    return np.where(_folded(every), 1.0, (1.0 - gain) ** 2)


@lru_cache(maxsize=16)
def _bends(every: int) -> Field:
    """Mean square by which the slope of coarse cells misses that of each wave that they hold, over its own."""
    bend = np.minimum((np.pi * AWAY * every) ** 2 / 3.0, 1.0) * (1.0 - 1.0 / every**2)
    return np.where(_folded(every), 0.0, bend)


@lru_cache(maxsize=16)
def _folded(every: int) -> NDArray[np.bool_]:
    """Which waves are too fine for coarse nodes."""
    return np.asarray((AWAY * every > 0.5) | (ALONG * every > 0.5))


@lru_cache(maxsize=64)
def echo_of(view: View, seabed: Seabed, heading: float) -> Echo:
    """Return the spectrum of the echo of a bed, kept from plan to plan."""
    return Echo(view, detail_of(seabed, heading))
