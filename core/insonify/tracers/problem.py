"""The border between declarations and kernels: a scene becomes arrays and numbers, here and nowhere else."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from insonify.kernels.types import CYLINDER, LIGHT, SONAR, SPHERE, Bed, Poses, Problem, Solids
from insonify.scene import Scene, SceneError
from insonify.scene.materials import Reflectivity
from insonify.scene.sonar import Fan
from insonify.scene.targets import Pipe
from insonify.sound.absorption import absorption_coefficient
from insonify.terrain.ground import Ground

MAX_PIPE_SAMPLES = 2048


def make_problem(scene: Scene, ground: Ground) -> Problem:
    """Pack a scene and its ground for the tracers.

    Raises
    ------
    SceneError
        If a target lies where there is no bed to carry it.
    """
    reflectivities = list(ground.reflectivities)
    solids = _solids(scene, ground, reflectivities)
    sonar = scene.sonar
    bin_length = sonar.range / sonar.bins / scene.water.range_scale
    centres = (np.arange(sonar.bins, dtype=np.float64) + 0.5) * np.float64(bin_length)
    return Problem(
        bed=make_bed(ground),
        solids=solids,
        reflectivity=np.array(reflectivities, dtype=np.float64).reshape(-1, 3),
        law=SONAR if sonar.law == "sonar" else LIGHT,
        half_width=math.radians(sonar.beam.width) / 2.0 if isinstance(sonar.beam, Fan) else 0.0,
        bins=sonar.bins,
        bin_length=bin_length,
        range_factor=range_factor(scene, centres, sonar_height(scene, ground) + ground.datum),
    )


def make_bed(ground: Ground) -> Bed:
    """Lay a ground's heights out for the kernels, both ways round."""
    finite = ground.heights[np.isfinite(ground.heights)]
    heights = np.ascontiguousarray(ground.heights, dtype=np.float32)
    return Bed(
        heights=heights,
        transposed=np.ascontiguousarray(heights.T),
        materials=np.ascontiguousarray(ground.materials, dtype=np.uint8),
        x0=float(ground.x0),
        y0=float(ground.y0),
        spacing=float(ground.spacing),
        periodic=bool(ground.periodic),
        low=float(finite.min()),
        high=float(finite.max()),
        mapped=len(ground.reflectivities) > 1,
    )


def sonar_height(scene: Scene, ground: Ground) -> float:
    """Height of the sonar above the datum, in metres."""
    return -scene.track.depth - ground.datum if scene.track.depth is not None else scene.altitude


def make_poses(scene: Scene, ground: Ground, pings: NDArray[np.int64]) -> Poses:
    """Place the sonar at the given pings; numbers beyond the track's last ping go on along its line."""
    track = scene.track
    heading = math.radians(track.heading)
    along = np.asarray(pings, dtype=np.float64) * (track.speed / scene.sonar.ping_rate)
    return Poses(
        x=track.start[0] + _exact_cos(track.heading) * along,
        y=track.start[1] + _exact_cos(track.heading - 90.0) * along,
        z=np.full(along.shape, sonar_height(scene, ground)),
        heading=np.full(along.shape, heading),
    )


def _exact_cos(degrees: float) -> float:
    """Cosine that is exactly 0 or ±1 on the axes, so that a track along the grid stays on it."""
    quarter = degrees / 90.0
    return (1.0, 0.0, -1.0, 0.0)[int(quarter) % 4] if quarter == int(quarter) else math.cos(math.radians(degrees))


def range_factor(scene: Scene, slant_range: NDArray[np.float64], depth: float) -> NDArray[np.float64]:
    """Two-way spreading r⁻⁴ (law `sonar`; the light of law `light` does not spread) and absorption."""
    loss = absorption_coefficient(scene.water.absorption, scene.sonar.frequency, abs(depth))
    factor = np.exp(-4.0 * loss * slant_range)  # intensity, there and back
    return factor / slant_range**4 if scene.sonar.law == "sonar" else factor


def _solids(scene: Scene, ground: Ground, reflectivities: list[Reflectivity]) -> Solids:
    """Pose every target; its material joins the table."""
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
            rows.append((CYLINDER, first, (last - first) / length, length, target.radius, material, number))
        # A ball in every elbow closes the wedge between two straight stretches.
        rows.extend((SPHERE, joint, np.zeros(3), 0.0, target.radius, material, number) for joint in joints[1:-1])
    columns = list(zip(*rows)) if rows else [()] * 7
    return Solids(
        shape=np.array(columns[0], dtype=np.int64),
        start=np.array(columns[1], dtype=np.float64).reshape(-1, 3),
        axis=np.array(columns[2], dtype=np.float64).reshape(-1, 3),
        length=np.array(columns[3], dtype=np.float64),
        radius=np.array(columns[4], dtype=np.float64),
        material=np.array(columns[5], dtype=np.int64),
        target=np.array(columns[6], dtype=np.int64),
    )


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
    direction = np.array([_exact_cos(pipe.heading), _exact_cos(pipe.heading - 90.0)])
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
