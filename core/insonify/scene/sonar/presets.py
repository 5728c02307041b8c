"""Presets of sonars: numbers of a class of sonars, which a scene takes where it gives none."""

import tomllib
from functools import cache
from typing import Any

from insonify.files import bundled_sonars

NO_PRESET = "none"
SLOWEST_WATER, FASTEST_PINGS = 1400.0, 30.0  # m/s, Hz
OF_RECEIVER = ("receiver.source_level", "receiver.recorder.bits")  # fields of a preset outside of the sonar


def with_preset(values: Any) -> Any:
    """Return raw values of a scene with what the preset of its sonar declares and the scene does not."""
    # A bare name stands for ``{ preset = name }``; ``"none"`` is no preset. A preset pings as fast as the range allows.
    sonar = values.get("sonar") if isinstance(values, dict) else None
    if isinstance(sonar, str):
        sonar = {"preset": sonar}
    if not isinstance(sonar, dict) or sonar.get("preset") is None:
        return values
    name = sonar["preset"]
    if name == NO_PRESET:
        return values | {"sonar": {key: value for key, value in sonar.items() if key != "preset"}}
    if name not in bundled_sonars():
        known = ", ".join(bundled_sonars())
        raise ValueError(f"sonar.preset: {str(name)[:40]!r} is not a known sonar; choose one of {known}")
    declared = read_preset(name)
    complete = _merged(declared["sonar"], sonar)
    if isinstance(reach := complete["range"], (int, float)) and reach > 0.0:
        complete.setdefault("ping_rate", round(min(0.5 * SLOWEST_WATER / reach, FASTEST_PINGS), 3))
    receiver = values.get("receiver", {})
    both = _merged(declared["receiver"], receiver) if isinstance(receiver, dict) else receiver
    return values | {"sonar": complete, "receiver": both}


@cache
def read_preset(name: str) -> dict[str, Any]:
    """Read a bundled preset: its ``title``, the ``source`` of its numbers, and tables of ``sonar`` and ``receiver``."""
    return tomllib.loads(bundled_sonars()[name].read_text(encoding="utf-8"))


def _merged(below: dict[str, Any], above: dict[str, Any]) -> dict[str, Any]:
    """Nested values of two tables, the second's where both have one; a table of another kind replaces the first's."""
    merged = below | above
    for key in below.keys() & above.keys():
        one, other = below[key], above[key]
        if isinstance(one, dict) and isinstance(other, dict) and other.get("kind", one.get("kind")) == one.get("kind"):
            merged[key] = _merged(one, other)
    return merged
