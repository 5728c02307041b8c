"""Water column: reverberation of water and surface, and schools and plumes, which differ from ping to ping."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Self

import numpy as np

from insonify.acoustics.pulses import Taps
from insonify.acoustics.resolution_cell import surface_echo, volume_echo
from insonify.arrays import Floats, Integers, Singles
from insonify.kernels.common.types import Poses, SceneArrays
from insonify.kernels.rays.volumes import EchoPoints, add_volume_echoes
from insonify.receiver.stage import ReceiverSetup, Sound, Stage, power, spread_echoes
from insonify.scene.volumes import Volume
from insonify.terrain import AnyGround
from insonify.tow.poses import make_poses

MOST_POINTS = 256  # of a group that a beam includes or skips as one


@dataclass(frozen=True, eq=False)
class VolumeEchoes:
    """Echoes of schools and plumes for a pulse of one bin."""

    arrays: SceneArrays  # beam, bins and range factors
    poses: Callable[[Integers], Poses]  # from ping numbers to poses of the sonar
    points: tuple[EchoPoints, ...]  # points by which each volume is sampled

    def energy(self, pings: Integers) -> Singles:
        """Mean energy of all volumes, (n, 2, bins)."""
        out, poses = np.zeros((pings.size, 2, self.arrays.bins), np.float32), self.poses(pings)
        for points in self.points:
            add_volume_echoes(self.arrays, poses, points, out)
        return out

    def energies(self, poses: Poses) -> Singles:
        """Mean energy of each volume, (volumes, n, 2, bins)."""
        out = np.zeros((len(self.points), poses.x.size, 2, self.arrays.bins), np.float32)
        for points, own in zip(self.points, out):
            add_volume_echoes(self.arrays, poses, points, own)
        return out


@dataclass(frozen=True, eq=False)
class WaterColumn(Stage):
    """Echoes of the water, its surface, schools and plumes."""

    name, detail, rank = "water column", "reverberation, schools and plumes", 20.0
    adds_waves = True
    reverberation: Floats  # (bins,) mean intensity of volume and surface reverberation after the pulse
    taps: Taps  # of the pulse
    volumes: VolumeEchoes | None

    @classmethod
    def prepare(cls, setup: ReceiverSetup) -> Self | None:
        """None where nothing but the bed and targets echoes."""
        scene, ground, volumes = setup.scene, setup.ground, None
        if scene.volumes and ground is not None:
            points = tuple(_echo_points(*_in_water(volume, ground)) for volume in scene.volumes)
            volumes = VolumeEchoes(setup.arrays, lambda pings: make_poses(scene, ground, pings), points)
        water = np.zeros(setup.arrays.bins) + sum(echo for _, _, echo in reverberation_curves(setup))
        reverberation = spread_echoes(setup.taps, water[None, None].astype(np.float32))[0, 0].astype(np.float64)
        return cls(reverberation, setup.taps, volumes) if volumes is not None or reverberation.any() else None

    def act_on_energies(self, sound: Sound) -> None:
        """Add mean echoes, or waves to the background of speckled ones."""
        echoes = np.tile(self.reverberation.astype(np.float32), (sound.pings.size, 1, 1))
        if self.volumes is not None:
            echoes = echoes + spread_echoes(self.taps, self.volumes.energy(sound.pings))
        if sound.phased:
            sound.add_background(echoes)
        else:
            sound.energy = sound.energy + echoes


def reverberation_curves(setup: ReceiverSetup) -> Iterator[tuple[str, float, Floats]]:
    """Yield name, strength (dB) and mean intensity for a pulse of one bin, (bins,), of each declared reverberation."""
    declared = setup.scene.receiver.reverberation
    if declared.of_volume is not None:
        echo = power(declared.of_volume) * volume_echo(setup.arrays, setup.altitude, setup.depth)
        yield "volume reverberation", declared.of_volume, echo
    if declared.of_surface is not None:
        echo = power(declared.of_surface) * surface_echo(setup.arrays, setup.depth)
        yield "surface reverberation", declared.of_surface, echo


def _echo_points(place: Floats, strength: float) -> EchoPoints:
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


def _groups(place: Floats) -> list[Floats]:
    """Points in groups of neighbours, halved along their longest side, so that a beam skips most of them."""
    if len(place) <= MOST_POINTS:
        return [place] if len(place) else []
    ordered = place[np.argsort(place[:, np.argmax(np.ptp(place, axis=0))], kind="stable")]
    return [*_groups(ordered[: len(place) // 2]), *_groups(ordered[len(place) // 2 :])]


def _in_water(volume: Volume, ground: AnyGround) -> tuple[Floats, float]:
    """Points of a volume that lie in the water, above the datum, and the cross section of each, in m²."""
    points, each = volume.sample()
    return points_in_water(points, ground), power(volume.strength) * each


def points_in_water(points: Floats, ground: AnyGround) -> Floats:
    """Return the points, z up from the sea surface, that lie in the water, with z up from the datum."""
    place = points - np.array([0.0, 0.0, ground.datum])
    below_bed = place[:, 2] < ground.height_at(place[:, 0], place[:, 1])  # NaN, where there is no bed, compares false
    return np.asarray(place[~below_bed & (points[:, 2] < 0.0)])
