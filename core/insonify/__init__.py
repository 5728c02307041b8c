"""Side-scan sonar simulation: scene in, record out."""

import os
import sys


def _leave_current_folder() -> None:
    """Take the current folder, which ``python -m insonify`` puts first, from the places where modules are found."""
    # A json.py beside somebody's data is no part of this program. The folder comes last if it holds this package.
    words = sys.orig_argv
    options = [place for place, word in enumerate(words[:-1]) if word.startswith("-") and word.endswith("m")]
    run = words[options[0] + 1] if options else ""
    # Python looks for the module to run as long as this word stands for its path.
    if sys.argv[:1] == ["-m"] and run in ("insonify", "insonify_viewer") and sys.path[0] == os.getcwd():
        here = sys.path.pop(0)
        sys.path += [here] * (os.path.dirname(os.path.dirname(os.path.abspath(__file__))) == here)


_leave_current_folder()  # before any module is imported that Python has not loaded yet

from importlib import import_module  # noqa: E402
from typing import TYPE_CHECKING, Any  # noqa: E402

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
