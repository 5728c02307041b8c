"""Side-scan sonar simulation: scene in, record out."""

from __future__ import annotations

import sys
from importlib import import_module
from types import ModuleType
from typing import Any

_HOMES = {
    "Scene": "scene",
    "SceneError": "scene",
    "caustics": "sound.caustics",
    "chart": "charts",
    "eigenrays": "sound.paths",
    "load_scene": "scene",
    "plan": "plan",
    "prepare": "simulate",
    "ray_paths": "sound.paths",
    "relief": "terrain",
    "shadow_zones": "sound.paths",
    "simulate": "simulate",
    "simulate_blocks": "simulate",
}
__all__ = list(_HOMES)


class _Package(ModuleType):
    """A package whose functions `plan`, `simulate` and `chart` are not hidden by the modules they live in."""

    def __getattr__(self, name: str) -> Any:
        """Import a public name when it is first asked for, so that no command waits for what it does not use."""
        if name not in _HOMES:
            raise AttributeError(f"module 'insonify' has no attribute {name!r}")
        value = getattr(import_module(f"insonify.{_HOMES[name]}"), name)
        super().__setattr__(name, value)
        return value

    def __setattr__(self, name: str, value: Any) -> None:
        """Refuse only a submodule that would take the place of a public function."""
        if not (name in _HOMES and isinstance(value, ModuleType)):
            super().__setattr__(name, value)


sys.modules[__name__].__class__ = _Package
