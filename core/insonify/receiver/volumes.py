"""Mean echoes of schools and plumes, which differ from ping to ping."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from insonify.kernels.common.types import Poses, SceneArrays
from insonify.kernels.rays.volumes import EchoPoints, add_volume_echoes
from insonify.receiver.levels import power
from insonify.scene import Scene
from insonify.scene.volumes import Volume
from insonify.terrain import AnyGround
from insonify.tow.poses import make_poses

TOGETHER = 256  # points of a group that a beam takes in or passes over


@dataclass(frozen=True, eq=False)
class VolumeEchoes:
    """Echoes of the volumes of a scene."""

    arrays: SceneArrays  # beam, bins and range factors
    poses: Callable[[NDArray[np.int64]], Poses]  # from ping numbers to poses of the sonar
    points: tuple[EchoPoints, ...]  # points by which each volume is sampled

    def energy(self, pings: NDArray[np.int64]) -> NDArray[np.float32]:
        """Mean energy for a pulse of one bin, (n, 2, bins)."""
        out, poses = np.zeros((pings.size, 2, self.arrays.bins), np.float32), self.poses(pings)
        for points in self.points:
            add_volume_echoes(self.arrays, poses, points, out)
        return out

    def energies(self, poses: Poses) -> NDArray[np.float32]:
        """Mean energy of each volume for a pulse of one bin, (volumes, n, 2, bins)."""
        out = np.zeros((len(self.points), poses.x.size, 2, self.arrays.bins), np.float32)
        for points, own in zip(self.points, out):
            add_volume_echoes(self.arrays, poses, points, own)
        return out


def make_volume_echoes(scene: Scene, arrays: SceneArrays, ground: AnyGround) -> VolumeEchoes | None:
    """Prepare the volumes that a scene declares, None where it declares none."""
    if not scene.volumes:
        return None
    points = tuple(_echo_points(*_in_water(volume, ground)) for volume in scene.volumes)
    return VolumeEchoes(arrays, lambda pings: make_poses(scene, ground, pings), points)


def _echo_points(place: NDArray[np.float64], strength: float) -> EchoPoints:
    """Points of one volume in groups, with the cross section of each."""
    groups = _groups(place)
    corners = np.array([(group.min(axis=0), group.max(axis=0)) for group in groups]).reshape(-1, 2, 3)
    return EchoPoints(
        place=np.concatenate([np.empty((0, 3)), *groups]),
        strength=np.full(len(place), strength),
        end=np.cumsum([len(group) for group in groups], dtype=np.int64),
        centre=corners.mean(axis=1),
        bound=0.5 * np.linalg.norm(corners[:, 1] - corners[:, 0], axis=1),
    )


def _groups(place: NDArray[np.float64]) -> list[NDArray[np.float64]]:
    """Points in groups of neighbours, halved along their longest side, so that a beam passes over most of them."""
    if len(place) <= TOGETHER:
        return [place] if len(place) else []
    ordered = place[np.argsort(place[:, np.argmax(np.ptp(place, axis=0))], kind="stable")]
    return [*_groups(ordered[: len(place) // 2]), *_groups(ordered[len(place) // 2 :])]


def _in_water(volume: Volume, ground: AnyGround) -> tuple[NDArray[np.float64], float]:
    """Points of a volume that lie in the water, above the datum, and the cross section of each, in m²."""
    points, each = volume.sample()
    place = points - np.array([0.0, 0.0, ground.datum])
    below_bed = place[:, 2] < ground.height_at(place[:, 0], place[:, 1])  # NaN, where there is no bed, compares false
    return place[~below_bed & (points[:, 2] < 0.0)], power(volume.strength) * each
