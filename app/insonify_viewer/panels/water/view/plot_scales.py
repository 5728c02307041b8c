"""Scales of the profile and the ray diagram in the water panel."""

from __future__ import annotations

from dataclasses import dataclass

from PySide6.QtCore import QPointF, QRectF

from insonify.display.ray_diagram.diagram import RayDiagram, compute_speed_limits

LEFT, GAP, RIGHT, TOP, BOTTOM = 46.0, 14.0, 34.0, 24.0, 30.0  # px around and between the two plots
SHARE, NARROWEST, WIDEST = 0.18, 110.0, 220.0  # of the profile: share of the width, px
BED = 0.10  # of the height, filled by the bed


@dataclass(frozen=True)
class PlotScales:
    """Scales of the two plots, with a common depth axis."""

    profile: QRectF  # rectangles of the plots, with the bed, in pixels
    rays: QRectF
    slowest: float  # ends of the profile's scale, in m/s
    fastest: float
    bottom: float  # depth of the mean bed and greatest range, in metres
    reach: float

    @classmethod
    def of(cls, diagram: RayDiagram, width: float, height: float) -> PlotScales:
        """Fit a diagram into a widget of a width and height in pixels."""
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
