"""Where the parts of the water's panel lie in its widget."""

from __future__ import annotations

import math
from dataclasses import dataclass

from PySide6.QtCore import QPointF, QRectF

from insonify.display.ray_diagram.diagram import RayDiagram, compute_speed_limits

LEFT, GAP, RIGHT, TOP, BOTTOM = 46.0, 14.0, 34.0, 24.0, 30.0  # px around and between the two plots
SHARE, NARROWEST, WIDEST = 0.18, 110.0, 220.0  # of the profile: share of the width, px
BED = 0.10  # of the height, that is bed


@dataclass(frozen=True)
class PlotScales:
    """Scales of the two plots, which share that of depth.

    Attributes
    ----------
    profile, rays : QRectF
        Where the plots lie, the bed included, in pixels.
    slowest, fastest : float
        Ends of the profile's scale, in m/s.
    bottom, reach : float
        Depth of the mean bed and greatest range, in metres.
    """

    profile: QRectF
    rays: QRectF
    slowest: float
    fastest: float
    bottom: float
    reach: float

    @classmethod
    def of(cls, diagram: RayDiagram, width: float, height: float) -> PlotScales:
        """Fit a diagram into a widget of that many pixels."""
        narrow = min(max(SHARE * width, NARROWEST), WIDEST)
        tall = max(height - TOP - BOTTOM, 1.0)
        begin = LEFT + narrow + GAP
        return cls(
            QRectF(LEFT, TOP, narrow, tall),
            QRectF(begin, TOP, max(width - begin - RIGHT, 1.0), tall),
            *compute_speed_limits(diagram),
            diagram.bottom,
            diagram.reach,
        )

    @property
    def water(self) -> QRectF:
        """The plot of the rays without the bed."""
        return QRectF(self.rays.left(), self.rays.top(), self.rays.width(), (1.0 - BED) * self.rays.height())

    def height_of(self, depth: float) -> float:
        """Pixel of a depth in metres."""
        return self.water.top() + depth / self.bottom * self.water.height()

    def at(self, distance: float, depth: float) -> QPointF:
        """Pixel of a range and a depth in metres."""
        return QPointF(self.rays.left() + distance / self.reach * self.rays.width(), self.height_of(depth))

    def of_speed(self, speed: float, depth: float) -> QPointF:
        """Pixel of a speed of sound in m/s at a depth in metres."""
        share = (speed - self.slowest) / (self.fastest - self.slowest)
        return QPointF(self.profile.left() + share * self.profile.width(), self.height_of(depth))

    def depth_at(self, place: QPointF) -> float:
        """Depth of a pixel in metres, within the water."""
        depth = (place.y() - self.water.top()) / self.water.height() * self.bottom
        return min(max(depth, 0.0), self.bottom)

    def range_at(self, place: QPointF) -> float:
        """Range of a pixel in metres."""
        return (place.x() - self.rays.left()) / self.rays.width() * self.reach

    def speed_at(self, place: QPointF) -> float:
        """Speed of sound of a pixel in m/s."""
        share = (place.x() - self.profile.left()) / self.profile.width()
        return self.slowest + share * (self.fastest - self.slowest)


def round_steps(low: float, high: float, most: int) -> list[float]:
    """Round numbers between two others, at most so many."""
    rough = (high - low) / max(most, 1)
    power = 10.0 ** math.floor(math.log10(rough))
    step = next(power * unit for unit in (1.0, 2.0, 5.0, 10.0) if power * unit >= rough * (1.0 - 1e-9))
    return [step * k for k in range(math.ceil(low / step - 1e-9), math.floor(high / step + 1e-9) + 1)]
