"""The echo of one ping below the record."""

import numpy as np
from PySide6.QtCore import QRect
from PySide6.QtGui import QImage, QPainter

from insonify_viewer.record.echo_trace import draw_trace


def drawn(loudest: list[float]) -> QImage:
    image = QImage(200, 120, QImage.Format.Format_RGB32)
    image.fill(0)
    painter = QPainter(image)
    draw_trace(painter, QRect(0, 20, 200, 100), np.repeat(np.float32(loudest), 50), "echo of ping 1", None)
    painter.end()
    return image


def test_what_is_no_number_is_silent(qapp):
    assert drawn([1.0, np.nan, 0.1, np.nan]) == drawn([1.0, 0.0, 0.1, 0.0])
