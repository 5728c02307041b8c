"""Scales of the cross-section: ground range across, height up."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QPointF, QRectF
from PySide6.QtGui import QPolygonF

if TYPE_CHECKING:
    from insonify.explanation.cross_section import CrossSection

LEFT, RIGHT, TOP, BOTTOM = 46.0, 22.0, 10.0, 22.0  # px at the usual size of the text
BELOW, ABOVE = 0.12, 0.08  # of the water's height, drawn below the bed and above the sonar
FLATTEST = 1e-9  # least extent of heights as a share of them, so that their edges are two numbers

Points = NDArray[np.float64]


@dataclass(frozen=True)
class SectionScales:
    """Scales of one cross-section in a widget."""

    area: QRectF  # of the plot, px
    reach: float  # ground range at the far end, m
    low: float  # heights at the lower and the upper edge, m
    high: float
    mirrored: bool  # whether ground range grows to the left, as on the port side of the record
    text: float = 1.0  # size of the text over the usual one

    @classmethod
    def of(cls, section: CrossSection, size: tuple[float, float], surfaced: bool, text: float = 1.0) -> SectionScales:
        """Fit a section into a widget; ``surfaced`` shows the sea surface too, ``text`` enlarges the margins."""
        bed = section.bed[np.isfinite(section.bed[:, 1]), 1]
        sonar = float(section.sonar.place[2])
        high = section.sonar.surface if surfaced else sonar
        # A fish towed at a depth may be below all of a measured bed.
        low = min(float(bed.min()) if bed.size else sonar - 1.0, high)
        tall = max(high - low, 1.0, FLATTEST * abs(low))
        left, right, bottom = LEFT * text, RIGHT * text, BOTTOM * text
        area = QRectF(left, TOP, max(size[0] - left - right, 1.0), max(size[1] - TOP - bottom, 1.0))
        return cls(area, section.reach, low - BELOW * tall, high + ABOVE * tall, section.side == 0, text)

    def at(self, ground_range: float, height: float) -> QPointF:
        """Pixel of a ground range and a height, m."""
        share = ground_range / self.reach
        share = 1.0 - share if self.mirrored else share
        y = self.area.bottom() - (height - self.low) / (self.high - self.low) * self.area.height()
        return QPointF(self.area.left() + share * self.area.width(), y)

    def polygon(self, points: Points) -> QPolygonF:
        """Pixels of (n, 2) ground ranges and heights."""
        return QPolygonF([self.at(x, z) for x, z in points.tolist()])
