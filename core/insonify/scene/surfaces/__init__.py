"""Sea surfaces, one file a kind."""

from __future__ import annotations

from insonify.scene.base import Choice
from insonify.scene.kinds import Family

SURFACES = Family("surfaces", "insonify.scene.surfaces")
WAYS = ("surface_bottom", "surface_bottom_surface", "second_bottom", "surface_echo")


class SurfaceKind(Choice):
    """The sea surface."""

    family = SURFACES
