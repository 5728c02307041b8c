"""Pipes: along the bed, over spans, or pitched."""

from itertools import pairwise
from typing import Any, Self

import numpy as np
from pydantic import field_validator, model_validator

from insonify.arrays import Floats
from insonify.scene.base import angle, check_increasing, metres, parameter
from insonify.scene.targets import HIGHEST_GAP, LEAST, LOWEST_GAP, BedSurface, Target
from insonify.scene.targets.shape import Shape, ball, exact_cos, frustum

Gap = float | tuple[tuple[float, float], ...]
MOST_SAMPLES = 2048  # heights of the bed beneath a pipe
LONG = 0.4  # length of a new pipe over the slant range


class Pipe(Target, kind="pipe", rank=1):
    """A pipe that rests on the bed in some places and spans above it in others."""

    radius: float = metres(0.5, "outer radius of the pipe", (0.05, 2.0), least=LEAST, most=100.0)
    length: float = metres(20.0, "length along the axis", (1.0, 200.0), least=LEAST, most=1e5)
    heading: float = angle("direction of the axis, counter-clockwise from east; 45T is 45° by the compass")
    pitch: float | None = parameter(
        None,
        "rise of the axis towards its heading; when left out the pipe follows the slope of the bed",
        "°",
        ge=-360.0,
        le=360.0,
        slider=(-90.0, 90.0),
        rare=True,
    )
    roll: float = angle("angle of the port side upwards")
    gap: Gap = parameter(
        0.0,
        "height of the underside above the bed, negative if buried: a number, or [[along, gap], ...] with "
        "the distance along the pipe from its centre",
        "m",
        slider=(-1.0, 5.0),
    )

    @field_validator("gap")
    @classmethod
    def _gap_in_order(cls, gap: Gap) -> Gap:
        stations = [(0.0, gap)] if isinstance(gap, float) else list(gap)
        if not stations:
            raise ValueError("is empty; give a number or at least two [along, gap] pairs")
        if any(height < LOWEST_GAP or height > HIGHEST_GAP for _, height in stations):
            raise ValueError(f"must lie between {LOWEST_GAP:g} and {HIGHEST_GAP:g} m; check its unit")
        check_increasing("along", stations)
        return gap

    @model_validator(mode="after")
    def _straight_if_pitched(self) -> Self:
        if self.pitch is not None and not isinstance(self.gap, float):
            raise ValueError("a pipe with a pitch is straight; give its gap as one number or leave pitch out")
        return self

    @property
    def sizes(self) -> dict[str, tuple[str, ...]]:
        """Length; radius."""
        return {"resize": ("length",), "thicken": ("radius",)}

    def shape(self) -> Shape:
        """Return a cylinder along the x axis."""
        ahead = np.array([self.length / 2.0, 0.0, 0.0])
        return Shape((frustum(-ahead, ahead, self.radius, self.radius),))

    @property
    def attitude(self) -> tuple[float, float, float]:
        """Heading, pitch and roll, in degrees; pitch 0 where it follows the bed."""
        return self.heading, self.pitch or 0.0, self.roll

    @property
    def underside(self) -> float:
        """Mean of the gap's stations, in metres."""
        return sum(height for _, height in self._stations) / len(self._stations)

    def placed(self, bed: BedSurface) -> Shape:
        """Pipe along the bed: straight between joints, with a ball at each joint to close its wedge."""
        if self.pitch is not None or len(self.position) == 3:
            return super().placed(bed)
        joints = self._joints(bed)
        stretches = (frustum(first, last, self.radius, self.radius) for first, last in pairwise(joints))
        return Shape((*stretches, *(ball(self.radius, joint) for joint in joints[1:-1])))

    def _joints(self, bed: BedSurface) -> list[Floats]:
        """Points on the axis between which the pipe is straight."""
        # On a rough bed a stiff pipe follows the straight line fitted to the heights under it; the gap is above that
        # line.
        (x, y), half = self.position[:2], self.length / 2.0
        direction = np.array([exact_cos(self.heading), exact_cos(self.heading - 90.0)])
        inner = [station[0] for station in self._stations if -half < station[0] < half]
        along = np.array([-half, *inner, half])
        gaps = np.interp(along, [s[0] for s in self._stations], [s[1] for s in self._stations])
        samples = np.linspace(-half, half, int(np.clip(2.0 * self.length / bed.spacing, 2, MOST_SAMPLES)))
        heights = self.heights_of(bed, x + samples * direction[0], y + samples * direction[1])
        slope, level = np.polyfit(samples, heights, 1) if np.ptp(heights) > 0 else (0.0, heights[0])
        z = level + slope * along + gaps + self.radius
        return [np.array([x + a * direction[0], y + a * direction[1], height]) for a, height in zip(along, z)]

    @property
    def _stations(self) -> tuple[tuple[float, float], ...]:
        return ((0.0, self.gap),) if isinstance(self.gap, float) else self.gap

    @classmethod
    def suited_to(cls, reach: float, path: str) -> dict[str, Any]:
        """Choose the length, a share of the slant range."""
        return {"length": float(f"{LONG * reach:.2g}")}

    @property
    def idle_fields(self) -> frozenset[str]:
        """The roll, the gap if z is given, and the pitch if the gap is a table."""
        return super().idle_fields | {"roll"} | ({"pitch"} if isinstance(self.gap, tuple) else set())

    def value_in_force(self, field: str, frequency: float | None = None) -> float | None:
        """Return 0 for a pitch that is left out."""
        return 0.0 if field == "pitch" else None
