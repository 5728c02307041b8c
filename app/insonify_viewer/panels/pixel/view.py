"""Summary and budget of a pixel beside its cross-section."""

import html
import math
from dataclasses import dataclass
from typing import Self

import numpy as np
from PySide6.QtCore import QPointF, QRectF, QSize, QSizeF, Qt
from PySide6.QtGui import QColor, QPainter, QPen, QPolygonF
from PySide6.QtWidgets import QHBoxLayout, QVBoxLayout, QWidget

from insonify.arrays import Floats
from insonify.io.contacts import SIDES
from insonify_viewer.core_types import CrossSection, PixelExplanation
from insonify_viewer.state.inspection import Mark
from insonify_viewer.state.quantities import format_share
from insonify_viewer.widgets import theme
from insonify_viewer.widgets.buttons import make_label, push_button
from insonify_viewer.widgets.layouts import fill, make_splitter
from insonify_viewer.widgets.painting import PaintedOnce, round_steps
from insonify_viewer.widgets.text import ThemedText

HINT = (
    "Click a pixel of the record to see why it is bright or dark. Click a place in the 3-D view to light up the pixels "
    "that receive its echo."
)
LEFT, RIGHT, TOP, BOTTOM = 46.0, 22.0, 10.0, 22.0  # px at the usual size of the text
BELOW, ABOVE = 0.12, 0.08  # of the water's height, drawn below the bed and above the sonar
FLATTEST = 1e-9  # least extent of heights as a share of them, so that their edges are two numbers

WATER, BED, HEARD, HIDDEN = "#1c3a52", "#4b3f2d", theme.ACCENT_IN_WATER, "#0a0604"
BLOCKED, RING, TARGET = "#ff7a5c", "#5b7d99", "#e8eef2"
ARC = 96  # points of the ring of equal slant range

MOST = 6  # contributions, and what hides, that are listed
NARROW = 205  # px, which hold levels, bars and names
LONGEST = 6  # letters, of a bar

Row = tuple[str, str, str, float]  # name, level, detail, and the number of its bar
Group = tuple[Row, list[Row]]  # a heading and its rows


class PixelView(QWidget):
    """Shows the explanation of a pixel."""

    def __init__(self) -> None:
        super().__init__()
        self.setObjectName("panel")
        self.sentence, self.summary = make_label("choice", HINT), make_label("name")
        self.budget, self.section = BudgetList(), SectionView()
        splitter = make_splitter(Qt.Orientation.Horizontal, self.budget, self.section, sizes=(430, 570))
        tip = "Explain the pixel of the simulated record beside that has the same place, and show why it is as it is"
        self.same_place = push_button("The same place in the simulated record", tip)
        self.same_place.hide()
        parts = self.sentence, self.summary, fill(QHBoxLayout(), self.same_place, None), splitter
        fill(QVBoxLayout(self), *parts, growing=splitter, margins=(6, 4, 6, 4), spacing=3)

    def show_nothing(self) -> None:
        """Show that no pixel is pinned."""
        self._say(HINT)
        self.budget.show_explanation(None)
        self.section.show_section(None, None)

    def show_waiting(self, mark: Mark) -> None:
        """Show that a pixel is being explained."""
        self._say(f"explaining ping {mark.ping}, {mark.side_name} …")

    def show_pixel(self, explanation: PixelExplanation, section: CrossSection, sentence: str) -> None:
        """Show the explanation of a pixel: a sentence on its brightness first."""
        where = f"ping {explanation.ping}, {SIDES[explanation.side]}, {explanation.slant_range:.2f} m"
        self._say(sentence, f"{where}: {explanation.summary}")
        self.budget.show_explanation(explanation)
        self.section.show_section(explanation, section)

    def show_recorded(self, sentence: str, summary: str) -> None:
        """Show what is known of a pixel of a recording, which has neither budget nor section."""
        self.show_nothing()
        self._say(sentence, summary)
        self.same_place.show()

    def _say(self, sentence: str, summary: str = "") -> None:
        self.sentence.setText(sentence)
        self.summary.setText(summary)
        self.summary.setVisible(bool(summary))
        self.same_place.hide()


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
    def of(cls, section: CrossSection, size: tuple[float, float], surfaced: bool, text: float = 1.0) -> Self:
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

    def polygon(self, points: Floats) -> QPolygonF:
        """Pixels of (n, 2) ground ranges and heights."""
        return QPolygonF([self.at(x, z) for x, z in points.tolist()])


class SectionView(PaintedOnce):
    """Paints a cross-section with the rays of a pixel."""

    def __init__(self) -> None:
        super().__init__(minimumSize=QSize(100, 110), accessibleName="Cross-section of the beam")
        self._shown: tuple[PixelExplanation, CrossSection] | None = None

    def show_section(self, explanation: PixelExplanation | None, section: CrossSection | None) -> None:
        """Show a pixel in its cross-section; None clears it."""
        self._shown = None if explanation is None or section is None else (explanation, section)
        self.paint_anew()

    def paint_picture(self, painter: QPainter) -> None:
        """Paint the section."""
        if self._shown is not None:
            painter.setRenderHint(QPainter.RenderHint.Antialiasing)
            _paint(painter, *self._shown, (self.width(), self.height()), theme.text_scale(self))


def _paint(
    painter: QPainter, explanation: PixelExplanation, section: CrossSection, size: tuple[int, int], text: float
) -> None:
    """Paint water, bed, targets, rays and scales."""
    ghosts = any(each.path != "direct" for each in explanation.contributions)
    scales = SectionScales.of(section, size, surfaced=ghosts, text=text)
    painter.fillRect(scales.area, QColor(WATER))
    painter.setClipRect(scales.area)
    _paint_bed(painter, scales, section)
    _paint_ring(painter, scales, section, explanation.slant_range)
    _paint_rays(painter, scales, section, explanation)
    painter.setClipping(False)
    painter.setPen(_pen(HIDDEN, 1.0))
    painter.setBrush(QColor(theme.OVER_WATER))
    painter.drawEllipse(scales.at(0.0, float(section.sonar.place[2])), 5.0, 5.0)
    _paint_scales(painter, scales, section)


def _paint_bed(painter: QPainter, scales: SectionScales, section: CrossSection) -> None:
    """Paint the bed with its visible and hidden stretches, horizons and targets."""
    bed = section.bed[np.isfinite(section.bed[:, 1])]
    if len(bed):
        ends = np.array([[bed[-1, 0], scales.low], [bed[0, 0], scales.low]])
        painter.setPen(Qt.PenStyle.NoPen)
        painter.setBrush(QColor(BED))
        painter.drawPolygon(scales.polygon(np.concatenate([bed, ends])))
    painter.setBrush(Qt.BrushStyle.NoBrush)
    painter.setPen(QPen(QColor(RING), 1.0, Qt.PenStyle.DotLine))
    painter.drawLines(_lines(scales, section.horizon))
    for stretches, colour, width in ((section.visible, HEARD, 2.0), (section.hidden, HIDDEN, 3.5)):
        painter.setPen(_pen(colour, width))
        painter.drawLines(_lines(scales, stretches))
    for name, face in section.targets:
        painter.setPen(_pen(TARGET, 2.5))
        painter.drawLines(_lines(scales, face))
        _name_target(painter, scales, name, face)


def _name_target(painter: QPainter, scales: SectionScales, name: str, face: Floats) -> None:
    """Write the name of a target above it and beyond, where the ray from the sonar does not cross it."""
    top = face.reshape(-1, 2)[np.argmax(face[..., 1])]
    place = scales.at(float(top[0]), float(top[1]))
    width = painter.fontMetrics().horizontalAdvance(name) + 2.0
    left = place.x() - 6.0 - width if scales.mirrored else place.x() + 6.0
    left = min(max(left, scales.area.left()), scales.area.right() - width)
    painter.setPen(QColor(TARGET))
    top_left = QPointF(left, place.y() - 20.0 * scales.text)
    painter.drawText(QRectF(top_left, QSizeF(width, 16.0 * scales.text)), Qt.TextFlag.TextDontClip, name)


def _paint_ring(painter: QPainter, scales: SectionScales, section: CrossSection, slant_range: float) -> None:
    """Paint the places at the slant range of the pixel, were sound to go straight."""
    angle = np.linspace(-0.5 * np.pi, 0.0, ARC)
    ring = np.column_stack([np.cos(angle), np.sin(angle)]) * slant_range + [0.0, section.sonar.place[2]]
    painter.setPen(QPen(QColor(RING), 1.0, Qt.PenStyle.DashLine))
    painter.drawPolyline(scales.polygon(ring))


def _paint_rays(painter: QPainter, scales: SectionScales, section: CrossSection, explanation: PixelExplanation) -> None:
    """Paint rays, and where they lead."""
    drawn: list[tuple[str, tuple[Floats, ...], Floats]] = [
        (BLOCKED, each.rays[:1], each.places) for each in explanation.obstructions
    ]
    drawn += [(theme.MARK_IN_WATER, each.rays, each.places) for each in explanation.contributions]
    for colour, rays, places in drawn:
        painter.setPen(_pen(colour, 1.6))
        for ray in rays:
            painter.drawPolyline(scales.polygon(_flat(section, ray)))
        painter.setPen(_pen(colour, 4.0))
        painter.drawLines(_lines(scales, np.stack([_flat(section, place) for place in places])) if len(places) else [])


def _paint_scales(painter: QPainter, scales: SectionScales, section: CrossSection) -> None:
    """Write ground ranges below and depths beside the section."""
    painter.setPen(QColor(theme.QUIET))
    area, wide, high = scales.area, 80.0 * scales.text, 16.0 * scales.text
    for distance in round_steps(0.0, scales.reach, max(int(area.width() / (70 * scales.text)), 1)):
        x = scales.at(distance, 0.0).x()
        place = QRectF(x - 0.5 * wide, area.bottom() + 3.0, wide, high)
        painter.drawText(place, Qt.AlignmentFlag.AlignHCenter, f"{distance:g} m")
    right = Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter
    surface = section.sonar.surface
    for depth in round_steps(
        surface - scales.high, surface - scales.low, max(int(area.height() / (40 * scales.text)), 1)
    ):
        y = scales.at(0.0, surface - depth).y()
        if area.top() <= y <= area.bottom():
            painter.drawText(QRectF(0.0, y - 0.5 * high, area.left() - 6.0, high), right, f"{depth:g} m")


def _flat(section: CrossSection, points: Floats) -> Floats:
    """Ground range and height of places in local coordinates, (n, 3) to (n, 2)."""
    level = points[:, :2] - section.sonar.place[:2]
    return np.column_stack([np.hypot(level[:, 0], level[:, 1]), points[:, 2]])


def _lines(scales: SectionScales, segments: Floats) -> list[QPointF]:
    """Pixels of the beginnings and ends of segments, in turns."""
    return [scales.at(x, z) for x, z in segments.reshape(-1, 2).tolist()]


def _pen(colour: str, width: float) -> QPen:
    pen = QPen(QColor(colour), width)
    pen.setCapStyle(Qt.PenCapStyle.FlatCap)
    return pen


class BudgetList(ThemedText):
    """Lists the budget of a pixel with bars: terms in decibels, and shares of what returns and hides its sound."""

    def __init__(self) -> None:
        self.groups: list[Group] = []
        self._notes: tuple[str, ...] = ()
        super().__init__("Budget of the pixel", "Terms in decibels that add up to the level of the pixel", NARROW)

    def show_explanation(self, explanation: PixelExplanation | None) -> None:
        """List the budget of a pixel; None clears it."""
        self.groups, self._notes = [], ()
        if explanation is not None:
            terms = [(term.name, _level(term.decibels), term.detail, term.decibels) for term in explanation.terms]
            whole = ("pixel", _level(explanation.level), "the sum of" if terms else "", 0.0)
            groups = (
                (whole, terms),
                (("returned by", "", "", 0.0), _contributions(explanation)),
                (("hidden by", "", "", 0.0), _obstructions(explanation)),
                (("estimated error", "", "", 0.0), _errors(explanation)),
            )
            self.groups = [(head, rows) for head, rows in groups if rows or head[1]]
            self._notes = explanation.approximations
        self.write()

    def text(self) -> str:
        """HTML of the groups and notes."""
        lines = []
        for head, rows in self.groups:
            lines.append(_line(head, "", theme.ACCENT))
            most = max((abs(row[3]) for row in rows if math.isfinite(row[3])), default=0.0)
            lines += [_line(row, _bar(row[3], most), theme.TEXT) for row in rows]
        notes = "".join(f'<p style="color:{theme.QUIET.name()}">{html.escape(note)}</p>' for note in self._notes)
        return f'<table cellspacing="3">{"".join(lines)}</table>{notes}'


def _line(row: Row, bar: str, colour: QColor) -> str:
    """Row of a table: level, bar, name and detail."""
    name, level, detail = map(html.escape, row[:3])
    return (
        f'<tr><td align="right" style="white-space:nowrap">{level}</td><td style="white-space:nowrap">{bar}</td>'
        f'<td><span style="color:{colour.name()}">{name}</span> '
        f'<span style="color:{theme.QUIET.name()}">{detail}</span></td></tr>'
    )


def _bar(value: float, most: float) -> str:
    """Bar as long as a number beside the greatest one; losses have another colour than gains and shares."""
    if not math.isfinite(value) or most == 0.0:
        return ""
    eighths = round(8 * LONGEST * abs(value) / most)
    blocks = "█" * (eighths // 8) + ("", *"▏▎▍▌▋▊▉")[eighths % 8]
    return f'<span style="color:{(theme.MARK if value < 0.0 else theme.ACCENT).name()}">{blocks}</span>'


def _contributions(explanation: PixelExplanation) -> list[Row]:
    return [
        (each.words, _percent(each.share), f"at {each.ground_range:.1f} m, incidence {each.incidence:.0f}°", each.share)
        for each in explanation.contributions[:MOST]
    ]


def _obstructions(explanation: PixelExplanation) -> list[Row]:
    """List what hides the bed, and the level that the pixel would have if nothing did."""
    hiders = [
        (
            each.hider,
            _percent(each.share),
            "a slope that faces away" if each.faces_away else f"at {each.ground_range:.1f} m",
            each.share,
        )
        for each in explanation.obstructions[:MOST]
    ]
    return [*hiders, ("if nothing hid it", _level(explanation.unhidden), "", math.nan)] if hiders else []


def _errors(explanation: PixelExplanation) -> list[Row]:
    """Errors of tracing where they are known: of the side of the ping, and of this bin over its mean echo."""
    side = ("of this side of the ping", format_share(explanation.error), "", math.nan)
    own = ("of this bin", format_share(explanation.bin_error), "of its mean echo", math.nan)
    return [row for row, error in ((side, explanation.error), (own, explanation.bin_error)) if not math.isnan(error)]


def _percent(share: float) -> str:
    return f"{100.0 * share:.1f} %"


def _level(level: float) -> str:
    """Level with a true minus sign; no echo has none."""
    if not math.isfinite(level):
        return "no echo"
    return f"{round(level, 2) + 0.0:.2f} dB".replace("-", "−")
