"""What the bed and the targets are made of: named materials, numbers, and maps of several."""

from __future__ import annotations

import math
from typing import Annotated, Any, Literal, NamedTuple

from pydantic import Discriminator, Tag, field_validator, model_validator

from insonify.scene.base import Declaration, FilePath, kind_of, parameter


class Reflectivity(NamedTuple):
    """Numbers of a surface.

    Attributes
    ----------
    diffuse, specular : float
        Shares of the energy that returns evenly (Lambert) and in a lobe about the mirror direction (Phong).
    shininess : float
        Exponent of that lobe.
    reflection : float
        R0, share of the amplitude that a smooth surface reflects at normal incidence.
    speed_ratio : float
        ν, speed of sound inside over that of water.
    speckle_shape : float or None
        Shape of K speckle; the receiver's own where None.
    """

    diffuse: float
    specular: float
    shininess: float
    reflection: float = 0.0
    speed_ratio: float = 1.0
    speckle_shape: float | None = None

    @property
    def lobe_half_width(self) -> float:
        """Incidence at which the lobe is half as strong as straight on, in degrees.

        Sound that returns the way it came is 2α off the mirror direction at incidence α, so that cosⁿ(2α) = ½ at
        α = ½ arccos 2^(−1/n): half of what the exponent n means to light and eye.
        """
        return math.degrees(0.5 * math.acos(2.0 ** (-1.0 / self.shininess)))

    @property
    def facet_slope(self) -> float:
        """Rms slope, along one horizontal axis, of the microstructure that makes such a lobe.

        A surface of mirror-like facets with Gaussian slopes of that rms s returns in proportion to the share of them
        that faces the sonar, exp(−tan² α / 2s²) (Kirchhoff approximation, high frequencies); near the middle
        cosⁿ(2α) ≈ exp(−2nα²), so that s = 1/(2√n).
        """
        return 0.5 / math.sqrt(self.shininess)


def _substance(
    diffuse: float, specular: float, shininess: float, *, density: float, speed_ratio: float
) -> Reflectivity:
    """Numbers of a named material, from its density and speed of sound over those of water.

    R0 = (ρν − 1) / (ρν + 1) is that of two fluids at normal incidence; written so that nothing overflows for a mirror.
    """
    return Reflectivity(diffuse, specular, shininess, 1.0 - 2.0 / (density * speed_ratio + 1.0), speed_ratio)


# Sediments: density and speed as in the Jackson model at 300 kHz; diffuse: πμ of the Lambert fit to its backscatter at
# 30° grazing; specular: R0², as far as diffuse + specular stay within 1, so that a level bed at R returns R0²/(2R)² of
# its lobe, the echo of the sonar's mirror image, whatever the exponent n (to a share of 1/2n). Shininess: smoother
# ones have the narrower lobe.
MATERIALS: dict[str, Reflectivity] = {
    "silt": _substance(0.0128, 0.0040, 60.0, density=1.149, speed_ratio=0.987),
    "fine_sand": _substance(0.0559, 0.0543, 40.0, density=1.451, speed_ratio=1.107),
    "medium_sand": _substance(0.1893, 0.1369, 30.0, density=1.845, speed_ratio=1.178),
    "coarse_sand": _substance(0.3955, 0.2228, 20.0, density=2.231, speed_ratio=1.250),
    "sandy_gravel": _substance(0.9488, 0.0512, 10.0, density=2.492, speed_ratio=1.337),
    "cobble": _substance(0.9061, 0.0939, 8.0, density=2.5, speed_ratio=1.8),
    "rock": _substance(0.5587, 0.4413, 8.0, density=2.5, speed_ratio=2.3),
    "concrete": _substance(0.60, 0.30, 15.0, density=2.4, speed_ratio=2.5),
    "steel": _substance(0.55, 0.45, 25.0, density=7.85, speed_ratio=3.9),
    "mirror": _substance(0.0, 1.0, 1000.0, density=math.inf, speed_ratio=1.0),
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
        None,
        description="exponent n of the mirror lobe, as of facets with an rms slope of 1/(2√n) each way",
        ge=1.0,
        le=1000.0,
        slider=(1.0, 200.0),
        log=True,
    )
    reflection: float | None = parameter(
        None,
        description="share of the amplitude reflected in mirror-like bounces (R0)",
        ge=0.0,
        le=1.0,
        slider=(0.0, 1.0),
    )
    speed_ratio: float | None = parameter(
        None, description="speed of sound inside over that of water", ge=0.1, le=10.0, slider=(0.5, 5.0), log=True
    )
    speckle_shape: float | None = parameter(
        None,
        description="shape of K speckle on this material; fewer scatterers make it smaller and the speckle spikier",
        ge=0.01,
        le=1e4,
        slider=(0.1, 100.0),
        log=True,
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
        diffuse, specular = self.reflectivity[:2]
        if diffuse + specular > 1.0 + 1e-9:
            raise ValueError(
                f"diffuse {diffuse:g} + specular {specular:g} reflect more than arrives; lower one until they sum to 1"
            )
        return self

    @property
    def reflectivity(self) -> Reflectivity:
        """Numbers that apply: the given ones, else the named material's."""
        given = {field: getattr(self, field) for field in Reflectivity._fields}
        return MATERIALS[self.name]._replace(**{field: number for field, number in given.items() if number is not None})


class Patches(Declaration):
    """Patches with sharp borders: every patch takes one of the materials."""

    kind: Literal["patches"] = "patches"
    of: tuple[Material, ...] = parameter(description="materials of the patches", min_length=2, max_length=32)
    size: float = parameter(
        8.0, unit="m", description="typical width of a patch", ge=1e-3, le=1e5, slider=(0.5, 50.0), log=True
    )


class FractalMap(Declaration):
    """Winding borders: a fractal field cut into bands of equal area, one band a material."""

    kind: Literal["fractal"] = "fractal"
    of: tuple[Material, ...] = parameter(description="materials of the bands", min_length=2, max_length=32)
    beta: float = parameter(
        1.8, description="amplitude exponent of the field; larger is smoother", ge=0.0, lt=5.0, slider=(0.5, 3.0)
    )


class PatternMap(Declaration):
    """A regular pattern with known borders, for checks and figures."""

    kind: Literal["pattern"] = "pattern"
    of: tuple[Material, ...] = parameter(description="materials of one period", min_length=2, max_length=32)
    shape: Literal["stripes", "checks", "waves"] = parameter(
        "stripes", description="stripes and checks have sharp borders; waves blend from the first to the last and back"
    )
    period: float = parameter(
        8.0,
        unit="m",
        description="length after which it repeats; whole ones are fitted into a period of the relief",
        gt=0.0,
        le=1e5,
        slider=(0.5, 50.0),
        log=True,
    )
    heading: float = parameter(
        0.0,
        unit="°",
        description="direction along the stripes, counter-clockwise from +x; they follow one another to its left",
        ge=-360.0,
        le=360.0,
        slider=(-180.0, 180.0),
    )


class ImageMap(Declaration):
    """A picture laid on the bed, north up, repeated from its lower left corner at (0, 0)."""

    kind: Literal["image"] = "image"
    path: FilePath = parameter(description="PNG or TIFF, grey or with a palette", min_length=1)
    of: tuple[Material, ...] = parameter(
        description="materials from black to white, or of the palette's first colours", min_length=2, max_length=256
    )
    width: float = parameter(
        102.4,
        unit="m",
        description="width of the picture on the bed; whole pictures are fitted into a period of the relief",
        gt=0.0,
        le=1e6,
        slider=(10.0, 500.0),
        log=True,
    )


def _material_kind(value: Any) -> str:
    is_name = isinstance(value, str)
    return "uniform" if is_name else kind_of(value, "uniform")


MaterialMap = Annotated[
    Annotated[Material, Tag("uniform")]
    | Annotated[Patches, Tag("patches")]
    | Annotated[FractalMap, Tag("fractal")]
    | Annotated[PatternMap, Tag("pattern")]
    | Annotated[ImageMap, Tag("image")],
    Discriminator(_material_kind),
]
