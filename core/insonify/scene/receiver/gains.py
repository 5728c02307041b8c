"""Time-varied gains."""

from functools import partial
from typing import Annotated, ClassVar, Literal, NamedTuple

import numpy as np
from pydantic import AfterValidator, Field

from insonify.arrays import Floats
from insonify.scene.base import Family, Kind, check_increasing, decibels, parameter
from insonify.scene.water.absorptions import NEPER_PER_DB

GAINS = Family("gains", "insonify.scene.receiver")
TimeOrBin = Annotated[float, Field(ge=0.0, le=1e6)]
Gain = Annotated[float, Field(ge=-300.0, le=300.0)]
IN_ORDER = AfterValidator(partial(check_increasing, "time or bin"))


class RangeBins(NamedTuple):
    """Range bins to be amplified."""

    number: Floats  # from 0
    slant_range: Floats  # m, of the centres
    travel_time: Floats  # s, to the centres and back


class GainKind(Kind):
    """Time-varied gain.

    Attributes
    ----------
    stops_at_noise : bool
        Whether the gain stays constant beyond the last bin in which a level bed of albedo 1 exceeds the noise.
    """

    family = GAINS
    stops_at_noise: ClassVar[bool] = True

    def decibels(self, bins: RangeBins, absorption: float) -> Floats:
        """Gain in dB of range bins, in water of that absorption (Np/m)."""
        return np.zeros(bins.number.shape)


class NoTvg(GainKind, kind="none", rank=10):
    """No gain: echoes as loud as they arrive."""


class PowerTvg(GainKind, kind="power", rank=20):
    """Time-varied gain by a power of range and by absorption: spreading · log r + 2αr, clipped at the noise floor."""

    spreading: float = decibels(
        30.0, "gain per tenfold slant range: 40 for points, 30 for beds, 20 for volumes", (0.0, 80.0), (0.0, 60.0)
    )
    absorption: float | None = parameter(
        None,
        "absorption to compensate on the way there and back (the water's own when left out)",
        "dB/km",
        ge=0.0,
        le=1e4,
        slider=(0.0, 400.0),
    )

    def decibels(self, bins: RangeBins, absorption: float) -> Floats:
        """Gain in dB, spreading · log₁₀ r + 2αr with α in dB/m."""
        loss = absorption if self.absorption is None else self.absorption * NEPER_PER_DB / 1e3
        return self.spreading * np.log10(bins.slant_range) + 2.0 * loss / NEPER_PER_DB * bins.slant_range


class TableTvg(GainKind, kind="table", rank=30):
    """Time-varied gain by a table, as in a recorder's file or of a gain curve; it also amplifies noise."""

    stops_at_noise = False
    by: Literal["time", "bin"] = parameter(
        "time", "first column of the table: seconds after transmission, or bins from 0"
    )
    gains: Annotated[tuple[tuple[TimeOrBin, Gain], ...], IN_ORDER] = parameter(
        ((0.0, 0.0), (0.02, 30.0), (0.06, 50.0)),
        "pairs [time or bin, gain], ascending; the first and last gains apply beyond",
        "dB",
        slider=(-20.0, 80.0),
        min_length=1,
        max_length=100_000,
    )
    interpolation: Literal["linear", "steps"] = parameter(
        "linear", "straight lines between those gains, or each gain kept until the next"
    )

    def decibels(self, bins: RangeBins, absorption: float) -> Floats:
        """Gain in dB of the table."""
        at = bins.travel_time if self.by == "time" else bins.number
        places, gains = np.array(self.gains).T
        if self.interpolation == "linear":
            return np.interp(at, places, gains)
        return np.asarray(gains[np.maximum(np.searchsorted(places, at, side="right") - 1, 0)])
