"""The bed: how deep, how rough, of what."""

from __future__ import annotations

from typing import Annotated

from pydantic import model_validator

from insonify.scene.base import Declaration, parameter
from insonify.scene.kinds import KindOf
from insonify.scene.materials import AnyMaterialMap, Material
from insonify.scene.reliefs import RELIEFS, ReliefKind
from insonify.scene.reliefs.flat import Flat
from insonify.scene.reliefs.fractal import Fractal
from insonify.scene.reliefs.mimic import Mimic
from insonify.scene.reliefs.random_relief import ExtendableRelief, RandomRelief
from insonify.scene.reliefs.ripples import Ripples
from insonify.scene.reliefs.sum import SumOfReliefs

MOST_CELLS = 16384  # a side, of a made bed
FEWEST_CELLS = 3  # of one ripple
HIGHEST_PEAK = 0.9  # of the Nyquist frequency, on endless ground


class Seabed(Declaration):
    """Mean depth, relief and material of the bed."""

    depth: float = parameter(
        30.0, unit="m", description="depth of the mean bed (a DEM has its own)", gt=0.0, le=11000.0, slider=(5.0, 200.0)
    )
    spacing: float = parameter(
        0.1, unit="m", description="spacing of the relief grid", gt=0.0, le=1e4, slider=(0.05, 1.0), log=True
    )
    relief: Annotated[ReliefKind, KindOf(RELIEFS, default="flat")] = parameter(Flat(), description="shape of the bed")
    material: AnyMaterialMap = parameter(Material(), description="what the bed is made of")

    @model_validator(mode="after")
    def _made_bed_fits_the_grid(self) -> Seabed:
        for part in self.made:
            cells = part.period / self.spacing
            if cells > MOST_CELLS and not part.endless:
                endless = ', or take extent = "endless"' if isinstance(part, ExtendableRelief) else ""
                raise ValueError(
                    f"relief.period {part.period:g} m at spacing {self.spacing:g} m makes {cells:g} cells a side; "
                    f"shorten the period or widen the spacing to stay within {MOST_CELLS}{endless}"
                )
            if isinstance(part, Fractal):
                self._check_peaks(part)
            if isinstance(part, Ripples):
                self._check_wavelength(part)
        return self

    def _check_peaks(self, relief: Fractal) -> None:
        """Refuse peaks that the grid cannot hold."""
        cells = relief.period / self.spacing
        nyquist = HIGHEST_PEAK * cells / 2 if relief.endless else round(cells) / 2
        if any(max(abs(fx), abs(fy)) > 0 and max(abs(fx), abs(fy)) >= nyquist for fx, fy in relief.peaks):
            what = f"{HIGHEST_PEAK:g} of the Nyquist frequency," if relief.endless else "the Nyquist frequency of"
            raise ValueError(
                f"relief.peaks {[list(peak) for peak in relief.peaks]} reach {what} {nyquist:g} "
                f"cycles per period; keep below it or lessen spacing {self.spacing:g} m"
            )

    def _check_wavelength(self, relief: Ripples) -> None:
        """Refuse ripples that the grid or the period cannot hold."""
        if relief.wavelength < FEWEST_CELLS * self.spacing * (1.0 - 1e-9):
            raise ValueError(
                f"relief.wavelength {relief.wavelength:g} m spans fewer than {FEWEST_CELLS} cells of spacing "
                f"{self.spacing:g} m; lengthen it or lessen the spacing"
            )
        if 2.0 * relief.wavelength > relief.period and not relief.endless:
            raise ValueError(
                f"relief.wavelength {relief.wavelength:g} m fits less than twice into period {relief.period:g} m; "
                "shorten it or lengthen the period"
            )

    @property
    def made(self) -> tuple[RandomRelief, ...]:
        """The random reliefs that add up to the bed; none of a bed that is not random."""
        if isinstance(self.relief, SumOfReliefs):
            return self.relief.of
        return (self.relief,) if isinstance(self.relief, RandomRelief) else ()

    @property
    def endless(self) -> bool:
        """Whether the bed never repeats and never ends."""
        return any(part.endless for part in self.made)

    @model_validator(mode="after")
    def _dunes_pass_by_themselves(self) -> Seabed:
        relief = self.relief
        if not isinstance(relief, Mimic):
            return self
        cells = 2.0 * relief.reach / self.spacing
        if cells > MOST_CELLS:
            raise ValueError(
                f"relief.reach {relief.reach:g} m at spacing {self.spacing:g} m makes {cells:g} cells across; "
                f"shorten the reach or widen the spacing to stay within {MOST_CELLS}"
            )
        if len(self.material.materials) > 1:
            raise ValueError('relief "mimic" passes for a map by its shape; give the seabed a single material')
        return self
