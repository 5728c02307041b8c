"""Side-scan sonar simulation: scene in, record out."""

from __future__ import annotations

from importlib import import_module
from typing import Any

_HOMES = {
    "Scene": "scene",
    "SceneError": "scene",
    "chart": "chart",
    "load_scene": "scene",
    "plan": "plan",
    "prepare": "simulate",
    "relief": "terrain",
    "simulate": "simulate",
    "simulate_blocks": "simulate",
}
__all__ = list(_HOMES)


def __getattr__(name: str) -> Any:
    """Import a public name when it is first asked for, so that no command waits for what it does not use."""
    if name not in _HOMES:
        raise AttributeError(f"module 'insonify' has no attribute {name!r}")
    return getattr(import_module(f"insonify.{_HOMES[name]}"), name)
