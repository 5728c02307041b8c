"""Kinds that a package of somebody else may bring: a torus, a map in halves and a material."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Literal

import numpy as np

from insonify.scene import Scene, edit, load_scene
from insonify.scene.base import parameter
from insonify.scene.materials import MATERIAL_MAPS, MATERIALS, Cells, CompositeMap
from insonify.scene.targets import TARGETS, Posed
from insonify.scene.targets.shape import Shape

OWN_MATERIALS = Path(__file__).parent / "own_materials"
AROUND, ACROSS = 96, 32


@contextmanager
def own_kinds() -> Iterator[None]:
    """Know the kinds within the block."""
    with TARGETS.without("torus"), MATERIAL_MAPS.without("halves"), MATERIALS.including(OWN_MATERIALS):
        declare_torus()
        declare_halves()
        yield


def declare_torus() -> None:
    """Declare a shape by its fields and triangles alone."""

    class Torus(Posed):
        """A ring that lies flat."""

        kind: Literal["torus"] = "torus"
        radius: float = parameter(2.0, unit="m", description="of the ring", gt=0.0, slider=(0.1, 10.0))
        tube: float = parameter(0.5, unit="m", description="radius of the tube", gt=0.0, slider=(0.05, 2.0), log=True)

        def shape(self) -> Shape:
            u, v = (2.0 * np.pi * np.arange(count + 1) / count for count in (AROUND, ACROSS))
            level = (self.radius + self.tube * np.cos(v))[:, None]
            height = np.broadcast_to((self.tube * np.sin(v))[:, None], (v.size, u.size))
            p = np.stack([level * np.cos(u), level * np.sin(u), height], axis=-1)
            a, b, c, d = p[:-1, :-1], p[:-1, 1:], p[1:, 1:], p[1:, :-1]
            return Shape(triangles=np.concatenate([np.stack([a, b, c], -2), np.stack([a, c, d], -2)]).reshape(-1, 3, 3))


def declare_halves() -> None:
    """Declare a map by its fields and indices alone."""

    class Halves(CompositeMap):
        """One material to port of a line along x, another to starboard."""

        kind: Literal["halves"] = "halves"
        border: float = parameter(0.0, unit="m", description="y of the border", slider=(-50.0, 50.0))

        def indices(self, cells: Cells) -> np.ndarray:
            _, y = cells.centres()
            return np.repeat((y % cells.size[1] > self.border)[:, None], cells.shape[1], axis=1).astype(np.uint8)


def ring_scene() -> Scene:
    """A torus of coral on a level bed."""
    ring = {"kind": "torus", "position": [5.0, 18.0], "material": "coral"}
    changes = {"targets": [ring], "seabed.relief": "flat", "sonar.range": 40.0, "sonar.bins": 200, "track.pings": 80}
    return edit(load_scene("default"), changes)
