"""Summary and budget of a pixel beside its cross-section."""

import html
import math
from typing import Any

import numpy as np
from PySide6.QtCore import QSize, Qt
from PySide6.QtGui import QColor
from PySide6.QtWidgets import QHBoxLayout, QVBoxLayout, QWidget

from insonify.arrays import Floats
from insonify.io.contacts import SIDES
from insonify_viewer.core_types import CrossSection, PixelExplanation
from insonify_viewer.state.inspection import Mark
from insonify_viewer.state.quantities import format_share
from insonify_viewer.widgets import theme
from insonify_viewer.widgets.buttons import make_label, push_button
from insonify_viewer.widgets.layouts import fill, make_splitter
from insonify_viewer.widgets.plot import Canvas, Plot
from insonify_viewer.widgets.text import ThemedText

HINT = (
    "Click a pixel of the record to see why it is bright or dark. Click a place in the 3-D view to light up the pixels "
    "that receive its echo."
)
BELOW, ABOVE = 0.12, 0.08  # of the water's height, drawn below the bed and above the sonar
FLATTEST = 1e-9  # least extent of heights as a share of them, so that their edges are two numbers

WATER, BED, HEARD, HIDDEN = "#1c3a52", "#4b3f2d", theme.ACCENT_IN_WATER, "#0a0604"
BLOCKED, RING, TARGET = "#ff7a5c", "#5b7d99", "#e8eef2"
SOLID, DASHED = Qt.PenStyle.SolidLine, Qt.PenStyle.DashLine
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


class SectionView(Plot):
    """Cross-section of the beam with the rays of a pixel."""

    ground = WATER

    def __init__(self) -> None:
        name, size = "Cross-section of the beam", QSize(100, 110)
        super().__init__(name, x="ground range (m)", grid=False, minimumSize=size)
        self.shown: tuple[PixelExplanation, CrossSection] | None = None

    def show_section(self, explanation: PixelExplanation | None, section: CrossSection | None) -> None:
        """Show a pixel in its cross-section; None clears it."""
        self.shown = None if explanation is None or section is None else (explanation, section)
        self.redraw()

    def draw(self, canvas: Canvas) -> None:
        """Draw water, bed, targets and rays over ground range, which grows to the left on the port side."""
        canvas.setVisible(self.shown is not None)
        if self.shown is None:
            return
        explanation, section = self.shown
        canvas.unit("left", "m")
        low, high = heights_shown(section, surfaced=any(each.path != "direct" for each in explanation.contributions))
        _draw_bed(canvas, section, low)
        # Places at the slant range of the pixel, were sound to go straight.
        angle = np.linspace(-0.5 * np.pi, 0.0, ARC)
        ring = np.column_stack([np.cos(angle), np.sin(angle)]) * explanation.slant_range
        canvas.line(ring[:, 0], _depth(section, ring[:, 1] + section.sonar.place[2]), RING, 1.0, style=DASHED)
        _draw_rays(canvas, section, explanation)
        canvas.dots([(0.0, _depth(section, section.sonar.place[2]))], theme.OVER_WATER, 10.0, HIDDEN)
        canvas.plotItem.vb.invertX(section.side == 0)
        self.limit((-0.02 * section.reach, section.reach), (_depth(section, low), _depth(section, high)))


def heights_shown(section: CrossSection, *, surfaced: bool) -> tuple[float, float]:
    """Heights at the lower and the upper edge of a section, m; ``surfaced`` shows the sea surface too."""
    bed = section.bed[np.isfinite(section.bed[:, 1]), 1]
    sonar = float(section.sonar.place[2])
    high = section.sonar.surface if surfaced else sonar
    # A fish towed at a depth may be below all of a measured bed.
    low = min(float(bed.min()) if bed.size else sonar - 1.0, high)
    tall = max(high - low, 1.0, FLATTEST * abs(low))
    return low - BELOW * tall, high + ABOVE * tall


def _depth(section: CrossSection, height: Any) -> Any:
    return section.sonar.surface - height


def _draw_bed(canvas: Canvas, section: CrossSection, low: float) -> None:
    """Draw the bed with its visible and hidden stretches, horizons and targets."""
    bed = section.bed[np.isfinite(section.bed[:, 1])]
    if len(bed):
        canvas.area(bed[:, 0], _depth(section, bed[:, 1]), _depth(section, low), BED)
    _draw_segments(canvas, section, section.horizon, RING, 1.0, style=Qt.PenStyle.DotLine)
    _draw_segments(canvas, section, section.visible, HEARD, 2.0)
    _draw_segments(canvas, section, section.hidden, HIDDEN, 3.5)
    for name, face in section.targets:
        _draw_segments(canvas, section, face, TARGET, 2.5)
        # Beyond and above its top, where the ray from the sonar does not cross it.
        x, top = face.reshape(-1, 2)[np.argmax(face[..., 1])]
        canvas.words(name, x, _depth(section, top), TARGET, (1.0 if section.side == 0 else 0.0, 1.0))


def _draw_rays(canvas: Canvas, section: CrossSection, explanation: PixelExplanation) -> None:
    """Draw rays, and where they lead."""
    drawn: list[tuple[str, tuple[Floats, ...], Floats]] = [
        (BLOCKED, each.rays[:1], each.places) for each in explanation.obstructions
    ]
    drawn += [(theme.MARK_IN_WATER, each.rays, each.places) for each in explanation.contributions]
    for colour, rays, places in drawn:
        for ray in rays:
            x, z = _flat(section, ray).T
            canvas.line(x, _depth(section, z), colour, 1.6)
        if len(places):
            _draw_segments(canvas, section, _flat(section, places.reshape(-1, 3)), colour, 4.0)


def _draw_segments(
    canvas: Canvas, section: CrossSection, ends: Floats, colour: str, width: float, style: Qt.PenStyle = SOLID
) -> None:
    """Draw a line between every two ends, ground range and height each."""
    x, z = ends.reshape(-1, 2).T
    canvas.line(x, _depth(section, z), colour, width, segments=True, style=style)


def _flat(section: CrossSection, points: Floats) -> Floats:
    """Ground range and height of places in local coordinates, (n, 3) to (n, 2)."""
    level = points[:, :2] - section.sonar.place[:2]
    return np.column_stack([np.hypot(level[:, 0], level[:, 1]), points[:, 2]])


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
