"""Ways in which record A is shown beside the live record B, and the bundled pairs of scenes."""

from enum import Enum
from functools import cache

from insonify.scene import Scene, bundled_scenes, load_scene


class Arrangement(Enum):
    """How two records share the room; the values are what the person reads."""

    ALONE = "one at a time"
    """B, or A while a key is held."""
    BESIDE = "side by side"
    WIPED = "wiped"
    """A left of a line that is dragged, B right of it."""
    DIFFERENCE = "difference"
    """Ratio of B to A, in dB."""


@cache
def find_pairs() -> dict[str, Scene]:
    """Find the bundled scenes that name a partner, by name; of two that name each other, the second, as B."""
    found: dict[str, Scene] = {}
    for name, path in bundled_scenes().items():
        scene = load_scene(path)
        for partner in scene.partner or ():
            found.pop(partner, None)
        if scene.partner:
            found[name] = scene
    return found
