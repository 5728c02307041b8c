"""Declared water: absorption, sound speed over depth or along a line, its packing for the kernels, and refraction."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from insonify.arrays import Floats, Integers
from insonify.files import kept_until_changed
from insonify.kernels.common.types import Water, still_water
from insonify.scene import Scene
from insonify.scene.water import WaterKind
from insonify.scene.water.absorptions import NEPER_PER_DB, AbsorptionKind

DEPTHS = 64  # at which the sound speed between sonar and bed is sampled


def absorption_coefficient(absorption: AbsorptionKind, frequency: float, depth: float) -> float:
    """Amplitude absorption coefficient in Np/m at ``frequency`` (Hz) and ``depth`` (m)."""
    return absorption.decibels_per_km(frequency, depth) * NEPER_PER_DB / 1e3


@dataclass(frozen=True, eq=False)
class SoundSpeedField:
    """Speed of sound, linear between its points (in a section over triangles) and constant beyond them."""

    depth: Floats  # (n,) metres, increasing
    # (m,) metres along a level line through the scene's (0, 0), increasing; one for water that is everywhere the
    # same.
    distance: Floats
    speed: Floats  # (m, n) m/s
    heading: float = 0.0  # heading of that line, radians counter-clockwise from +x

    @property
    def axis(self) -> tuple[float, float]:
        """Level unit vector along the line."""
        return math.cos(self.heading), math.sin(self.heading)

    def pack(self, datum: float, reference: float, wavelength: float = 0.0) -> Water:
        """Pack it for the kernels, over height above a datum."""
        return Water(
            bent=True,
            height=np.ascontiguousarray(0.0 - self.depth[::-1] - datum),
            speed=np.ascontiguousarray(self.speed[:, ::-1]),
            station=self.distance,
            axis_x=self.axis[0],
            axis_y=self.axis[1],
            reference=reference,
            surface=0.0 - datum,
            wavelength=wavelength,
        )

    def speed_at(self, x: ArrayLike, y: ArrayLike, depth: ArrayLike) -> Floats:
        """Speed of sound at places of the scene, in m/s."""
        cos, sin = self.axis
        along, below = np.broadcast_arrays(np.asarray(x) * cos + np.asarray(y) * sin, np.asarray(depth))
        if self.distance.size == 1:
            return np.asarray(np.interp(below, self.depth, self.speed[0]))
        if self.depth.size == 1:
            return np.asarray(np.interp(along, self.distance, self.speed[:, 0]))
        i, onwards = _within(self.distance, along)
        j, downwards = _within(self.depth, below)
        # As in the ray tracer: each cell is two triangles, split along the diagonal with the smaller change of speed.
        top, bottom, top_next, bottom_next = (self.speed[i + m, j + k] for m, k in ((0, 0), (0, 1), (1, 0), (1, 1)))
        rising = np.abs(top_next - bottom) <= np.abs(bottom_next - top)
        upper = downwards < np.where(rising, 1.0 - onwards, onwards)
        over = np.where(upper, top_next - top, bottom_next - bottom)
        down = np.where(upper == rising, bottom - top, bottom_next - top_next)
        corner = np.where(upper, top + over * onwards, bottom + over * onwards)
        return np.asarray(corner + down * np.where(upper, downwards, downwards - 1.0))


def _within(places: Floats, wanted: Floats) -> tuple[Integers, Floats]:
    """Find the interval that holds each value and the fraction of it below the value, 0 or 1 outside all intervals."""
    piece = np.clip(np.searchsorted(places, wanted, side="right") - 1, 0, places.size - 2)
    return piece, np.clip((wanted - places[piece]) / (places[piece + 1] - places[piece]), 0.0, 1.0)


@kept_until_changed(maxsize=16)
def make_sound_speed_field(water: WaterKind) -> SoundSpeedField:
    """Sound speed of a declared water."""
    depth, speed, distance, heading = water.sound_speeds()
    return SoundSpeedField(depth, distance, speed, heading)


def speed_at_sonar(scene: Scene, datum: float | None = None) -> float:
    """Sound speed at the place and depth of the first ping."""
    mean_bed = scene.seabed.depth if datum is None else -datum
    depth = mean_bed - scene.altitude if scene.track.depth is None else scene.track.depth
    return float(make_sound_speed_field(scene.water).speed_at(*scene.track.start, depth))


def recording_speed(scene: Scene, datum: float | None = None) -> float:
    """Sound speed that converts travel time to slant range, in m/s; parameters as in `speed_at_sonar`."""
    return scene.water.reference_speed or speed_at_sonar(scene, datum)


def make_water(scene: Scene, datum: float, low: float = -math.inf) -> Water:
    """Sound speed over height above the mean bed, packed for the kernels."""
    layers = _cut(make_sound_speed_field(scene.water), 0.0, -(low + datum))
    reference = speed_at_sonar(scene, datum)
    if (layers.speed == layers.speed[0, 0]).all():
        return still_water(reference, -datum)
    return layers.pack(datum, reference, reference / scene.sonar.frequency)


def _cut(layers: SoundSpeedField, top: float, bottom: float) -> SoundSpeedField:
    """Sound speed field cut at two depths, with points there; a section at the points that enclose them."""
    if layers.distance.size > 1:
        # A point within a cell would move the diagonals of its triangles, and with them the speed everywhere in it.
        above, below = layers.depth[layers.depth <= top], layers.depth[layers.depth >= bottom]
        top, bottom = above[-1] if above.size else top, below[0] if below.size else bottom
    within = layers.depth[(layers.depth > top) & (layers.depth < bottom)]
    ends = [depth for depth in (top, bottom) if layers.depth[0] <= depth <= layers.depth[-1]]
    depth = np.unique(np.concatenate([within, ends]))
    if depth.size == 0:
        # All points lie outside: the sound speed of the nearer end applies.
        depth = layers.depth[:1] if bottom < layers.depth[0] else layers.depth[-1:]
    speed = np.stack([np.interp(depth, layers.depth, profile) for profile in layers.speed])
    return SoundSpeedField(depth, layers.distance, speed, layers.heading)


def bound_straight_rays(scene: Scene) -> float:
    """Bound on the error of straight rays at the farthest echo: shift in bins or change of level, whichever is more."""
    # A measured bed may lie at any depth.
    bed, reach = scene.seabed.depth, scene.sonar.range
    lowest = math.inf if scene.seabed.relief.measured else bed
    layers, reference = _cut(make_sound_speed_field(scene.water), 0.0, lowest), speed_at_sonar(scene)
    if (layers.speed == layers.speed[0, 0]).all():
        return 0.0
    sonar = bed - scene.altitude if scene.track.depth is None else scene.track.depth
    way = layers.speed_at(*scene.track.start, np.linspace(sonar, bed, DEPTHS))
    sine = min(abs(bed - sonar) / reach, 1.0)
    per_speed = 4.0 * (1.0 - sine**2) / max(sine, 1e-3) ** 2 / reference
    # As if all water differed from that at the sonar by the maximum.
    unlike = max(abs(layers.speed - reference).max(), abs(way - reference).max())
    bin_length = reach / scene.sonar.bins
    return float(unlike) * max(reach / reference / bin_length, per_speed)
