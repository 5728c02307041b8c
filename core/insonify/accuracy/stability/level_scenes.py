"""Small scenes for cases, and grounds made of given heights."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from insonify.kernels.common.types import Poses
from insonify.packing.scene_arrays import make_bed
from insonify.scene import Scene, edit
from insonify.scene.seabed.materials import Reflectivity
from insonify.simulation import Simulation, prepare
from insonify.terrain import Ground

LEVEL: dict[str, Any] = {
    "seabed.material": {"name": "medium_sand", "diffuse": 1.0, "specular": 0.0},
    "sonar.beam": "knife",
    "sonar.pulse": "ideal",
    "track.altitude": 10.0,
    "track.pings": 1,
}


def make_level_scene(changes: Mapping[str, Any] | None = None) -> Scene:
    """Make a scene of a level Lambert bed, one ping of a knife-edge beam with an ideal pulse, and change it."""
    return edit(Scene(), LEVEL | dict(changes or {}))


def prepare_over_heights(
    scene: Scene, heights: ArrayLike, spacing: float, *, x0: float = 0.0, y0: float = 0.0
) -> Simulation:
    """Make a scene ready over a bed of given heights that ends at its outermost nodes."""
    simulation = prepare(scene)
    bed = make_bed(make_ground(heights, spacing, x0=x0, y0=y0))
    return replace(simulation, arrays=simulation.arrays._replace(bed=bed))


def make_ground(heights: ArrayLike, spacing: float, *, x0: float = 0.0, y0: float = 0.0) -> Ground:
    """Make a ground of given heights, as `over` takes them."""
    z = np.asarray(heights, dtype=np.float32)
    materials = np.zeros(z.shape, dtype=np.uint8)
    return Ground(z, materials, ("bed",), (Reflectivity(1.0, 0.0, 1.0),), x0, y0, spacing, periodic=False, datum=0.0)


def make_pose(x: float, y: float, z: float, heading: float = 0.0) -> Poses:
    """Place a level fish; z above the datum, heading in radians."""
    return Poses(*(np.array([value]) for value in (x, y, z, heading, 0.0, 0.0)))
