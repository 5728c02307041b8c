"""Sides of targets as seen by the sonar: echo strength, length along the track and depth in slant range.

First-order estimates for the plan: a side is evenly insonified and hides no other one. Vectors have components along
the track, away from it and up.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from insonify.scene.materials import Reflectivity
from insonify.scene.targets.shape import Triple

SLIGHT = 1e-3  # m, and share of an altitude: nothing is taken to be shorter or lower
# Slant range that most of a rounded side's echo comes from, over half of all that it is deep; fitted.
FRONT = 0.35


class Side(NamedTuple):
    """Echo and extent of one side of a target."""

    echo: float  # m², of σ over that of a perfect Lambert surface seen straight on
    along: float  # m, its length along the track
    depth: float  # m of slant range that one line across the track meets of it
    turn: float  # m of slant range between what its first and its last such line meet


class Sight(NamedTuple):
    """Orientation and size of a target relative to the sonar."""

    bow: Triple
    port: Triple
    top: Triple
    towards: Triple  # unit vector to the sonar
    along: float  # m, length of the target along the track
    half_depth: float  # m, half of all that it is deep in slant range


def dot(one: Triple, other: Triple) -> float:
    """Inner product."""
    return one[0] * other[0] + one[1] * other[1] + one[2] * other[2]


def rough_side(faces: Triple, of: Reflectivity, sight: Sight) -> Side:
    """Side of a target of any shape, whose normals point everywhere.

    Parameters
    ----------
    faces : (float, float, float)
        Area that faces each axis of the target, from one side, in m².
    of : Reflectivity
    sight : Sight
    """
    area = sum(face * abs(dot(axis, sight.towards)) for face, axis in zip(faces, sight[:3]))
    # Of all normals towards the sonar: ∫ cos² and the lobe over half a ball, by its cross-section.
    echo = area * (2.0 / 3.0 * of.diffuse + 0.25 * of.specular * (of.shininess + 2.0) / of.shininess)
    return Side(echo, sight.along, sight.half_depth * FRONT, sight.half_depth)


def disc(radius: float, of: Reflectivity, axis: Triple, cosine: float) -> Side:
    """End of a pipe or a cone, by its axis and the cosine of its incidence."""
    edge = math.sqrt(max(1.0 - axis[0] ** 2, SLIGHT))
    echo = math.pi * radius**2 * flat_echo(of, cosine)
    return Side(echo, 2.0 * radius * edge, 0.5 * radius, radius * abs(axis[0]))


def flat_echo(of: Reflectivity, cosine: float) -> float:
    """Strength of a flat side by the cosine of its incidence, over that of a perfect Lambert surface straight on."""
    if cosine <= 0.0:
        return 0.0
    lobe = max(2.0 * cosine * cosine - 1.0, 0.0) ** of.shininess
    return cosine * cosine * (of.diffuse + 0.5 * (of.shininess + 2.0) * of.specular * lobe)
