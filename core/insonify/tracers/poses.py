"""Where the sonar is at every ping."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from insonify.kernels.types import Poses
from insonify.scene import Scene
from insonify.terrain.ground import Ground


def sonar_height(scene: Scene, ground: Ground) -> float:
    """Height of the sonar above the datum, in metres."""
    return -scene.track.depth - ground.datum if scene.track.depth is not None else scene.altitude


def make_poses(scene: Scene, ground: Ground, pings: NDArray[np.int64]) -> Poses:
    """Place the sonar at the given pings; numbers beyond the track's last ping go on along its line."""
    track = scene.track
    heading = math.radians(track.heading)
    along = np.asarray(pings, dtype=np.float64) * (track.speed / scene.sonar.ping_rate)
    return Poses(
        x=track.start[0] + exact_cos(track.heading) * along,
        y=track.start[1] + exact_cos(track.heading - 90.0) * along,
        z=np.full(along.shape, sonar_height(scene, ground)),
        heading=np.full(along.shape, heading),
        pitch=np.zeros(along.shape),
        roll=np.zeros(along.shape),
    )


def exact_cos(degrees: float) -> float:
    """Cosine that is exactly 0 or ±1 on the axes, so that a track along the grid stays on it."""
    quarter = degrees / 90.0
    return (1.0, 0.0, -1.0, 0.0)[int(quarter) % 4] if quarter == int(quarter) else math.cos(math.radians(degrees))
