"""Tour of the window in five steps: a card that stays in its place, and a frame round the part that it speaks of."""

import tomllib
from collections.abc import Callable
from typing import NamedTuple

from PySide6.QtCore import QEvent, QObject, QPoint, QRect, Qt, QTimer
from PySide6.QtGui import QKeyEvent, QRegion
from PySide6.QtWidgets import QFrame, QHBoxLayout, QLabel, QVBoxLayout, QWidget
from shiboken6 import isValid

from insonify.files import resources
from insonify_viewer.errors import guard_override
from insonify_viewer.widgets.buttons import make, push_button
from insonify_viewer.widgets.layouts import fill
from insonify_viewer.widgets.theme import ACCENT

WIDTH, APART = 300, 48  # px: of the card, and its distance from the lower edge of the window
FOLLOWS = 50  # ms, after which the frame is where its part is
LINE = 3  # px, of the frame


class TourStep(NamedTuple):
    """One step: its title, what it says, and what finds the part of the window that it describes."""

    title: str
    words: str
    part: Callable[[], QWidget | None]


class Tour(QObject):
    """Leads through a window step by step; nothing is locked meanwhile."""

    def __init__(self, window: QWidget, steps: tuple[TourStep, ...]) -> None:
        super().__init__(window)
        self._window, self._steps = window, steps
        self._place = 0
        self._shown: tuple[TourStep, ...] = ()
        self._outline: _Outline | None = None
        self._before: QWidget | None = None  # what had the keyboard before the tour
        self.card: TourCard | None = None
        self._follows = QTimer(self, interval=FOLLOWS)
        self._follows.timeout.connect(self._follow)
        window.installEventFilter(self)

    def begin(self) -> None:
        """Show the first step."""
        self.end()
        parts = [(step, step.part()) for step in self._steps]
        self._shown = tuple(step for step, part in parts if part is not None and part.isVisible())
        if not self._shown:
            return
        self._place = 0
        self._outline, self.card = _Outline(self._window), TourCard(self._window)
        self.card.back.clicked.connect(lambda: self._go(-1))
        self.card.next.clicked.connect(lambda: self._go(1))
        self.card.skip.clicked.connect(self.end)
        self._show()
        self._before = self._window.focusWidget()
        self.card.next.setFocus()
        self._follows.start()

    def end(self) -> None:
        """Leave the tour; the keyboard returns to where it was, unless it has left the card meanwhile."""
        if self.card is not None and self._outline is not None:
            if self.card.isAncestorOf(self._window.focusWidget()) and self._before and isValid(self._before):
                self._before.setFocus()
            for widget in (self.card, self._outline):
                widget.hide()
                widget.deleteLater()
        self.card = self._outline = None
        self._follows.stop()

    @guard_override(False)
    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        """Follow the window when its size changes, and leave the tour by Escape, unless a widget takes that key."""
        if event.type() is QEvent.Type.Resize:
            self._follow()
        if self.card is None or not isinstance(event, QKeyEvent) or event.type() is not QEvent.Type.KeyPress:
            return False
        escaped = event.key() == Qt.Key.Key_Escape
        if escaped:
            self.end()
        return escaped

    def _go(self, steps: int) -> None:
        self._place += steps
        if self._place >= len(self._shown):
            self.end()
        else:
            self._show()

    def _show(self) -> None:
        """Show the present step."""
        if self.card is not None:
            self.card.show_step(self._shown[self._place], self._place + 1, len(self._shown))
            self._follow()
            self.card.show()
            self.card.raise_()

    def _follow(self) -> None:
        """Frame the part of the present step where it is now; the buttons of the card stay under the hand."""
        if self.card is None or self._outline is None:
            return
        part, window = self._shown[self._place].part(), self._window.rect()
        frame = QRect() if part is None else QRect(part.mapTo(self._window, QPoint(0, 0)), part.size())
        self._outline.show_about(frame)
        self.card.move(window.center().x() - WIDTH // 2, max(window.bottom() - APART - self.card.height(), 0))


class TourCard(QFrame):
    """Title, words and buttons of a step."""

    def __init__(self, window: QWidget) -> None:
        super().__init__(window)
        self.setObjectName("tour")
        self.setFixedWidth(WIDTH)
        lay_over_native_views(self)
        self.title, self.words = make(QLabel, objectName="choice"), QLabel(wordWrap=True)
        self.skip = push_button("Skip", "Leave the tour (Escape); Help, Tour shows it again")
        self.back = push_button("Back", "To the step before")
        self.next = push_button("Next", "To the next step")
        buttons = fill(QHBoxLayout(), self.skip, None, self.back, self.next)
        fill(QVBoxLayout(self), self.title, self.words, buttons)

    def show_step(self, step: TourStep, number: int, count: int) -> None:
        """Show one of several steps."""
        self.title.setText(f"{number} of {count}: {step.title}")
        self.words.setText(step.words)
        self.back.setEnabled(number > 1)
        self.next.setText("Next" if number < count else "Done")
        self.skip.setVisible(number < count)
        self.adjustSize()
        self.resize(WIDTH, self.heightForWidth(WIDTH) if self.hasHeightForWidth() else self.sizeHint().height())


class _Outline(QFrame):
    """Frame round a part of the window, which it leaves to the mouse."""

    def __init__(self, window: QWidget) -> None:
        super().__init__(window)
        self.setStyleSheet(f"background: {ACCENT.name()}")
        lay_over_native_views(self)

    def show_about(self, part: QRect) -> None:
        """Frame a rectangle of the window."""
        if part == self.geometry() and self.isVisible():
            return
        self.setGeometry(part)
        self.setMask(QRegion(self.rect()) - QRegion(self.rect().adjusted(LINE, LINE, -LINE, -LINE)))
        self.show()
        self.raise_()


def lay_over_native_views(widget: QWidget) -> None:
    """Give a widget a native window: the record and the 3-D view have one, and hide widgets that have none."""
    widget.setAttribute(Qt.WidgetAttribute.WA_DontCreateNativeAncestors)
    widget.setAttribute(Qt.WidgetAttribute.WA_NativeWindow)


def tour_steps(*parts: Callable[[], QWidget | None]) -> tuple[TourStep, ...]:
    """Make the steps of the tour: scenes, parameters, record, seabed, menu bar."""
    steps = tomllib.loads((resources() / "window" / "tour.toml").read_text(encoding="utf-8"))["step"]
    return tuple(TourStep(step["title"], step["words"], part) for step, part in zip(steps, parts, strict=True))
