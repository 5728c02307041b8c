"""Side-scan sonar simulation: scene in, record out."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from insonify.accuracy.charts.kinds.accuracy import chart
    from insonify.acoustics.paths import caustics, eigenrays, ray_paths, shadow_zones
    from insonify.explanation.pixel import explain_pixel
    from insonify.inversion.learning import learn
    from insonify.planning import plan
    from insonify.scene import Scene, SceneError, load_scene
    from insonify.simulation import prepare, simulate, simulate_blocks
    from insonify.terrain import relief

__all__ = [
    "Scene",
    "SceneError",
    "caustics",
    "chart",
    "eigenrays",
    "explain_pixel",
    "learn",
    "load_scene",
    "plan",
    "prepare",
    "ray_paths",
    "relief",
    "shadow_zones",
    "simulate",
    "simulate_blocks",
]

# Public names are imported when they are first used, so that a command loads only the modules that it needs.
_MODULES = {
    "Scene": "scene",
    "SceneError": "scene",
    "caustics": "acoustics.paths",
    "chart": "accuracy.charts.kinds.accuracy",
    "eigenrays": "acoustics.paths",
    "explain_pixel": "explanation.pixel",
    "learn": "inversion.learning",
    "load_scene": "scene",
    "plan": "planning",
    "prepare": "simulation",
    "ray_paths": "acoustics.paths",
    "relief": "terrain",
    "shadow_zones": "acoustics.paths",
    "simulate": "simulation",
    "simulate_blocks": "simulation",
}


def __getattr__(name: str) -> Any:
    """Import a public name on first use."""
    if name not in _MODULES:
        raise AttributeError(f"module 'insonify' has no attribute {name!r}")
    value = getattr(import_module(f"insonify.{_MODULES[name]}"), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    """List the public names, imported or not."""
    return sorted([*globals(), *__all__])
