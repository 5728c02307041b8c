"""Targets as bodies: posed on the bed, packed for the kernels."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from insonify.io.meshes import read_mesh
from insonify.kernels.common.types import Mesh, Solids
from insonify.kernels.geometry.bvh import build_mesh
from insonify.packing.primitives import Shape, Vector, ball, block, frustum
from insonify.packing.rotation import rotation_matrix
from insonify.packing.track import exact_cos
from insonify.scene import Scene, SceneError
from insonify.scene.materials import Reflectivity
from insonify.scene.targets import AnyTarget, Box, Cone, MeshFile, Pipe, Sphere
from insonify.terrain import AnyGround

MAX_PIPE_SAMPLES = 2048


def make_bodies(scene: Scene, ground: AnyGround) -> tuple[Solids, Mesh, list[Reflectivity]]:
    """Pose every target; its material joins the table of the ground's.

    Raises
    ------
    SceneError
        If a target lies where there is no bed to carry it, or its file cannot be read.
    """
    shapes = [_posed(target, ground, number) for number, target in enumerate(scene.targets)]
    materials = [target.material.reflectivity for target in scene.targets]
    before = len(ground.reflectivities)
    return _solids(shapes, before), _mesh(shapes, before), [*ground.reflectivities, *materials]


def refuse_sonar_inside(solids: Solids, statuses: list[int]) -> None:
    """Raise if a kernel met the sonar inside a body, which it tells by -1 - the body's row.

    Raises
    ------
    SceneError
        If a status is below 0.
    """
    for status in statuses:
        if status < 0:
            target = int(solids.target[-1 - status])
            raise SceneError(f"targets.{target}.position: the sonar runs into it; move the target or raise the track")


def _solids(shapes: list[Shape], before: int) -> Solids:
    """Lay the analytic bodies of all targets out, whose materials follow those before."""
    rows = [solid for shape in shapes for solid in shape.solids]
    target = np.repeat(np.arange(len(shapes)), [len(shape.solids) for shape in shapes]).astype(np.int64)
    return Solids(
        shape=np.array([row.shape for row in rows], dtype=np.int64),
        start=np.array([row.start for row in rows], dtype=np.float64).reshape(-1, 3),
        axis=np.array([row.axis for row in rows], dtype=np.float64).reshape(-1, 3),
        length=np.array([row.length for row in rows], dtype=np.float64),
        radius=np.array([row.radius for row in rows], dtype=np.float64),
        taper=np.array([row.taper for row in rows], dtype=np.float64),
        material=before + target,
        target=target,
    )


def _mesh(shapes: list[Shape], before: int) -> Mesh:
    """Lay the triangles of all targets out, likewise."""
    target = np.repeat(np.arange(len(shapes)), [len(shape.triangles) for shape in shapes]).astype(np.int64)
    corners = np.concatenate([Shape().triangles, *(shape.triangles for shape in shapes)])
    return build_mesh(corners, before + target, target)


def _posed(target: AnyTarget, ground: AnyGround, number: int) -> Shape:
    """Shape of a target where it lies."""
    if isinstance(target, Pipe) and target.pitch is None and len(target.position) == 2:
        return _laid_pipe(target, ground, number)
    shape = _shape(target, number)
    if not isinstance(target, Sphere):
        roll = 0.0 if isinstance(target, Pipe) else target.roll
        shape = shape.turned(rotation_matrix(target.heading, target.pitch or 0.0, roll))
    x, y = target.position[:2]
    if len(target.position) == 3:
        return shape.moved(np.array([x, y, target.position[2] - ground.datum]))
    bed = float(ground.height_at(np.array([x]), np.array([y]))[0])
    _refuse_missing_bed(bed, number, target.position)
    assert isinstance(target.gap, float)  # as the scene makes sure of
    return shape.moved(np.array([x, y, bed + target.gap - shape.lowest]))


def _shape(target: AnyTarget, number: int) -> Shape:
    """Shape of a target about its centre: bow towards +x, port side towards +y, upright."""
    if isinstance(target, Sphere):
        return Shape((ball(target.radius),))
    if isinstance(target, Pipe):
        ahead = np.array([target.length / 2.0, 0.0, 0.0])
        return Shape((frustum(-ahead, ahead, target.radius, target.radius),))
    if isinstance(target, Cone):
        up = np.array([0.0, 0.0, target.height / 2.0])
        return Shape((frustum(-up, up, target.radius, 0.0),))
    if isinstance(target, Box):
        return Shape(triangles=block(target.size))
    return Shape(triangles=_from_file(target, number))


def _from_file(target: MeshFile, number: int) -> NDArray[np.float64]:
    try:
        corners = read_mesh(target.path)
    except SceneError as error:
        raise SceneError(f"targets.{number}.path: {error}") from None
    centre = 0.5 * (corners.min(axis=(0, 1)) + corners.max(axis=(0, 1)))
    return target.scale * (corners - centre)


def _laid_pipe(pipe: Pipe, ground: AnyGround, number: int) -> Shape:
    """Pipe along the bed: straight between joints, with a ball in every elbow to close the wedge there."""
    joints = _pipe_joints(pipe, ground, number)
    stretches = (frustum(first, last, pipe.radius, pipe.radius) for first, last in pairwise(joints))
    return Shape((*stretches, *(ball(pipe.radius, joint) for joint in joints[1:-1])))


def _pipe_joints(pipe: Pipe, ground: AnyGround, number: int) -> list[Vector]:
    """Points on the axis between which a pipe is straight.

    Laid on a rough bed, a stiff pipe follows the straight line that fits the heights under it; the gap counts from
    that line.
    """
    direction = np.array([exact_cos(pipe.heading), exact_cos(pipe.heading - 90.0)])
    half = pipe.length / 2.0
    stations = ((0.0, pipe.gap),) if isinstance(pipe.gap, float) else pipe.gap
    inner = [station[0] for station in stations if -half < station[0] < half]
    along = np.array([-half, *inner, half])
    gaps = np.interp(along, [s[0] for s in stations], [s[1] for s in stations])
    samples = np.linspace(-half, half, int(np.clip(2.0 * pipe.length / ground.spacing, 2, MAX_PIPE_SAMPLES)))
    heights = ground.height_at(pipe.position[0] + samples * direction[0], pipe.position[1] + samples * direction[1])
    _refuse_missing_bed(float(heights.sum()), number, pipe.position)
    slope, level = np.polyfit(samples, heights, 1) if np.ptp(heights) > 0 else (0.0, heights[0])
    z = level + slope * along + gaps + pipe.radius
    return [
        np.array([pipe.position[0] + a * direction[0], pipe.position[1] + a * direction[1], height])
        for a, height in zip(along, z)
    ]


def _refuse_missing_bed(height: float, number: int, position: tuple[float, ...]) -> None:
    if math.isnan(height):
        raise SceneError(
            f"targets.{number}.position: {list(position)} lies where there is no bed; "
            "move the target onto the grid or give its height as [x, y, z]"
        )
