"""Sea surfaces, one file a kind."""

from __future__ import annotations

from insonify.scene.base import Choice
from insonify.scene.kinds import Family

SURFACES = Family("surfaces", "insonify.scene.water.surfaces")
WAYS = ("surface_bottom", "surface_bottom_surface", "second_bottom", "surface_echo")


class SurfaceKind(Choice):
    """The sea surface."""

    family = SURFACES

    @property
    def reflects(self) -> bool:
        """Whether the sea surface reflects sound."""
        return False

    @property
    def paths(self) -> tuple[bool, bool, bool, bool]:
        """Whether each multipath by the surface is modelled, in the order of `WAYS`."""
        return False, False, False, False

    @property
    def rms_height(self) -> float:
        """Rms height of the waves, in metres."""
        return 0.0

    @property
    def slope_variance(self) -> float:
        """Variance of the slope of the waves along one direction."""
        return 0.0
