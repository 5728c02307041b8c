"""Base of all declarations: frozen, validated, with bounds, unit and description of each parameter in one place."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any, ClassVar

from pydantic import AfterValidator, BaseModel, ConfigDict, Field, model_validator

from insonify.scene.kinds import Family, declare

# m, along x or y: no map reaches farther, and beyond it the resolution of numbers is coarser than relief.
Place = Annotated[float, Field(ge=-1e8, le=1e8)]


def _without_nul(path: str) -> str:
    if "\0" in path:
        raise ValueError("holds a NUL character, which no name of a file can; leave it out")
    return path


FilePath = Annotated[str, AfterValidator(_without_nul)]


class Declaration(BaseModel):
    """A frozen part of a scene; unknown keys, NaN and values out of bounds are refused.

    Attributes
    ----------
    family : Family or None
        Kinds that this declaration and those derived from it belong to, as far as they have a ``kind``.
    rank : int
        Place of a kind in menus and messages; equal ranks stand in the order in which they were found, those without
        one last.
    """

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False, validate_default=True, defer_build=True)
    family: ClassVar[Family | None] = None
    rank: ClassVar[int] = 100

    @classmethod
    def __pydantic_init_subclass__(cls, **options: Any) -> None:
        """Add a new kind to its family."""
        declare(cls, cls.family)

    @property
    def idle_fields(self) -> frozenset[str]:
        """Names of the fields without effect at the present values of the others; no slider is shown for them."""
        return frozenset()

    def value_in_force(self, field: str) -> float | None:
        """Return the number that applies where a field is left open, None if the rest of the scene decides it."""
        return None


class Choice(Declaration):
    """A declaration picked by its ``kind``; a bare name stands for ``{ kind = name }``.

    Attributes
    ----------
    table : frozenset of str
        Fields that are the columns of one table: another kind takes over all of them or none.
    """

    table: ClassVar[frozenset[str]] = frozenset()
    if TYPE_CHECKING:
        kind: str

    @model_validator(mode="before")
    @classmethod
    def _name_alone(cls, value: Any) -> Any:
        return {"kind": value} if isinstance(value, str) else value


def parameter(
    default: Any = ...,
    *,
    unit: str = "",
    description: str,
    slider: tuple[float, float] | None = None,
    log: bool = False,
    rare: bool = False,
    **bounds: Any,
) -> Any:
    """Declare one scene parameter."""
    extra: dict[str, Any] = {"unit": unit, "log": log}
    if rare:
        extra["rare"] = True
    if slider is not None:
        extra["slider"] = list(slider)
    return Field(default, description=description, json_schema_extra=extra, **bounds)


def kind_of(value: Any, default: str) -> str:
    """Read the ``kind`` of a raw or validated choice, for pydantic's discriminators."""
    if isinstance(value, str):
        return value
    if isinstance(value, dict):
        return str(value.get("kind", default))
    return str(getattr(value, "kind", default))
