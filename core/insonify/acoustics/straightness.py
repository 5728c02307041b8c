"""Error of straight rays in refracting water, estimated in closed form."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from insonify.acoustics.layers import make_sound_speed_field
from insonify.acoustics.water import speed_at_sonar
from insonify.scene import Scene

DEPTHS = 64  # at which the sound speed between sonar and bed is sampled


class RefractionEffect(NamedTuple):
    """Effect of refraction on the farthest echo of the bed."""

    shift: float  # displacement in slant range from a straight ray at the sound speed of the sonar, in metres
    level: float  # greatest relative change of its level
    # Bound: the greater of shift in bins and level if all water differed from that at the sonar by the maximum.
    most: float


def estimate_refraction(scene: Scene) -> RefractionEffect:
    """Estimate the effect of refraction on a scene's farthest echo, in closed form."""
    layers, reference = make_sound_speed_field(scene.water), speed_at_sonar(scene)
    if (layers.speed == layers.speed[0, 0]).all():
        return RefractionEffect(0.0, 0.0, 0.0)
    bed, reach = scene.seabed.depth, scene.sonar.range
    sonar = bed - scene.altitude if scene.track.depth is None else scene.track.depth
    way = layers.speed_at(*scene.track.start, np.linspace(sonar, bed, DEPTHS))
    sine = min(abs(bed - sonar) / reach, 1.0)
    per_speed = 4.0 * (1.0 - sine**2) / max(sine, 1e-3) ** 2 / reference
    # A measured bed may lie at any depth.
    within = layers.depth < (math.inf if scene.seabed.relief.measured else bed)
    unlike = max(abs(layers.speed[:, within] - reference).max(initial=0.0), abs(way - reference).max())
    bin_length = reach / scene.sonar.bins
    return RefractionEffect(
        shift=reach * abs(reference * float((1.0 / way).mean()) - 1.0),
        level=per_speed * abs(float(way[-1]) - reference),
        most=float(unlike) * max(reach / reference / bin_length, per_speed),
    )
