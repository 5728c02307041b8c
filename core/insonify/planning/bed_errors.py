"""Predicted errors over a rough bed of sparse planes, coarse nodes and straight rays, by the echo's spectrum."""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray
from scipy import special

from insonify.acoustics.error_range import ERROR_ALTITUDES
from insonify.acoustics.straightness import RefractionEffect
from insonify.planning import fitted_laws
from insonify.planning.plane_sampling import PlaneSampling
from insonify.planning.relief_spectrum import ALONG, AWAY, ReliefSpectrum, compute_relief_spectrum
from insonify.planning.scene_summary import SceneSummary
from insonify.scene.seabed import Seabed

Field = NDArray[np.float64]
RANGES = 4  # slant ranges beyond 1.4 altitudes at which errors are evaluated

EVEN = math.sqrt(
    0.5 * math.pi / math.log(2.0)
)  # (∫ b ds)² / ∫ b² ds of a Gaussian beam b, over its width at half power


class BedEcho:
    """Spectrum of a rough bed's echo at several ranges beyond 1.4 altitudes, for a mean echo of 1.

    Parameters
    ----------
    view : SceneSummary
        Heights, ranges, bins and beam.
    detail : ReliefSpectrum
        Spectra of the bed.
    """

    def __init__(self, view: SceneSummary, detail: ReliefSpectrum) -> None:
        near = min(ERROR_ALTITUDES * view.altitude, view.reach)
        r = near + (view.reach - near) * (np.arange(RANGES) + 0.5) / RANGES
        x = np.sqrt(np.maximum(r**2 - view.altitude**2, (0.1 * view.altitude) ** 2))
        self._view, self._r, self._x, self._share = view, r, x, r / view.reach
        self._detail, self._bin = detail, (view.bin_length * r / x)[:, None]
        self._cot = (x / view.altitude)[:, None]
        # Widths in metres of the main lobe, and of a top-hat that averages as much.
        self._lobe = 2.0 * r * np.sin(view.half_width)
        self._half_power = [view.half_power_at(at) for at in r.tolist()]
        self._width = np.array([w * (EVEN * s or 1.0) for w, s in zip(self._lobe, self._half_power)])[:, None]
        # Backscatter varies as sin²θ of the grazing angle (Lambert), light as sin θ: variance per squared slope.
        self._per_slope = (1.0 if view.light else 4.0) * self._cot**2
        fx, fy = detail.fx, detail.fy
        within = self._per_slope * np.sinc(fx.T * self._bin) ** 2
        # (RANGES, FX, FY): variance of the echo by frequency, before the beam
        self._waves = within[:, :, None] * detail.slopes
        self._shadows = self._of_shadows()
        self._edges = self._of_edges()
        self._beam = 1.0 / (1.0 + 2.0 * (np.pi * fy * self._width) ** 2)
        along = self._waves.sum(axis=1) + self._of_materials() + self._shadows + self._edges
        self._square = 1.0 + (along * self._beam).sum(axis=1)
        self._along = along / self._square[:, None]

    @property
    def square(self) -> float:
        """Mean square of the echo after the beam, over that of its mean."""
        return float(self._square.mean())

    def _of_shadows(self) -> Field:
        """Variance of the echo due to shadows, by the share of slopes steeper than the grazing angle."""
        detail = self._detail
        share = 0.5 * special.erfc(1.0 / np.maximum(self._cot * detail.steepness * fitted_laws.SHADOWING, 1e-9))
        length = fitted_laws.SHADOW_CELLS * detail.spacing
        density = 4.0 * length / (1.0 + (2.0 * np.pi * detail.fy * length) ** 2)
        return np.asarray(share * density * detail.steps * length / (length + self._bin))

    def _of_edges(self) -> Field:
        """Variance of the echo due to slope breaks at cell edges oblique to the track; long bins average it."""
        detail = self._detail
        spread = np.exp(-0.5 * (np.log(detail.fy / detail.edges_along) / fitted_laws.EDGES_SPREAD) ** 2)
        heard = 1.0 / (1.0 + (fitted_laws.EDGES_IN_BINS * detail.edges_away * self._bin) ** 2)
        return np.asarray(self._per_slope * detail.bends.sum() * heard * spread / spread.sum())

    def _of_materials(self) -> Field:
        """Variance of the echo due to borders between materials, which run obliquely through bins."""
        return np.asarray(self._detail.materials / (1.0 + (2.0 * self._detail.fy * self._bin) ** 2))

    def of_planes(self) -> Field:
        """Error for each plane count in ``fitted_laws.COUNTS``, as a share of the record."""
        missed = np.array([self._missed(k) for k in range(RANGES)])
        return np.asarray(np.hypot(np.sqrt(missed.mean(axis=0)), self._left()))

    def _missed(self, k: int) -> Field:
        """Variance of the echo that each plane count fails to sample at one range."""
        worth = fitted_laws.ARRAY_WORTH if self._view.beam == "array" else 1.0
        comb = PlaneSampling(self._detail.fy[0], float(self._lobe[k]), self._half_power[k], worth)
        missed = comb.missed
        if self._view.squint != 0.0:
            # A single plane has one azimuth, whereas the axis of a squinting beam describes a cone.
            beside = 2.0 * np.pi * self._detail.fy[0] * self._view.squint * (self._r[k] - self._x[k])
            missed[0] = 1.0 + comb.mean**2 - 2.0 * comb.mean * np.cos(beside)
        return np.asarray(missed @ self._along[k])

    def _left(self) -> Field:
        """Residual error for each plane count over a steep bed, whose slopes change the width of the footprint."""
        if self._view.beam != "fan":
            return np.zeros(len(fitted_laws.COUNTS))
        count = np.asarray(fitted_laws.COUNTS)
        fading = np.minimum(fitted_laws.LEFT_UP_TO / count, 1.0) ** fitted_laws.LEFT_ORDER
        return np.where(count > 1, fitted_laws.LEFT * self._detail.steepness * fading, 0.0)

    def of_thinning(self, every: int) -> Field:
        """Relative error of keeping every n-th node, for each plane count in ``fitted_laws.COUNTS``."""
        detail = self._detail
        if every == 1:
            return np.zeros(len(fitted_laws.COUNTS))
        if not detail.slopes.any() and not detail.materials.any():
            return np.full(len(fitted_laws.COUNTS), self._of_level_cells(every))
        limit = 0.5 / (every * detail.spacing)
        lost = ((self._waves * _lost(every)).sum(axis=1) * self._beam).sum(axis=1)
        # Long cells flatten the curvature of the bed. Bins as long as a cell average the error, and K planes reduce its
        # variance to 1/K at best.
        bends = self._per_slope * np.where(_folded(every), 0.0, detail.bends).sum(axis=0) * (every**2 - 1.0)
        bends /= 1.0 + (2.0 * limit * self._bin) ** 2
        # Waves above the coarse nodes' Nyquist frequency alias to long waves, which neither bin nor beam averages.
        folded = self._per_slope[:, 0] * (detail.heights * _folded(every)).sum() * (2.0 * np.pi * limit) ** 2 / 3.0
        # The borders of materials alias as well, because they follow the nodes.
        folded += fitted_laws.BORDERS * (detail.materials * (detail.fy > limit)).sum()
        folded /= 1.0 + 2.0 * limit * self._bin[:, 0]
        single = 1.0 / np.asarray(fitted_laws.COUNTS)[:, None, None]
        coarse = (np.maximum(self._beam, single) * bends).sum(axis=2)
        coarse += np.maximum(1.0 / (1.0 + 2.0 * limit * self._width[:, 0]), single[..., 0]) * folded
        return np.asarray(np.sqrt(((lost + coarse) / self._square).mean(axis=1)))

    @property
    def rms_height(self) -> float:
        """Rms height of the bed, in metres."""
        return math.sqrt(float(self._detail.heights.sum()))

    @property
    def steepness(self) -> float:
        """Rms slope of the bed."""
        return self._detail.steepness

    def height_lost(self, every: int) -> float:
        """Rms height that the bed loses when every n-th node is kept, in metres."""
        return math.sqrt(float((self._detail.heights * _lost(every)).sum()))

    def _of_level_cells(self, every: int) -> float:
        """Relative error of keeping every n-th node of a level bed of one material."""
        length = every * self._detail.spacing
        error = min(
            fitted_laws.LEVEL * (length / self._view.bin_length) ** fitted_laws.LEVEL_ORDER, fitted_laws.LEVEL_MOST
        )
        return max(error, fitted_laws.LEVEL_SHADED * (length / self._view.altitude) ** 2 if self._view.shaded else 0.0)

    def of_shift(self, bending: RefractionEffect) -> float:
        """Relative error of straight rays in refracting water: echoes are displaced and change in level."""
        shift = bending.shift * self._share
        turned = 4.0 * np.sin(np.pi * self._detail.fx.T * shift[:, None]) ** 2
        moved = ((self._waves * turned[:, :, None]).sum(axis=1) * self._beam).sum(axis=1) / self._square
        sharp = (self._along - self._waves.sum(axis=1) / self._square[:, None]) * self._beam
        moved += np.maximum(sharp.sum(axis=1), 0.0) * np.minimum(shift / self._bin[:, 0], 2.0)
        level = bending.level * (self._cot[:, 0] / self._cot[-1, 0]) ** 2
        return float(np.sqrt((moved + level**2).mean()))


@lru_cache(maxsize=16)
def _lost(every: int) -> Field:
    """Share of each wave lost with every n-th node: all of it above their Nyquist frequency, the damped part below."""
    across, along = np.minimum(ALONG, 0.5), AWAY
    gain = np.sinc(along * every) * np.sinc(across * every) ** 2 / (np.sinc(along) * np.sinc(across) ** 2)
    return np.where(_folded(every), 1.0, (1.0 - gain) ** 2)


@lru_cache(maxsize=16)
def _folded(every: int) -> NDArray[np.bool_]:
    """Mask of the waves above the Nyquist frequency of every n-th node."""
    return np.asarray((AWAY * every > 0.5) | (ALONG * every > 0.5))


@lru_cache(maxsize=64)
def predict_bed_echo(view: SceneSummary, seabed: Seabed, heading: float) -> BedEcho:
    """Return the spectrum of a bed's echo, cached between plans."""
    return BedEcho(view, compute_relief_spectrum(seabed, heading))
