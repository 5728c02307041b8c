"""Faults of declarations, each described in one sentence: field, value, remedy."""

import difflib
from collections.abc import Iterator
from typing import Any

from pydantic import BaseModel, ValidationError

from insonify.scene.base import Declaration, kind_name, models_of


def describe_fault(error: ValidationError, root: type[BaseModel]) -> str:
    """Describe the first fault of a declaration in one sentence: field, value, remedy."""
    faults = error.errors()
    path = _path(faults[0]["loc"], root)
    # Where a field accepts several types, the error of the closest type has the longest path.
    fault = max((f for f in faults if _path(f["loc"], root).startswith(path)), key=lambda f: len(f["loc"]))
    where = _path(fault["loc"], root) or "scene"
    kind, value = fault["type"], fault["input"]
    context = fault.get("ctx", {})
    if kind == "extra_forbidden":
        return f"{where}: unknown key; {_nearest(fault['loc'], root)}"
    if kind == "missing":
        return f"{where}: is missing; add it"
    if kind.startswith("union_tag"):
        expected = str(context.get("expected_tags", "")).replace("'", "")
        given = value.get("kind", "nothing") if isinstance(value, dict) else value
        return f"{where}.kind: {_shown(given)} is not a known kind; choose one of {expected}"
    if kind == "value_error":
        text = str(context["error"])
        if text.startswith(("is ", "must ")):
            return f"{where}: {_shown(value)} {text}"
        return f"{where}: {text}" if fault["loc"] else text
    if kind == "literal_error":
        return f"{where}: {_shown(value)} is not known; choose {context['expected']}"
    if kind in _BOUNDS:
        (limit, words), unit = _BOUNDS[kind], unit_at(fault["loc"], root)
        bound = f"{context[limit]:g}{unit if unit in ('', '°') else f' {unit}'}"
        return f"{where}: {_shown(value)} is out of bounds; give a value {words} {bound}"
    if kind.endswith(("too_short", "too_long")):
        bound = f"least {context['min_length']}" if "min_length" in context else f"most {context['max_length']}"
        return f"{where}: {_shown(value)} has length {len(value)}; give at {bound}"
    if kind == "string_pattern_mismatch":
        return f"{where}: {_shown(value)} is not a name; use letters, digits, - and _, and begin with a letter or digit"
    if kind == "finite_number":
        return f"{where}: {_shown(value)} is not a finite number; give a plain number"
    other = ("valid", fault["msg"])
    wanted, remedy = next((words for start, words in _WANTED.items() if kind.startswith(start)), other)
    return f"{where}: {_shown(value)} is not {wanted}; {remedy}"


# Expected value and remedy by pydantic's type of fault.
_WANTED = {
    "float": ("a number", "give a plain number"),
    "int": ("a whole number", "give a number without a fraction"),
    "bool": ("a truth value", "write true or false"),
    "string": ("text", "put it in quotes"),
    "tuple": ("a list", "write [..., ...] with one value for each place"),
    "model": ("a table", "write { field = value }, or the fields in a section of their own"),
}
_BOUNDS = {
    "greater_than": ("gt", "above"),
    "greater_than_equal": ("ge", "of at least"),
    "less_than": ("lt", "below"),
    "less_than_equal": ("le", "of at most"),
}


def _shown(value: Any) -> str:
    text = repr(value)
    return text if len(text) <= 60 else f"{text[:57]}..."


def _path(location: tuple[int | str, ...], root: type[BaseModel]) -> str:
    """Dotted path of a fault, without the kinds that pydantic puts between the fields."""
    steps = [step for step, _ in _steps(location, root)]
    return ".".join(str(s) if str(s).replace("-", "_").isidentifier() or isinstance(s, int) else repr(s) for s in steps)


def unit_at(location: tuple[int | str, ...], root: type[BaseModel]) -> str:
    """Return the unit of a field; empty for a pure number, a text, and what is no field."""
    unit = ""
    for step, models in _steps(location, root):
        found = [model.model_fields[step] for model in models if step in model.model_fields]
        if isinstance(step, str):
            unit = ""
        for field in found:
            unit = str(field.json_schema_extra.get("unit", "")) if isinstance(field.json_schema_extra, dict) else ""
    return unit


def _steps(location: tuple[int | str, ...], root: type[BaseModel]) -> Iterator[tuple[int | str, list[type[BaseModel]]]]:
    """Fields and positions along a path, each with the declarations that may contain it."""
    models: list[type[BaseModel]] = [root]
    is_kind = False  # whether the step before was a kind, after which there is none: a key may be named like it
    for depth, step in enumerate(location):
        if isinstance(step, str) and depth and not any(step in model.model_fields for model in models):
            tagged = [model for model in models if kind_name(model) == step]
            if tagged and not is_kind:
                models, is_kind = tagged, True
                continue
            if "[" in step or step.removeprefix("constrained-") in ("float", "int", "str"):
                continue
        yield step, models
        is_kind = False
        if isinstance(step, str):
            models = [child for model in models for child in models_of(model, step)]


def _nearest(location: tuple[int | str, ...], root: type[BaseModel]) -> str:
    """Suggest the most similar field for an unknown key."""
    *_, (_, models) = _steps(location, root)
    names = [name for model in models for name in model.model_fields]
    families = {model.family for model in models if issubclass(model, Declaration) and model.family is not None}
    kinds = {kind: each for family in families for kind, each in family.models(Declaration).items()}
    if others := [kind for kind, model in kinds.items() if str(location[-1]) in model.model_fields]:
        own = " or ".join(sorted({repr(kind) for model in models if (kind := kind_name(model))}))
        return f"it belongs to kind {' or '.join(map(repr, others))}, not to {own}; set kind, too"
    close = difflib.get_close_matches(str(location[-1]), names, n=1)
    if close:
        return f"did you mean {close[0]!r}?"
    return f"remove it, or use one of {', '.join(names)}" if names else "remove it"
