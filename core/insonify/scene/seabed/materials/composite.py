"""Base of maps of several materials."""

from __future__ import annotations

from insonify.scene.base import parameter
from insonify.scene.seabed.materials.base import MaterialMap
from insonify.scene.seabed.materials.uniform import Material


class CompositeMap(MaterialMap):
    """A map of several materials; a kind declares its `indices`."""

    of: tuple[Material, ...] = parameter(description="materials of the map", min_length=2, max_length=32)

    @property
    def materials(self) -> tuple[Material, ...]:
        """The materials of the map."""
        return self.of

    @property
    def layout(self) -> CompositeMap:
        """The map without the scattering parameters of its materials, on which no border depends."""
        return self.model_copy(update={"of": (Material(),) * len(self.of)})
