"""Named materials and their scattering parameters.

They are tables of the TOML files in ``resources/materials`` and in the folders of the entry points
``insonify.materials``.
"""

import math
from collections import UserDict
from functools import cached_property
from pathlib import Path
from typing import Annotated, NamedTuple, Self

from pydantic import Field, TypeAdapter, ValidationError, model_validator

from insonify.errors import SceneError
from insonify.files import resources
from insonify.io.file_access import LARGEST_TOML, FileFault, parse_toml, read_text
from insonify.plugins import announced, loaded
from insonify.scene.base import Declaration, parameter
from insonify.scene.seabed.materials.sediments import Sediment, fit_law

Share = Annotated[float, Field(ge=0.0, le=1.0)]
DensityRatio = Annotated[float, Field(gt=0.0, allow_inf_nan=True)]


class Reflectivity(NamedTuple):
    """Scattering parameters of a surface."""

    # Shares of the energy that returns evenly (Lambert) and in a lobe about the mirror direction (Phong).
    diffuse: float
    specular: float
    shininess: float  # exponent of that lobe
    reflection: float = 0.0  # R0, share of the amplitude that a smooth surface reflects at normal incidence
    speed_ratio: float = 1.0  # ν, speed of sound inside over that of water
    speckle_shape: float | None = None  # shape of K speckle; the receiver's own where None


class SedimentParameters(Declaration):
    """Parameters of the backscatter model of a sediment, besides its density and speed."""

    loss: float = parameter(description="imaginary over real part of the wave number", gt=0.0, le=1.0)
    volume: float = parameter(description="cross section of the volume over its attenuation in dB", ge=0.0, le=1.0)
    spectral_strength: float = parameter(description="spectrum of heights at 1/cm", unit="cm⁴", gt=0.0, le=10.0)
    spectral_exponent: float = parameter(description="exponent of that spectrum", gt=2.0, lt=4.0)


class NamedMaterial(Declaration):
    """Scattering parameters, colour and source of a named material.

    The shares and the exponent hold for the law of light, and for the law of sonar where there is no ``sediment``.
    """

    diffuse: Share = parameter(description="share of energy scattered evenly (Lambert)")
    specular: Share = parameter(description="share of energy in the mirror lobe (Phong)")
    shininess: float = parameter(description="exponent n of the mirror lobe", ge=1.0, le=1000.0)
    density: DensityRatio = parameter(description="density over that of water; inf for a perfect reflector")
    speed_ratio: float = parameter(description="speed of sound inside over that of water", ge=0.1, le=10.0)
    colour: tuple[Share, Share, Share] = parameter(description="red, green and blue in the viewer, as sRGB")
    source: str = parameter(description="where the numbers come from", min_length=1)
    sediment: SedimentParameters | None = parameter(
        None, "model of its backscatter over frequency, to which the law of sonar is fitted"
    )

    @model_validator(mode="after")
    def _parameters_agree(self) -> Self:
        check_albedo(self.diffuse, self.specular)
        if self.sediment is not None and math.isinf(self.density):
            raise ValueError("density inf means a perfect reflector, which is not a sediment; give a number")
        return self

    @property
    def reflectivity(self) -> Reflectivity:
        """Scattering parameters of a surface of the material."""
        # R0 = (ρν − 1) / (ρν + 1) of two fluids at normal incidence, written so that nothing overflows for a mirror.
        reflection = 1.0 - 2.0 / (self.density * self.speed_ratio + 1.0)
        return Reflectivity(self.diffuse, self.specular, self.shininess, reflection, self.speed_ratio)

    @property
    def model(self) -> Sediment | None:
        """Sediment of the backscatter model; None for a material without one."""
        return None if self.sediment is None else Sediment(self.density, self.speed_ratio, **dict(self.sediment))

    def reflectivity_at(self, frequency: float | None) -> Reflectivity:
        """Scattering parameters fitted to the model at a frequency in Hz; the declared ones without either."""
        if frequency is None or self.model is None:
            return self.reflectivity
        return self.reflectivity._replace(**fit_law(self.model, frequency, self.shininess)._asdict())


class Catalogue(UserDict[str, NamedMaterial]):
    """Named materials by name: the bundled ones, then those of installed packages, which cannot replace others."""

    def __init__(self) -> None:
        """Read nothing yet."""

    @cached_property
    def data(self) -> dict[str, NamedMaterial]:  # type: ignore[override]  # read when first used
        """All materials."""
        found = read_materials(resources() / "materials")
        for others in loaded(announced("insonify.materials"), lambda folder: read_materials(Path(folder))):
            found = found | others | found
        return found


def check_albedo(diffuse: float, specular: float) -> None:
    """Raise ValueError for shares of energy that sum to more than 1."""
    if diffuse + specular > 1.0 + 1e-9:
        raise ValueError(
            f"diffuse {diffuse:g} + specular {specular:g} exceed 1, the energy that arrives; lower one of them"
        )


def read_materials(folder: Path) -> dict[str, NamedMaterial]:
    """Read the named materials of a folder of TOML files."""
    found: dict[str, NamedMaterial] = {}
    for file in sorted(folder.glob("*.toml")):
        try:
            found |= _TABLES.validate_python(parse_toml(read_text(file, largest=LARGEST_TOML)))
        except FileFault as error:
            raise SceneError(f"{file}: {error}") from None
        except ValidationError as error:
            fault = error.errors()[0]
            field = ".".join(map(str, fault["loc"]))
            raise SceneError(f"{file}: {field}: {fault['input']!r} is not valid ({fault['msg']}); correct it") from None
    return found


_TABLES = TypeAdapter(dict[str, NamedMaterial])
MATERIALS = Catalogue()
