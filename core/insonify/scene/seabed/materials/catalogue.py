"""Named materials and their scattering parameters.

They are tables of the TOML files in ``resources/materials`` and in the folders of the entry points
``insonify.materials``.
"""

from __future__ import annotations

import tomllib
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated, NamedTuple

from pydantic import Field, TypeAdapter, ValidationError, model_validator

from insonify.errors import SceneError
from insonify.files import resources
from insonify.plugins import announced
from insonify.scene.base import Declaration, parameter

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


class NamedMaterial(Declaration):
    """Scattering parameters, colour and source of a named material."""

    diffuse: Share = parameter(description="share of energy scattered evenly (Lambert)")
    specular: Share = parameter(description="share of energy in the mirror lobe (Phong)")
    shininess: float = parameter(description="exponent n of the mirror lobe", ge=1.0, le=1000.0)
    density: DensityRatio = parameter(description="density over that of water; inf for a perfect reflector")
    speed_ratio: float = parameter(description="speed of sound inside over that of water", ge=0.1, le=10.0)
    colour: tuple[Share, Share, Share] = parameter(description="red, green and blue in the viewer, as sRGB")
    source: str = parameter(description="where the numbers come from", min_length=1)

    @model_validator(mode="after")
    def _albedo_within_1(self) -> NamedMaterial:
        check_albedo(self.diffuse, self.specular)
        return self

    @property
    def reflectivity(self) -> Reflectivity:
        """Scattering parameters of a surface of the material."""
        # R0 = (ρν − 1) / (ρν + 1) of two fluids at normal incidence, written so that nothing overflows for a mirror.
        reflection = 1.0 - 2.0 / (self.density * self.speed_ratio + 1.0)
        return Reflectivity(self.diffuse, self.specular, self.shininess, reflection, self.speed_ratio)


class Catalogue(Mapping[str, NamedMaterial]):
    """Named materials by name: the bundled ones, then those of installed packages, which cannot replace others."""

    def __init__(self) -> None:
        self._kept: dict[str, NamedMaterial] = {}

    def __getitem__(self, name: str) -> NamedMaterial:
        return self._materials()[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._materials())

    def __len__(self) -> int:
        return len(self._materials())

    @contextmanager
    def including(self, folder: Path) -> Iterator[None]:
        """Add the materials of another folder within the block, for tests."""
        kept = dict(self._materials())
        try:
            self._kept.update(read_materials(folder))
            yield
        finally:
            self._kept = kept

    def _materials(self) -> dict[str, NamedMaterial]:
        if not self._kept:
            self._kept = read_materials(resources() / "materials")
            for entry in announced("insonify.materials"):
                others = read_materials(Path(entry.load()))
                self._kept |= {name: others[name] for name in others if name not in self._kept}
        return self._kept


def check_albedo(diffuse: float, specular: float) -> None:
    """Raise ValueError for shares of energy that sum to more than 1."""
    if diffuse + specular > 1.0 + 1e-9:
        raise ValueError(
            f"diffuse {diffuse:g} + specular {specular:g} reflect more than arrives; lower one until they sum to 1"
        )


def read_materials(folder: Path) -> dict[str, NamedMaterial]:
    """Read the named materials of a folder of TOML files."""
    found: dict[str, NamedMaterial] = {}
    for file in sorted(folder.glob("*.toml")):
        try:
            tables = tomllib.loads(file.read_text(encoding="utf-8"))
            found |= _TABLES.validate_python(tables)
        except tomllib.TOMLDecodeError as error:
            raise SceneError(f"{file}: is not valid TOML ({error}); correct that line") from None
        except ValidationError as error:
            fault = error.errors()[0]
            field = ".".join(map(str, fault["loc"]))
            raise SceneError(f"{file}: {field}: {fault['input']!r} is not right ({fault['msg']}); mend it") from None
    return found


_TABLES = TypeAdapter(dict[str, NamedMaterial])
MATERIALS = Catalogue()
