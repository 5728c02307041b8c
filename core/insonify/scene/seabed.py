"""The bed: how deep, how rough, of what."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import Discriminator, Tag, field_validator, model_validator

from insonify.scene.base import Choice, Declaration, kind_of, parameter
from insonify.scene.materials import Material, MaterialMap, PatternMap

Peak = tuple[float, float]
MOST_CELLS = 16384  # a side, of a made bed


class Flat(Choice):
    """A level bed without relief."""

    kind: Literal["flat"] = "flat"


class Fractal(Choice):
    """Filtered noise with spectral peaks: Models 1 to 3 of the paper."""

    kind: Literal["fractal"] = "fractal"
    beta: float | None = parameter(
        None,
        description="amplitude exponent of the spectrum; larger is smoother (1.4 if left out)",
        ge=0.0,
        lt=5.0,
        slider=(0.0, 3.0),
    )
    beta_x: float | None = parameter(
        None, description="exponent along the first axis (Model 3)", ge=0.0, lt=5.0, slider=(0.0, 3.0)
    )
    beta_y: float | None = parameter(
        None, description="exponent along the second axis (Model 3)", ge=0.0, lt=5.0, slider=(0.0, 3.0)
    )
    peaks: tuple[Peak, ...] = parameter(
        ((0.0, 0.0),),
        unit="cycles/period",
        description="spectral peaks [fx, fy]",
        min_length=1,
        max_length=16,
        slider=(-64.0, 64.0),
    )
    period: float = parameter(
        102.4,
        unit="m",
        description="length after which the bed repeats",
        gt=0.0,
        le=1e6,
        slider=(12.8, 409.6),
        log=True,
    )
    rms: float = parameter(
        0.05, unit="m", description="rms height over a period", ge=0.0, le=1e4, slider=(0.001, 1.0), log=True
    )
    quadrants: Literal[1, 4] = parameter(1, description="put each peak in one quadrant, or mirror it into all four")
    combine: Literal["rms", "max"] = parameter("rms", description="how overlapping peaks combine")
    decay: Literal["isotropic", "separable", "rotated", "elliptic"] = parameter(
        "isotropic", description="shape of the decay away from a peak (the last three need beta_x and beta_y)"
    )
    clamp: Literal["hard", "soft"] = parameter("hard", description="how the spectrum levels off at its peaks")
    coefficients: Literal["phase", "gaussian"] = parameter(
        "phase", description="random phases alone (exact spectrum), or Gaussian coefficients"
    )

    @field_validator("peaks", mode="before")
    @classmethod
    def _one_pair(cls, peaks: Any) -> Any:
        is_pair = isinstance(peaks, (list, tuple)) and len(peaks) == 2 and not isinstance(peaks[0], (list, tuple))
        return [peaks] if is_pair else peaks

    @model_validator(mode="after")
    def _exponents_agree(self) -> Fractal:
        if (self.beta_x is None) != (self.beta_y is None):
            raise ValueError("beta_x and beta_y come together; give both or neither")
        if self.beta is not None and self.beta_x is not None:
            raise ValueError("give beta, or beta_x with beta_y, not both")
        if self.decay != "isotropic" and self.beta_x is None:
            raise ValueError(f'decay "{self.decay}" needs beta_x and beta_y; add them or use decay = "isotropic"')
        if self.decay == "isotropic" and self.beta_x is not None:
            raise ValueError('beta_x and beta_y need decay = "separable", "rotated" or "elliptic"')
        return self

    @property
    def exponents(self) -> tuple[float, float]:
        """Exponents along the two axes; equal for an isotropic decay."""
        if self.beta_x is not None and self.beta_y is not None:
            return self.beta_x, self.beta_y
        beta = 1.4 if self.beta is None else self.beta
        return beta, beta


class Dem(Choice):
    """A measured bed: a grid of heights from a file."""

    kind: Literal["dem"] = "dem"
    path: str = parameter(description="GeoTIFF, BAG, .npy or .npz grid of heights (positive up)", min_length=1)
    datum: float = parameter(0.0, unit="m", description="added to every height of the file", ge=-2e4, le=2e4)
    scale: float = parameter(1.0, description="multiplies every height, before the datum is added", gt=0.0, le=1e3)


class Mimic(Choice):
    """Dunes of one material that record as a level bed of stripes or waves does, from one line and one height.

    The line is the x axis, the dunes lie along it, and the material is the seabed's own: its diffuse share must be
    the mean of the pattern's for the records to be equal.
    """

    kind: Literal["mimic"] = "mimic"
    of: PatternMap = parameter(
        PatternMap(
            of=(Material(diffuse=0.3, specular=0.0), Material(diffuse=0.5, specular=0.0)), shape="waves", period=16.0
        ),
        description="pattern that the dunes pass for; its materials scatter evenly, without a mirror lobe",
    )
    altitude: float = parameter(
        15.0,
        unit="m",
        description="height above the mean bed from which nothing tells them apart",
        gt=0.0,
        le=1e4,
        slider=(5.0, 50.0),
    )
    reach: float = parameter(
        51.2,
        unit="m",
        description="distance to either side up to which they pass; twice that on, the bed repeats",
        gt=0.0,
        le=1e5,
        slider=(10.0, 200.0),
        log=True,
    )
    law: Literal["light", "sonar"] = parameter("light", description="law under which they pass; that of sonar.law")

    @model_validator(mode="after")
    def _one_dimension(self) -> Mimic:
        if self.of.shape == "checks" or self.of.heading != 0.0:
            raise ValueError('of must lie along the track; give it shape = "stripes" or "waves" and heading = 0')
        if any(material.reflectivity.specular > 0.0 for material in self.of.of):
            raise ValueError("of holds a material with a mirror lobe, which no slope can imitate; set its specular = 0")
        return self


Relief = Annotated[
    Annotated[Flat, Tag("flat")]
    | Annotated[Fractal, Tag("fractal")]
    | Annotated[Dem, Tag("dem")]
    | Annotated[Mimic, Tag("mimic")],
    Discriminator(lambda value: kind_of(value, "flat")),
]


class Seabed(Declaration):
    """Mean depth, relief and material of the bed."""

    depth: float = parameter(
        30.0, unit="m", description="depth of the mean bed (a DEM has its own)", gt=0.0, le=11000.0, slider=(5.0, 200.0)
    )
    spacing: float = parameter(
        0.1, unit="m", description="spacing of the relief grid", gt=0.0, le=1e4, slider=(0.05, 1.0), log=True
    )
    relief: Relief = parameter(Flat(), description="shape of the bed")
    material: MaterialMap = parameter(Material(), description="what the bed is made of")

    @model_validator(mode="after")
    def _peaks_fit_the_grid(self) -> Seabed:
        relief = self.relief
        if not isinstance(relief, Fractal):
            return self
        cells = relief.period / self.spacing
        if cells > MOST_CELLS:
            raise ValueError(
                f"relief.period {relief.period:g} m at spacing {self.spacing:g} m makes {cells:.0f} cells a side; "
                f"shorten the period or widen the spacing to stay within {MOST_CELLS}"
            )
        nyquist = round(cells) / 2
        if any(max(abs(fx), abs(fy)) > 0 and max(abs(fx), abs(fy)) >= nyquist for fx, fy in relief.peaks):
            raise ValueError(
                f"relief.peaks {[list(peak) for peak in relief.peaks]} reach the Nyquist frequency of {nyquist:g} "
                f"cycles per period; keep below it or lessen spacing {self.spacing:g} m"
            )
        return self

    @model_validator(mode="after")
    def _dunes_pass_by_themselves(self) -> Seabed:
        relief = self.relief
        if not isinstance(relief, Mimic):
            return self
        cells = 2.0 * relief.reach / self.spacing
        if cells > MOST_CELLS:
            raise ValueError(
                f"relief.reach {relief.reach:g} m at spacing {self.spacing:g} m makes {cells:.0f} cells across; "
                f"shorten the reach or widen the spacing to stay within {MOST_CELLS}"
            )
        if not isinstance(self.material, Material):
            raise ValueError('relief "mimic" passes for a map by its shape; give the seabed a single material')
        return self
