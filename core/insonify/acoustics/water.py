"""Sound speed at the sonar, and the water of a scene packed for the kernels."""

from __future__ import annotations

import math

import numpy as np

from insonify.acoustics.layers import SoundSpeedField, make_sound_speed_field
from insonify.kernels.common.types import Water, still_water
from insonify.scene import Scene


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
    return Water(
        bent=True,
        height=np.ascontiguousarray(-layers.depth[::-1] - datum),
        speed=np.ascontiguousarray(layers.speed[:, ::-1]),
        station=layers.distance,
        axis_x=layers.axis[0],
        axis_y=layers.axis[1],
        reference=reference,
        surface=-datum,
    )


def _cut(layers: SoundSpeedField, top: float, bottom: float) -> SoundSpeedField:
    """Sound speed field cut at two depths, with points there."""
    within = layers.depth[(layers.depth > top) & (layers.depth < bottom)]
    ends = [depth for depth in (top, bottom) if layers.depth[0] <= depth <= layers.depth[-1]]
    depth = np.sort(np.concatenate([within, ends]))
    if depth.size == 0:
        # All points lie outside: the sound speed of the nearer end applies.
        depth = layers.depth[:1] if bottom < layers.depth[0] else layers.depth[-1:]
    speed = np.stack([np.interp(depth, layers.depth, profile) for profile in layers.speed])
    return SoundSpeedField(depth, layers.distance, speed, layers.heading)
