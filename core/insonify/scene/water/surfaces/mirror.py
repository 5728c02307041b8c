"""Surfaces that reflect all sound."""

from __future__ import annotations

from insonify.scene.base import parameter
from insonify.scene.water.surfaces import SurfaceKind


class MirrorSurface(SurfaceKind):
    """A sea surface that reflects all sound; each path by it has a switch of its own."""

    surface_bottom: bool = parameter(True, description="paths by the surface one way and direct the other way")
    surface_bottom_surface: bool = parameter(True, description="paths by the surface both ways")
    second_bottom: bool = parameter(
        True, description="paths by the bed beneath the sonar and then the surface one way, direct the other way"
    )
    surface_echo: bool = parameter(True, description="the echo of the surface straight above the sonar")

    @property
    def reflects(self) -> bool:
        """Whether the sea surface reflects sound."""
        return True

    @property
    def paths(self) -> tuple[bool, bool, bool, bool]:
        """Which paths by the surface are switched on, in the order of `WAYS`."""
        return self.surface_bottom, self.surface_bottom_surface, self.second_bottom, self.surface_echo
