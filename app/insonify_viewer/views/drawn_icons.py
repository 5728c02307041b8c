"""Small icons that are drawn, because not every font has such signs."""

from __future__ import annotations

from collections.abc import Callable

from PySide6.QtCore import QRectF, Qt
from PySide6.QtGui import QColor, QIcon, QPainter, QPen, QPixmap

from insonify_viewer.views.theme import ACCENT, QUIET

SIZE, SCALE = 12, 3  # px, and how much finer it is drawn


def lock_icon(*, closed: bool) -> QIcon:
    """Return a padlock, open or closed."""

    def draw(painter: QPainter) -> None:
        painter.drawRoundedRect(QRectF(2.0, 5.5, 8.0, 5.5), 1.0, 1.0)
        shift = 0.0 if closed else 3.0
        painter.drawArc(QRectF(3.5 + shift, 1.0, 5.0, 9.0), 0, 180 * 16)

    return _icon(draw, ACCENT if closed else QUIET)


def copy_icon() -> QIcon:
    """Return two sheets, one behind the other."""

    def draw(painter: QPainter) -> None:
        painter.drawRect(QRectF(1.5, 1.5, 6.0, 6.0))
        painter.drawRect(QRectF(4.5, 4.5, 6.0, 6.0))

    return _icon(draw, QUIET)


def _icon(draw: Callable[[QPainter], None], colour: str) -> QIcon:
    pixmap = QPixmap(SIZE * SCALE, SIZE * SCALE)
    pixmap.fill(Qt.GlobalColor.transparent)
    painter = QPainter(pixmap)
    painter.setRenderHint(QPainter.RenderHint.Antialiasing)
    painter.scale(SCALE, SCALE)
    painter.setPen(QPen(QColor(colour), 1.2))
    draw(painter)
    painter.end()
    return QIcon(pixmap)
