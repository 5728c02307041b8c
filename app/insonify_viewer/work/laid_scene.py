"""A scene on its bed, before it is planned: what the three-dimensional view needs of it."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from insonify.kernels.common.types import Poses, SceneArrays
    from insonify.packing.packed_scene import PackedScene
    from insonify.scene import Scene
    from insonify.terrain import AnyGround
    from insonify.tow.line import TowLine

    Pings = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class LaidScene:
    """A scene with its ground and arrays; it can be shown, but not yet traced."""

    packed: PackedScene  # the scene, its ground and its arrays

    @property
    def scene(self) -> Scene:
        """The declaration."""
        return self.packed.scene

    @property
    def ground(self) -> AnyGround:
        """The bed."""
        return self.packed.ground

    @property
    def arrays(self) -> SceneArrays:
        """The scene as tracers take it."""
        return self.packed.arrays

    def poses(self, pings: Pings) -> Poses:
        """Position and attitude of the sonar at the given pings."""
        # lazy: loaded on the worker; the window opens before Numba is loaded
        from insonify.tow.poses import make_poses

        return make_poses(self.scene, self.ground, pings)

    def line(self, pings: Pings) -> TowLine:
        """Positions and headings along the line of the tow."""
        # lazy: loaded on the worker; the window opens before Numba is loaded
        from insonify.tow.line import tow_line_at

        return tow_line_at(self.scene, pings)


def is_same_ground(one: AnyGround, other: AnyGround) -> bool:
    """Whether two grounds hold the very same arrays, at the same place, of the same materials."""
    if type(one) is not type(other):
        return False
    parts: list[tuple[Any, Any]] = [
        (getattr(one, field.name), getattr(other, field.name)) for field in fields(one) if field.init
    ]
    return all(a is b or (not isinstance(a, np.ndarray) and bool(a == b)) for a, b in parts)
