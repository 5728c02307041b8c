"""Relief of one material with the record of a level pattern of materials: one record, two interpretations.

A level bed of reflectivity k(x) below a sonar of altitude H returns k(x) at slant range r = √(H² + x²) under the
incidence α, cos α = H/r. Dunes of the mean reflectivity return the same at the same r if their incidence β obeys

- law `light`, radiance k cos β:                             cos β = κ H/r
- law `sonar`, k cos² β times the area of a step of range:   cos² β / sin β = κ (H/r)² / (x/r)

with κ = k(x) over the mean. A strip of the bed between r and r + dr has the area dr / sin β, because a ray meets it at
the angle π/2 − β. In polar coordinates around the sonar, ψ from nadir, the dunes are a curve ψ(r) with
cot β = r dψ/dr. Since β is known at every r, ψ is an integral over r plus a constant, which is stable, and r increases
along the dunes, so that none hides another. The integral is taken over x, r dr = x dx, because dψ/dr is infinite at
nadir and dψ/dx is not.

The constant rotates the dunes around the sonar, which does not change the record: they are rotated to lie around the
level bed. Near nadir the level bed faces the sonar and no slope is brighter; there the dunes rise from height 0.
"""

from typing import Literal, Self

import numpy as np
from pydantic import model_validator

from insonify.arrays import Floats
from insonify.errors import SceneError
from insonify.scene.base import metres, parameter
from insonify.scene.seabed.materials import Material, MaterialMap
from insonify.scene.seabed.materials.pattern import PatternMap
from insonify.scene.seabed.reliefs import HeightGrid, ReliefKind
from insonify.scene.seabed.reliefs.random_relief import MOST_CELLS

FROM = 1.4  # slant range over altitude beyond which the records agree
STEPS_A_CELL = 8
FEWEST_CELLS = 4
MEAN_OF = 1 << 14  # samples of a mean
WIDTH = 4  # nodes along the track, along which the dunes are uniform


class Mimic(ReliefKind, kind="mimic", rank=95):
    """Dunes of one material with the same record as a level bed of stripes or waves, from one line and one height.

    The line is the x axis, the dunes lie along it, and the material is the seabed's own: its diffuse share must be
    the mean of the pattern's for the records to be equal.
    """

    of: PatternMap = parameter(
        PatternMap(
            of=(Material(diffuse=0.3, specular=0.0), Material(diffuse=0.5, specular=0.0)), shape="waves", period=16.0
        ),
        "pattern that the dunes imitate; its materials have no mirror lobe",
    )
    altitude: float = parameter(
        15.0, "height above the mean bed from which the records are equal", "m", gt=0.0, le=1e4, slider=(5.0, 50.0)
    )
    reach: float = metres(
        51.2,
        "distance to either side up to which the records are equal; the bed repeats after twice that",
        (10.0, 200.0),
        most=1e5,
    )
    law: Literal["light", "sonar"] = parameter("light", "law under which the records are equal; that of sonar.law")

    @model_validator(mode="after")
    def _one_dimension(self) -> Self:
        if self.of.shape == "checks" or self.of.heading != 0.0:
            raise ValueError('of must lie along the track; give it shape = "stripes" or "waves" and heading = 0')
        if any(material.reflectivity.specular > 0.0 for material in self.of.of):
            raise ValueError("of has a material with a mirror lobe, which no slope can imitate; set its specular = 0")
        return self

    def sample(
        self, spacing: float, origin: tuple[float, float] | None = None, shape: tuple[int, int] | None = None
    ) -> HeightGrid:
        """Sample one period of the dunes, uniform along the track."""
        cells, width = shape or (max(FEWEST_CELLS, round(2.0 * self.reach / spacing)), WIDTH)
        step = 2.0 * self.reach / cells
        y = np.arange(cells, dtype=np.float64) * step
        port = y <= self.reach
        heights = np.empty(cells)
        heights[port] = _one_side(self, y[port], 1.0, cells)
        heights[~port] = _one_side(self, 2.0 * self.reach - y[~port], -1.0, cells)
        return HeightGrid(np.tile(heights[:, np.newaxis], (1, width)), step)

    def check(self, spacing: float, material: MaterialMap) -> None:
        """Check the number of cells, and that the bed has a single material."""
        cells = 2.0 * self.reach / spacing
        if cells > MOST_CELLS:
            raise ValueError(
                f"relief.reach {self.reach:g} m at spacing {spacing:g} m makes {cells:g} cells across; "
                f"shorten the reach or widen the spacing to stay within {MOST_CELLS}"
            )
        if len(material.materials) > 1:
            raise ValueError('relief "mimic" imitates a map by its shape; give the seabed a single material')


def mean_diffuse(pattern: PatternMap) -> float:
    """Mean diffuse share of a pattern, which its dunes must have."""
    return float(_diffuse(pattern, (np.arange(MEAN_OF) + 0.5) / MEAN_OF).mean())


def equivalent_profile(ratio: Floats, altitude: float, step: float, law: str) -> tuple[Floats, Floats]:
    """Profile with the record of a level bed of varying reflectivity, beyond 1.4 times the altitude."""
    x = (np.arange(ratio.size) + 0.5) * step
    r = np.hypot(x, altitude)
    # With this growth 1 + (κ − 1) t² stays below r/H = 1 + (FROM − 1) t for every κ below FROM.
    grown = np.minimum((r / altitude - 1.0) / (FROM - 1.0), 1.0) ** 2
    cotangent = _cotangent(1.0 + (ratio - 1.0) * grown, x / r, altitude / r, law)
    angle = np.concatenate([[0.0], np.cumsum(cotangent * x / r**2) * step])
    knots = np.arange(ratio.size + 1) * step
    ends = np.hypot(knots, altitude)
    height = altitude - ends * np.cos(angle)
    # A rotation by δ lifts the profile by x δ; this one minimises the mean square of z.
    turn = -np.sum(height * knots) / np.sum(knots**2)
    share = np.clip(knots / (altitude * np.sqrt(FROM**2 - 1.0)), 0.0, 1.0)
    angle += turn * share**2 * (3.0 - 2.0 * share)
    return ends * np.sin(angle), altitude - ends * np.cos(angle)


def _cotangent(ratio: Floats, sine: Floats, cosine: Floats, law: str) -> Floats:
    """Cotangent of the incidence β at which the profile is as bright as the level bed at α."""
    if law == "light":
        bright = ratio * cosine
        # 1 − κ² cos² α, without cancelling near nadir.
        return np.asarray(bright / np.sqrt(sine**2 + cosine**2 * (1.0 - ratio) * (1.0 + ratio)))
    level = ratio * cosine**2 / sine
    sin_beta = 2.0 / (level + np.sqrt(level**2 + 4.0))  # the root s of (1 − s²) / s = level
    return np.asarray(np.sqrt((1.0 - sin_beta) * (1.0 + sin_beta)) / sin_beta)


def _one_side(mimic: Mimic, y: Floats, side: float, cells: int) -> Floats:
    """Heights at distances from the track, towards +y (side 1) or −y (−1)."""
    # A whole number of steps between the borders of stripes, so that no border falls within a step.
    border = mimic.of.period / len(mimic.of.of)
    step = border / np.ceil(STEPS_A_CELL * border * cells / (2.0 * mimic.reach))
    count = int(np.ceil(1.5 * mimic.reach / step))
    ratio = _ratio(mimic, side * (np.arange(count) + 0.5) * step)
    ground, height = equivalent_profile(ratio, mimic.altitude, step, mimic.law)
    return np.interp(y, ground, height)


def _ratio(mimic: Mimic, y: Floats) -> Floats:
    """Diffuse share of the pattern across the track, over its mean."""
    mean = mean_diffuse(mimic.of)
    ratio = _diffuse(mimic.of, y / mimic.of.period) / max(mean, 1e-300)
    if mimic.law == "light" and ratio.max() >= FROM:
        raise SceneError(
            f"seabed.relief.of.of: the brightest reflects {ratio.max():.3g} times the mean {mean:.3g}, more than a "
            f"slope of the mean material can; keep it below {FROM:g} times"
        )
    return np.asarray(ratio)


def _diffuse(pattern: PatternMap, across: Floats) -> Floats:
    """Diffuse share at coordinates in periods across the stripes."""
    table = np.array([row.diffuse for row in pattern.rows()[1]])
    return np.asarray(table[pattern.rows_at(across, np.zeros_like(across))])
