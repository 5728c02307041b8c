"""Kinds that a package of somebody else may bring: two shapes, a map in halves and a material."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Literal

import numpy as np
import pytest

from insonify.scene import Scene, edit, load_scene
from insonify.scene.base import parameter
from insonify.scene.seabed.materials import MATERIAL_MAPS, Cells, CompositeMap
from insonify.scene.seabed.materials.catalogue import MATERIALS, read_materials
from insonify.scene.targets import TARGETS, Body, Posed
from insonify.scene.targets.shape import Shape, ball, frustum
from own_things import forgetting

OWN_MATERIALS = Path(__file__).parent / "own_materials"
AROUND, ACROSS = 96, 32


@contextmanager
def own_kinds() -> Iterator[None]:
    with forgetting(TARGETS, MATERIAL_MAPS), pytest.MonkeyPatch.context() as patch:
        patch.setattr(MATERIALS, "data", MATERIALS.data | read_materials(OWN_MATERIALS))
        _declare()
        yield


def _declare() -> None:
    """Declare shapes by fields and solids or triangles alone, and a map by fields and indices alone."""

    class Dumbbell(Body):
        """Two balls on a bar along x."""

        kind: Literal["dumbbell"] = "dumbbell"
        radius: float = parameter(0.6, unit="m", description="of the balls", gt=0.0, slider=(0.05, 2.0))
        length: float = parameter(3.0, unit="m", description="between the balls", gt=0.0, slider=(0.1, 10.0))

        def shape(self) -> Shape:
            end = np.array([0.5 * self.length, 0.0, 0.0])
            bar = frustum(-end, end, 0.5 * self.radius, 0.3 * self.radius)
            return Shape((ball(self.radius, -end), bar, ball(self.radius, end)))

    class Hoop(Posed):
        """A ring that lies flat."""

        kind: Literal["hoop"] = "hoop"
        radius: float = parameter(2.0, unit="m", description="of the ring", gt=0.0, slider=(0.1, 10.0))
        tube: float = parameter(0.5, unit="m", description="radius of the tube", gt=0.0, slider=(0.05, 2.0), log=True)

        def shape(self) -> Shape:
            u, v = (2.0 * np.pi * np.arange(count + 1) / count for count in (AROUND, ACROSS))
            level = (self.radius + self.tube * np.cos(v))[:, None]
            height = np.broadcast_to((self.tube * np.sin(v))[:, None], (v.size, u.size))
            p = np.stack([level * np.cos(u), level * np.sin(u), height], axis=-1)
            a, b, c, d = p[:-1, :-1], p[:-1, 1:], p[1:, 1:], p[1:, :-1]
            return Shape(triangles=np.concatenate([np.stack([a, b, c], -2), np.stack([a, c, d], -2)]).reshape(-1, 3, 3))

    class Halves(CompositeMap):
        """One material to port of a line along x, another to starboard."""

        kind: Literal["halves"] = "halves"
        border: float = parameter(0.0, unit="m", description="y of the border", slider=(-50.0, 50.0))

        def indices(self, cells: Cells) -> np.ndarray:
            _, y = cells.centres()
            return np.repeat((y % cells.size[1] > self.border)[:, None], cells.shape[1], axis=1).astype(np.uint8)


def own_scene(kind: str = "hoop") -> Scene:
    """A shape of coral on a level bed."""
    target = {"kind": kind, "position": [5.0, 18.0], "material": "coral"}
    changes = {"targets": [target], "seabed.relief": "flat", "sonar.range": 40.0, "sonar.bins": 200, "track.pings": 80}
    return edit(load_scene("default"), changes)
