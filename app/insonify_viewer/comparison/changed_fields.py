"""What differs between two scenes and their modellings, in words."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from insonify.scene import plain
from insonify_viewer.modelling import Modelling

if TYPE_CHECKING:
    from insonify.scene import Scene

UNHEARD = ("title", "description", "partner")  # fields that do not concern the record
AUTOMATIC = "automatic"


def list_changes(before: tuple[Scene, Modelling], after: tuple[Scene, Modelling]) -> list[str]:
    """List what differs, as "sonar beam width 1 → 2.5" or "planes automatic → 16".

    Parameters
    ----------
    before, after : tuple of Scene and Modelling
    """
    old, new = (dict(_values(plain(scene))) for scene, _ in (before, after))
    changes = [
        f"{path.replace('.', ' ').replace('_', ' ')} {_word(old.get(path))} → {_word(new.get(path))}"
        for path in dict.fromkeys([*old, *new])
        if old.get(path) != new.get(path) and path not in UNHEARD
    ]
    one, other = before[1], after[1]
    if one.tolerance != other.tolerance:
        changes.append(f"tolerance {100.0 * one.tolerance:g} % → {100.0 * other.tolerance:g} %")
    choices, others = dict(one.forced), dict(other.forced)
    for subject in dict.fromkeys([*choices, *others]):
        chosen, instead = choices.get(subject, AUTOMATIC), others.get(subject, AUTOMATIC)
        if chosen != instead:
            changes.append(f"{subject} {chosen} → {instead}")
    return changes


def _values(value: Any, path: str = "") -> Iterator[tuple[str, Any]]:
    """Every value of nested ones by its dotted path; the kind of a declaration by that of the declaration."""
    if isinstance(value, dict):
        for key, child in value.items():
            yield from _values(child, path if key == "kind" else f"{path}.{key}" if path else key)
    elif isinstance(value, list) and any(isinstance(item, dict | list) for item in value):
        for number, child in enumerate(value, 1):
            yield from _values(child, f"{path}.{number}")
    else:
        yield path, value


def _word(value: Any) -> str:
    """Write a value; "none" where a scene has none."""
    if value is None:
        return "none"
    return f"{value:.4g}" if isinstance(value, float) else str(value)
