"""Base of all declarations: parameters with bounds, unit and description, and families of kinds.

A declaration is a frozen, validated part of a scene. A field may hold one declaration of a family, picked by its
``kind``. A family holds the kinds of its package, those that installed packages bring by an entry point of the group
``insonify.<family>``, and those that are declared later.
"""

# Annotations are no texts here: pydantic would compile those of `Declaration` again for each subclass.

from collections.abc import Iterator
from functools import cache
from inspect import get_annotations
from itertools import pairwise
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal, TypeVar

from pydantic import AfterValidator, BaseModel, ConfigDict, Field, GetCoreSchemaHandler, model_validator
from pydantic_core import CoreSchema, core_schema

from insonify.errors import plain_text
from insonify.files import file_version
from insonify.plugins import extensions

Model = TypeVar("Model", bound="Declaration")
# m along x or y; beyond 1e8 m, float64 cannot resolve the relief.
Coordinate = Annotated[float, Field(ge=-1e8, le=1e8)]
_DECLARED: list[type["Declaration"]] = []


def _without_nul(path: str) -> str:
    if "\0" in path:
        raise ValueError("contains a NUL character, which file names cannot have; remove it")
    return path


FilePath = Annotated[str, AfterValidator(_without_nul)]
# Words for a person; a terminal or a window executes none of them.
Words = Annotated[str, AfterValidator(plain_text)]


class Family:
    """All kinds of one choice: those of a package, and those of the entry points ``insonify.<name>``."""

    def __init__(self, name: str, package: str = "") -> None:
        self.name, self.package = name, package
        self._models: dict[str, type[Declaration]] = {}
        self._discovered = False
        self.used: set[type[Declaration]] = set()  # bases that fields accept: a later kind of them rebuilds the fields

    def add(self, model: type["Declaration"]) -> None:
        """Add a kind. A declaration of this family is added when its class is created."""
        kind = kind_name(model)
        if kind is None:
            return
        self._models[kind] = model
        if self._discovered and issubclass(model, tuple(self.used)):
            rebuild_declarations()

    def models(self, base: type[Model]) -> dict[str, type[Model]]:
        """Return the kinds that derive from a class, by name, sorted by rank."""
        if not self._discovered:
            # A kind that contains others of its family needs them while its own module is being imported: the other
            # modules are then imported first, and the outer loop has nothing left to do.
            extensions(self.package, f"insonify.{self.name}")  # classes add themselves
            self._discovered = True
        found = sorted(self._models.items(), key=lambda item: getattr(item[1], "rank", 0))
        return {kind: model for kind, model in found if issubclass(model, base)}


class Declaration(BaseModel):
    """A frozen part of a scene; unknown keys, NaN and values out of bounds are rejected.

    A kind of a family has its name and rank in the head of its class: ``class Tone(PulseKind, kind="tone", rank=20)``.

    Attributes
    ----------
    family : Family or None
        Family of this declaration and those derived from it that have a ``kind``.
    rank : int
        Position of a kind in menus and messages. Kinds of equal rank stand in the order of discovery, kinds without a
        rank last.
    table : frozenset of str
        Fields that are the columns of one table: on a change of kind all of them are kept or none.
    """

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False, validate_default=True, defer_build=True)
    family: ClassVar[Family | None] = None
    rank: ClassVar[int] = 100
    table: ClassVar[frozenset[str]] = frozenset()

    def __init_subclass__(cls, *, kind: str = "", rank: int | None = None, **options: Any) -> None:
        """Make the name of a kind its field ``kind``, the first of its fields."""
        super().__init_subclass__(**options)
        if kind:
            cls.__annotations__ = {"kind": Literal[kind], **get_annotations(cls)}
            cls.kind = kind  # type: ignore[attr-defined]
        if rank is not None:
            cls.rank = rank

    @classmethod
    def __pydantic_init_subclass__(cls, **options: Any) -> None:
        """Add a new kind to its family."""
        _DECLARED.append(cls)
        if cls.family is not None:
            cls.family.add(cls)

    @property
    def idle_fields(self) -> frozenset[str]:
        """Names of the fields that have no effect at the present values of the others; they get no slider."""
        return frozenset()

    @property
    def version(self) -> tuple[int, int] | None:
        """Version of the file at ``path``, None for a declaration without a file."""
        path = getattr(self, "path", None)
        return None if path is None else file_version(path)

    def value_in_force(self, field: str, frequency: float | None = None) -> float | None:
        """Return the number that applies where a field is left out, None if it depends on the rest of the scene.

        Parameters
        ----------
        field : str
            Name of the field.
        frequency : float or None
            Hz, at which sediments scatter; None for the law of light.
        """
        return None


class Kind(Declaration):
    """A declaration picked by its ``kind``; a bare name stands for ``{ kind = name }``."""

    if TYPE_CHECKING:
        kind: str = ""

    @model_validator(mode="before")
    @classmethod
    def _name_alone(cls, value: Any) -> Any:
        return {"kind": value} if isinstance(value, str) else value

    def describe_limits(self, frequency: float) -> Iterator[str]:
        """Describe in a sentence each way in which a frequency in Hz or a value leaves the range of its formula."""
        yield from ()


def describe_excess(
    name: str, lowest: float, highest: float, unit: str, valid: tuple[float, float], formula: str
) -> Iterator[str]:
    """Describe the end of a quantity's values that lies outside the range of a formula."""
    least, most = valid
    for value, outside in ((lowest, lowest < least), (highest, highest > most)):
        if outside:
            yield f"{name} {value:g}{unit} is outside the range of {formula}, {least:g} to {most:g}{unit}"


class Nothing(Kind, kind="none"):
    """Without this effect."""


class KindOf:
    """Annotation of a field that holds one declaration of a family, of the kinds that derive from a base class."""

    def __init__(
        self,
        family: Family,
        base: type[Declaration] = Declaration,
        *,
        default: str | None = None,  # kind of a table without ``kind``
        text: str | None = None,  # kind for which a bare text stands; the text itself is the kind when left out
        number: str | None = None,  # kind for which a bare number stands
        optional: bool = False,  # whether the field may be None, which is written as the kind ``none``
    ) -> None:
        self.family, self.base, self.text, self.number, self.optional = family, base, text, number, optional
        self.default = default or ("none" if optional else "missing")

    @property
    def models(self) -> tuple[type[Declaration], ...]:
        """The declarations that the field accepts."""
        return (*((Nothing,) if self.optional else ()), *self.family.models(self.base).values())

    def kind(self, value: Any) -> str:
        """Read the kind of a raw or validated value."""
        if isinstance(value, str):
            return self.text or value
        if self.number is not None and isinstance(value, (int, float)):
            return self.number
        if isinstance(value, dict):
            return str(value.get("kind", self.default))
        return str(getattr(value, "kind", self.default))

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        """Accept every kind of the family."""
        choices = {str(kind_name(model)): handler.generate_schema(model) for model in self.models}
        self.family.used.add(self.base)
        schema = core_schema.tagged_union_schema(choices, discriminator=self.kind)
        if not self.optional:
            return schema
        return core_schema.no_info_after_validator_function(
            lambda value: None if isinstance(value, Nothing) else value,
            core_schema.no_info_before_validator_function(lambda value: "none" if value is None else value, schema),
            serialization=core_schema.wrap_serializer_function_ser_schema(
                lambda value, serialize: {"kind": "none"} if value is None else serialize(value), schema=schema
            ),
        )


def parameter(
    default: Any = ...,
    description: str = "",
    unit: str = "",
    *,
    slider: tuple[float, float] | None = None,
    log: bool = False,
    rare: bool = False,
    **bounds: Any,
) -> Any:
    """Declare one scene parameter.

    Parameters
    ----------
    default : Any
        Default value; the parameter is required when left out. A class stands for its declaration without arguments,
        made when it is first needed: to make the defaults of a scene takes a quarter of the time to load a command.
    description, unit : str
        Meaning and unit, as the viewer's tooltips and the reference show them.
    slider : (float, float), optional
        Ends of the viewer's slider.
    log : bool
        Whether the slider is logarithmic.
    rare : bool
        Whether the viewer folds the parameter away.
    **bounds
        Bounds of the value, as pydantic takes them.
    """
    extra: dict[str, Any] = {"unit": unit, "log": log}
    if rare:
        extra["rare"] = True
    if slider is not None:
        extra["slider"] = list(slider)
    made = {"default_factory": cache(default)} if isinstance(default, type) else {"default": default}
    return Field(**made, description=description, json_schema_extra=extra, **bounds)


def angle(description: str, default: float = 0.0, *, rare: bool = False) -> Any:
    """Declare an angle of a whole turn."""
    return parameter(default, description, "°", ge=-360.0, le=360.0, slider=(-180.0, 180.0), rare=rare)


def share(default: float | None, description: str, *, most: float = 1.0, shown: float | None = None) -> Any:
    """Declare a share from 0 up to the most, with a slider up to the share that is shown."""
    return parameter(default, description, ge=0.0, le=most, slider=(0.0, most if shown is None else shown))


def decibels(
    default: float | None, description: str, bounds: tuple[float, float], slider: tuple[float, float], **rare: bool
) -> Any:
    """Declare a level or a gain in decibels, between bounds."""
    return parameter(default, description, "dB", ge=bounds[0], le=bounds[1], slider=slider, **rare)


def metres(
    default: float, description: str, slider: tuple[float, float], *, least: float | None = None, most: float
) -> Any:
    """Declare a length, above 0 or from the least on, with a logarithmic slider."""
    low: dict[str, Any] = {"gt": 0.0} if least is None else {"ge": least}
    return parameter(default, description, "m", **low, le=most, slider=slider, log=True)


def check_increasing(by: str, pairs: Any) -> Any:
    """Return pairs, or raise ValueError if their first numbers do not increase."""
    if any(after[0] <= before[0] for before, after in pairwise(pairs)):
        raise ValueError(f"must run in order of increasing {by}; sort the pairs and drop doubles")
    return pairs


def kind_name(model: type[BaseModel]) -> str | None:
    """Return the ``kind`` by which a declaration is picked, None for one that is not picked by kind."""
    field = model.model_fields.get("kind")
    return field.default if field is not None and isinstance(field.default, str) else None


def rebuild_declarations() -> None:
    """Update the fields of all declarations to the present kinds of their families."""
    models_of.cache_clear()
    # In the order of their creation: a declaration comes after all that it contains.
    for model in _DECLARED:
        model.model_rebuild(force=True)


@cache
def models_of(parent: type[BaseModel], field: str) -> tuple[type[Declaration], ...]:
    """List the declarations that a field can hold, in order; empty for plain numbers and names."""
    if field not in parent.model_fields:
        return ()
    info = parent.model_fields[field]
    found: list[type[Declaration]] = []
    pending: list[Any] = [entry for entry in info.metadata if isinstance(entry, KindOf)] or [info.annotation]
    while pending:
        annotation = pending.pop(0)
        kinds = [entry for entry in getattr(annotation, "__metadata__", ()) if isinstance(entry, KindOf)]
        if isinstance(annotation, KindOf):
            found.extend(annotation.models)
        elif kinds:
            pending.extend(kinds)
        elif isinstance(annotation, type) and issubclass(annotation, Declaration):
            found.append(annotation)
        else:
            pending.extend(getattr(annotation, "__args__", ()))
    return tuple(found)


def is_field(root: type[Declaration], path: str) -> bool:
    """Whether a dotted path leads to a field of a declaration, for some choice of the kinds along it."""
    models: tuple[type[Declaration], ...] = (root,)
    for depth, step in enumerate(path.split(".")):
        if depth and step.isdigit():
            continue
        parents = [model for model in models if step in model.model_fields]
        if not parents:
            return False
        models = tuple(child for model in parents for child in models_of(model, step))
    return True
