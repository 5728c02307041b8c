"""Speckle models."""

from typing import Any, ClassVar, NamedTuple

from insonify.scene.base import Family, Kind, parameter

SPECKLES = Family("speckles", "insonify.scene.receiver")


class Texture(NamedTuple):
    """Gamma-distributed strength of the bed about its mean."""

    shape: float  # shape ν of the distribution
    cell: float | None  # area in m² that ν refers to; None for the same ν in every cell


class SpeckleKind(Kind):
    """Interference of scatterers within a cell.

    Attributes
    ----------
    speckled : bool
        Whether there is any.
    interferes : bool
        Whether the sweep traces scatterers one by one; otherwise speckle is drawn bin by bin.
    """

    family = SPECKLES
    speckled: ClassVar[bool] = True
    interferes: ClassVar[bool] = False

    @property
    def independent_records(self) -> int:
        """Number of independent records that are averaged."""
        return getattr(self, "looks", 1)

    @property
    def texture(self) -> Texture | None:
        """Gamma-distributed strength of the bed; None where it is even."""
        return None

    @property
    def scatterer_density(self) -> float | None:
        """Scatterers per square metre, of speckle that interferes; None to let the tracer choose."""
        return getattr(self, "density", None)


class NoSpeckle(SpeckleKind, kind="none", rank=10):
    """No speckle: the mean echo."""

    speckled = False


def _looks() -> Any:
    return parameter(1, "independent records averaged", ge=1, le=64, slider=(1, 16), log=True)


class Rayleigh(SpeckleKind, kind="rayleigh", rank=20):
    """Fully developed speckle: the intensity of every bin is exponential about its mean."""

    looks: int = _looks()


class K(SpeckleKind, kind="k", rank=30):
    """Speckle of few scatterers: Rayleigh speckle of a bed with gamma-distributed strength."""

    shape: float = parameter(
        2.0,
        "shape of the gamma distribution; fewer scatterers make it smaller and the speckle spikier",
        ge=0.01,
        le=1e4,
        slider=(0.1, 100.0),
        log=True,
    )
    looks: int = _looks()
    cell: float | None = parameter(
        None,
        "area that the shape refers to: the shape grows with the cell, hence with range and pulse; "
        "the same shape everywhere when left out",
        "m²",
        gt=0.0,
        le=1e6,
        slider=(1e-3, 10.0),
        log=True,
    )

    @property
    def texture(self) -> Texture:
        """Gamma-distributed strength of the bed."""
        return Texture(self.shape, self.cell)


class Coherent(SpeckleKind, kind="coherent", rank=40):
    """Scatterers on bed and targets whose echoes are traced one by one and interfere; slow, by the sweep alone."""

    interferes = True
    density: float | None = parameter(
        None,
        "mean number of scatterers per area; 32 in a cell at half the range when left out",
        "1/m²",
        gt=0.0,
        le=1e6,
        slider=(1.0, 1e4),
        log=True,
    )
