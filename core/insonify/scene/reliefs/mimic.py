"""Dunes that pass for a pattern."""

from __future__ import annotations

from typing import Literal

from pydantic import model_validator

from insonify.scene.base import parameter
from insonify.scene.materials import Material
from insonify.scene.materials.pattern import PatternMap
from insonify.scene.reliefs import ReliefKind


class Mimic(ReliefKind):
    """Dunes of one material that record as a level bed of stripes or waves does, from one line and one height.

    The line is the x axis, the dunes lie along it, and the material is the seabed's own: its diffuse share must be
    the mean of the pattern's for the records to be equal.
    """

    rank = 100
    kind: Literal["mimic"] = "mimic"
    of: PatternMap = parameter(
        PatternMap(
            of=(Material(diffuse=0.3, specular=0.0), Material(diffuse=0.5, specular=0.0)), shape="waves", period=16.0
        ),
        description="pattern that the dunes pass for; its materials scatter evenly, without a mirror lobe",
    )
    altitude: float = parameter(
        15.0,
        unit="m",
        description="height above the mean bed from which nothing tells them apart",
        gt=0.0,
        le=1e4,
        slider=(5.0, 50.0),
    )
    reach: float = parameter(
        51.2,
        unit="m",
        description="distance to either side up to which they pass; twice that on, the bed repeats",
        gt=0.0,
        le=1e5,
        slider=(10.0, 200.0),
        log=True,
    )
    law: Literal["light", "sonar"] = parameter("light", description="law under which they pass; that of sonar.law")

    @model_validator(mode="after")
    def _one_dimension(self) -> Mimic:
        if self.of.shape == "checks" or self.of.heading != 0.0:
            raise ValueError('of must lie along the track; give it shape = "stripes" or "waves" and heading = 0')
        if any(material.reflectivity.specular > 0.0 for material in self.of.of):
            raise ValueError("of holds a material with a mirror lobe, which no slope can imitate; set its specular = 0")
        return self
