"""Solids and triangles of all targets in world coordinates, as arrays for the kernels."""

from collections.abc import Sequence

import numpy as np

from insonify.arrays import Integers
from insonify.errors import located
from insonify.io.meshes import has_area
from insonify.kernels.common.types import FRUSTUM, SPHERE, Mesh, Solids
from insonify.kernels.geometry.bvh import build_mesh
from insonify.scene import Scene
from insonify.scene.seabed.materials.catalogue import Reflectivity
from insonify.scene.targets.shape import Shape, Solid
from insonify.terrain import AnyGround


def make_bodies(scene: Scene, ground: AnyGround) -> tuple[Solids, Mesh, list[Reflectivity]]:
    """Pose every target; its material joins the table of the ground's."""
    shapes = []
    for number, declared in enumerate(scene.targets):
        with located(f"targets.{number}."):
            shapes.append(declared.placed(ground))
    frequency = scene.sonar.scattering_frequency
    materials = [declared.material.reflectivity_at(frequency) for declared in scene.targets]
    before = len(ground.reflectivities)
    target = _numbers([len(shape.solids) for shape in shapes])
    solids = pack_solids([solid for shape in shapes for solid in shape.solids], before + target, target)
    target = _numbers([len(shape.triangles) for shape in shapes])
    corners = np.concatenate([Shape().triangles, *(shape.triangles for shape in shapes)])
    whole = has_area(corners)  # triangles far smaller than their distance from the origin lose it by rounding
    closed = np.array([shape.closed for shape in shapes], np.bool_)[target]
    mesh = build_mesh(corners[whole], before + target[whole], target[whole], closed[whole])
    return solids, mesh, [*ground.reflectivities, *materials]


def pack_solids(rows: Sequence[Solid], material: Integers, target: Integers) -> Solids:
    """Pack balls and frustums for the kernels, with the row of each one's material and its target's number."""
    return Solids(
        shape=np.array([SPHERE if row.is_ball else FRUSTUM for row in rows], dtype=np.int64),
        start=np.array([row.start for row in rows], dtype=np.float64).reshape(-1, 3),
        axis=np.array([row.axis for row in rows], dtype=np.float64).reshape(-1, 3),
        length=np.array([row.length for row in rows], dtype=np.float64),
        radius=np.array([row.radius for row in rows], dtype=np.float64),
        taper=np.array([row.taper for row in rows], dtype=np.float64),
        material=material,
        target=target,
    )


def _numbers(counts: list[int]) -> Integers:
    """Repeat every target's number as often as it has solids or triangles."""
    return np.repeat(np.arange(len(counts)), counts).astype(np.int64)
