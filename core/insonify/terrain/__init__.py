"""Terrain: heights and materials of the bed that a scene declares."""

from insonify.terrain.build import build_excerpt, build_ground, relief, relief_picture
from insonify.terrain.endless_ground import AnyGround, EndlessGround, StoredWindow
from insonify.terrain.ground import Ground

__all__ = [
    "AnyGround",
    "EndlessGround",
    "Ground",
    "StoredWindow",
    "build_excerpt",
    "build_ground",
    "relief",
    "relief_picture",
]
