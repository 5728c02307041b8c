"""The water of a scene as kernels see it."""

from __future__ import annotations

from insonify.kernels.types import Water, still_water
from insonify.scene import Scene


def make_water(scene: Scene, datum: float) -> Water:
    """Lay out the speed of sound over height.

    Parameters
    ----------
    scene : Scene
        Whose water it is.
    datum : float
        Height of the mean bed above the sea surface, in metres (negative).

    Returns
    -------
    Water
    """
    return still_water(scene.water.sound_speed, -datum)
