"""Bundled scenes that name a partner."""

from __future__ import annotations

from functools import cache

from insonify.scene import Scene, bundled_scenes, load_scene


@cache
def find_pairs() -> dict[str, Scene]:
    """Find the bundled scenes that name a partner, by name; of two that name each other the second, to stand as B."""
    found: dict[str, Scene] = {}
    for name, path in bundled_scenes().items():
        scene = load_scene(path)
        for partner in scene.partner or ():
            found.pop(partner, None)
        if scene.partner:
            found[name] = scene
    return found
