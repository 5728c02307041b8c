"""What the bed and the targets are made of: named materials, numbers, and maps of several."""

from __future__ import annotations

from typing import Annotated, Any, Literal, NamedTuple

from pydantic import Discriminator, Tag, field_validator, model_validator

from insonify.scene.base import Declaration, kind_of, parameter


class Reflectivity(NamedTuple):
    """Numbers of a surface: diffuse and specular shares of the reflected energy, and the lobe's exponent."""

    diffuse: float
    specular: float
    shininess: float


# Diffuse: pi * mu of the Lambert fit at 30 degrees of the Jackson model at 300 kHz; specular: R0^2, so that
# diffuse + specular <= 1; shininess: smoother sediments have the narrower lobe.
MATERIALS: dict[str, Reflectivity] = {
    "silt": Reflectivity(0.0128, 0.0040, 60.0),
    "fine_sand": Reflectivity(0.0559, 0.0543, 40.0),
    "medium_sand": Reflectivity(0.1893, 0.1369, 30.0),
    "coarse_sand": Reflectivity(0.3955, 0.2228, 20.0),
    "sandy_gravel": Reflectivity(0.9488, 0.0512, 10.0),
    "cobble": Reflectivity(0.9061, 0.0939, 8.0),
    "rock": Reflectivity(0.5587, 0.4413, 8.0),
    "concrete": Reflectivity(0.60, 0.30, 15.0),
    "steel": Reflectivity(0.55, 0.45, 25.0),
}


class Material(Declaration):
    """One material: a name, or numbers that override the name's."""

    kind: Literal["uniform"] = "uniform"
    name: str = parameter("medium_sand", description="named material whose numbers apply where none are given")
    diffuse: float | None = parameter(
        None, description="share of energy scattered evenly (Lambert)", ge=0.0, le=1.0, slider=(0.0, 1.0)
    )
    specular: float | None = parameter(
        None, description="share of energy in the mirror lobe (Phong)", ge=0.0, le=1.0, slider=(0.0, 1.0)
    )
    shininess: float | None = parameter(
        None, description="exponent of the mirror lobe", ge=1.0, le=1000.0, slider=(1.0, 200.0), log=True
    )

    @model_validator(mode="before")
    @classmethod
    def _name_alone(cls, value: Any) -> Any:
        return {"name": value} if isinstance(value, str) else value

    @field_validator("name")
    @classmethod
    def _known(cls, name: str) -> str:
        if name not in MATERIALS:
            raise ValueError(f"is not a known material; choose one of {', '.join(MATERIALS)}")
        return name

    @model_validator(mode="after")
    def _no_more_than_arrives(self) -> Material:
        diffuse, specular, _ = self.reflectivity
        if diffuse + specular > 1.0 + 1e-9:
            raise ValueError(
                f"diffuse {diffuse:g} + specular {specular:g} reflect more than arrives; lower one until they sum to 1"
            )
        return self

    @property
    def reflectivity(self) -> Reflectivity:
        """Numbers that apply: the given ones, else the named material's."""
        given = (self.diffuse, self.specular, self.shininess)
        return Reflectivity(*(b if a is None else a for a, b in zip(given, MATERIALS[self.name])))


class Patches(Declaration):
    """Patches with sharp borders: every patch takes one of the materials."""

    kind: Literal["patches"] = "patches"
    of: tuple[Material, ...] = parameter(description="materials of the patches", min_length=2, max_length=32)
    size: float = parameter(
        8.0, unit="m", description="typical width of a patch", gt=0.0, le=1e5, slider=(0.5, 50.0), log=True
    )


class FractalMap(Declaration):
    """Winding borders: a fractal field cut into bands of equal area, one band a material."""

    kind: Literal["fractal"] = "fractal"
    of: tuple[Material, ...] = parameter(description="materials of the bands", min_length=2, max_length=32)
    beta: float = parameter(
        1.8, description="amplitude exponent of the field; larger is smoother", ge=0.0, lt=5.0, slider=(0.5, 3.0)
    )


def _material_kind(value: Any) -> str:
    is_name = isinstance(value, str)
    return "uniform" if is_name else kind_of(value, "uniform")


MaterialMap = Annotated[
    Annotated[Material, Tag("uniform")] | Annotated[Patches, Tag("patches")] | Annotated[FractalMap, Tag("fractal")],
    Discriminator(_material_kind),
]
