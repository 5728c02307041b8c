"""Targets as bodies: posed on the bed, packed for the kernels."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from insonify.kernels.types import FRUSTUM, SPHERE, Mesh, Solids, empty_mesh
from insonify.scene import Scene, SceneError
from insonify.scene.materials import Reflectivity
from insonify.scene.targets import Pipe
from insonify.terrain.ground import Ground
from insonify.tracers.poses import exact_cos

MAX_PIPE_SAMPLES = 2048


def make_bodies(scene: Scene, ground: Ground) -> tuple[Solids, Mesh, list[Reflectivity]]:
    """Pose every target; its material joins the table of the ground's.

    Raises
    ------
    SceneError
        If a target lies where there is no bed to carry it.
    """
    reflectivities = list(ground.reflectivities)
    rows: list[tuple[int, NDArray[np.float64], NDArray[np.float64], float, float, int, int]] = []
    for number, target in enumerate(scene.targets):
        reflectivities.append(target.material.reflectivity)
        material = len(reflectivities) - 1
        joints = _pipe_joints(target, ground, number) if isinstance(target, Pipe) else None
        if joints is None:
            centre = _sphere_centre(target.position, target.radius, ground, number)
            rows.append((SPHERE, centre, np.zeros(3), 0.0, target.radius, material, number))
            continue
        for first, last in pairwise(joints):
            length = float(np.linalg.norm(last - first))
            rows.append((FRUSTUM, first, (last - first) / length, length, target.radius, material, number))
        # A ball in every elbow closes the wedge between two straight stretches.
        rows.extend((SPHERE, joint, np.zeros(3), 0.0, target.radius, material, number) for joint in joints[1:-1])
    columns = list(zip(*rows)) if rows else [()] * 7
    solids = Solids(
        shape=np.array(columns[0], dtype=np.int64),
        start=np.array(columns[1], dtype=np.float64).reshape(-1, 3),
        axis=np.array(columns[2], dtype=np.float64).reshape(-1, 3),
        length=np.array(columns[3], dtype=np.float64),
        radius=np.array(columns[4], dtype=np.float64),
        taper=np.zeros(len(rows)),
        material=np.array(columns[5], dtype=np.int64),
        target=np.array(columns[6], dtype=np.int64),
    )
    return solids, empty_mesh(), reflectivities


def _sphere_centre(position: tuple[float, ...], radius: float, ground: Ground, number: int) -> NDArray[np.float64]:
    if len(position) == 3:
        return np.array([position[0], position[1], position[2] - ground.datum])
    height = float(ground.height_at(np.array([position[0]]), np.array([position[1]]))[0])
    _refuse_missing_bed(height, number, position)
    return np.array([position[0], position[1], height + radius])


def _pipe_joints(pipe: Pipe, ground: Ground, number: int) -> list[NDArray[np.float64]]:
    """Points on the axis between which a pipe is straight.

    Laid on a rough bed, a stiff pipe follows the straight line that fits the heights under it; the gap counts from
    that line.
    """
    direction = np.array([exact_cos(pipe.heading), exact_cos(pipe.heading - 90.0)])
    half = pipe.length / 2.0
    if len(pipe.position) == 3:
        along, gaps = np.array([-half, half]), np.zeros(2)
        support = np.full(2, pipe.position[2] - ground.datum - pipe.radius)
    else:
        stations = ((0.0, pipe.gap),) if isinstance(pipe.gap, float) else pipe.gap
        inner = [station[0] for station in stations if -half < station[0] < half]
        along = np.array([-half, *inner, half])
        gaps = np.interp(along, [s[0] for s in stations], [s[1] for s in stations])
        samples = np.linspace(-half, half, int(np.clip(2.0 * pipe.length / ground.spacing, 2, MAX_PIPE_SAMPLES)))
        heights = ground.height_at(pipe.position[0] + samples * direction[0], pipe.position[1] + samples * direction[1])
        _refuse_missing_bed(float(heights.sum()), number, pipe.position)
        slope, level = np.polyfit(samples, heights, 1) if np.ptp(heights) > 0 else (0.0, heights[0])
        support = level + slope * along
    z = support + gaps + pipe.radius
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
