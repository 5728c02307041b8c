"""Base of all random reliefs."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal

import numpy as np

from insonify.arrays import Complexes, Floats
from insonify.scene.base import KindOf, metres, parameter
from insonify.scene.seabed.masks import MASKS, PatchMask
from insonify.scene.seabed.reliefs import AddableRelief
from insonify.scene.seabed.reliefs.spectrum import Band, Density, PeriodicWaves

if TYPE_CHECKING:
    from insonify.scene.seabed.materials import MaterialMap

MOST_CELLS = 16384  # along a side of a computed bed


class RandomRelief(AddableRelief):
    """Periodic random relief, with an optional mask.

    A kind declares its spectral density, or computes its heights from random waves in another way.

    Attributes
    ----------
    gaussian : bool
        Whether its waves have Gaussian amplitudes, or only random phases, so that the spectrum is exact.
    instead_of_a_period : str
        Further remedy in the message about a period that is too long.
    """

    gaussian: ClassVar[bool] = True
    instead_of_a_period: ClassVar[str] = ""

    period: float = metres(102.4, "length after which the bed repeats", (12.8, 409.6), most=1e6)
    mask: Annotated[PatchMask | None, KindOf(MASKS, default="patches", optional=True)] = parameter(
        None, "parts of the bed that have the relief; the bed is level elsewhere", rare=True
    )

    @property
    def parts(self) -> tuple[RandomRelief, ...]:
        """The relief itself."""
        return (self,)

    @property
    def endless(self) -> bool:
        """Whether the bed never repeats."""
        return False

    @property
    def given_rms(self) -> float | None:
        """Rms to which the heights are scaled, in metres; None where the density has its own level."""
        return getattr(self, "rms", None)

    def density(self) -> Density:
        """Spectral density of the heights, in m² per (cycle a metre)²; up to a factor if an rms is given."""
        raise NotImplementedError

    def unscaled(self, waves: PeriodicWaves) -> Floats:
        """Heights of one period before they are scaled to their rms: waves of the spectral density."""
        return waves.field(density_waves(self.density(), self.period, waves, gaussian=self.gaussian))

    def heights(self, waves: PeriodicWaves, reference: PeriodicWaves) -> Floats:
        """Heights of one period, without the mask.

        Parameters
        ----------
        waves : PeriodicWaves
            Waves on the grid of the heights.
        reference : PeriodicWaves
            Waves on the grid on which the rms is exact; the same object if the grids are the same.

        Returns
        -------
        (ny, nx) float64
            Metres above the mean bed.
        """
        heights = self.unscaled(waves)
        if self.given_rms is None:
            return heights
        scaled = heights if reference is waves else self.unscaled(reference)
        power = float(np.mean(scaled**2))
        return heights * (self.given_rms / math.sqrt(power)) if power > 0.0 else heights

    def check(self, spacing: float, material: MaterialMap) -> None:
        """Check the number of cells of a period."""
        cells = self.period / spacing
        if cells > MOST_CELLS and not self.endless:
            raise ValueError(
                f"relief.period {self.period:g} m at spacing {spacing:g} m makes {cells:g} cells a side; "
                f"shorten the period or widen the spacing to stay within {MOST_CELLS}{self.instead_of_a_period}"
            )


class ExtendableRelief(RandomRelief):
    """Random relief that can also be endless, without a period.

    A kind adds the bands of its spectrum, and `shape_waves` if its heights are not a Gaussian field.

    Attributes
    ----------
    shaped : bool
        Whether `shape_waves` computes the heights from complex waves.
    levels_off : bool
        Whether the spectrum of endless ground levels off at waves as long as the period.
    """

    shaped: ClassVar[bool] = False
    levels_off: ClassVar[bool] = False
    instead_of_a_period = ', or take extent = "endless"'

    extent: Literal["periodic", "endless"] = parameter(
        "periodic",
        "whether the bed repeats after its period or is endless, without waves longer than the period",
        rare=True,
    )

    @property
    def endless(self) -> bool:
        """Whether the bed never repeats."""
        return self.extent == "endless"

    @property
    def idle_fields(self) -> frozenset[str]:
        """Names of the fields without effect: the period of endless ground, unless the spectrum levels off there."""
        without_period = self.endless and not self.levels_off
        return super().idle_fields | ({"period"} if without_period else frozenset())

    def bands(self) -> tuple[Band, ...]:
        """Bands of the spectrum of endless ground, or of the waves that `shape_waves` takes."""
        raise NotImplementedError

    def shape_waves(self, real: Floats, imaginary: Floats, level: float) -> Floats:
        """Heights from a field, its Hilbert transform (a quarter of a wave on), and their rms amplitude."""
        raise NotImplementedError


def density_waves(density: Density, period: float, waves: PeriodicWaves, *, gaussian: bool = True) -> Complexes:
    """Waves of a spectral density; each has the variance within half a cycle per period of it."""
    return waves.filtered(lambda fx, fy: np.sqrt(density(fx / period, fy / period)) / period, gaussian=gaussian)


def rms_height(default: float = 0.05) -> Any:
    """Declare the rms of a relief's heights."""
    return metres(
        default,
        "rms height over a period (expected rms of endless ground), before any mask",
        (0.001, 1.0),
        least=0.0,
        most=1e4,
    )
