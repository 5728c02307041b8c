"""How quickly the record is drawn: printed, never asserted (run with -m bench -s)."""

import time

import numpy as np
import pytest
from PySide6.QtCore import QSize
from PySide6.QtGui import QImage

from insonify.display.display_options import DisplayOptions
from insonify.display.picture import compile_picture
from insonify_viewer.record.projection import Zoom
from insonify_viewer.record.record import Record
from insonify_viewer.record.waterfall_view import WaterfallView

pytestmark = pytest.mark.bench
PINGS, BINS, FRAMES = 1000, 1000, 200  # bins of one side
VIEWS = {
    "slant range": ({}, Zoom()),
    "newest below": ({"newest_on_top": False}, Zoom()),
    "ground range": ({"ground_range": True}, Zoom()),
    "gains, decibels, lines": (
        {"side_gains": (3.0, -3.0), "side_slopes": (5.0, 5.0), "decibels": True, "bottom_line": True,
         "range_lines": True},
        Zoom(),
    ),
    "zoomed by 4": ({}, Zoom().about(0.5, 0.5, 4.0)),
}  # fmt: skip


@pytest.mark.parametrize("name", VIEWS)
def test_a_scrolling_record(qtbot, name, say):
    """A frame takes a new ping over, scrolls and is painted at 1000 × 1000 px."""
    compile_picture()
    options, zoom = VIEWS[name]
    view, record, rng = WaterfallView(), Record(PINGS, BINS), np.random.default_rng(1)
    qtbot.addWidget(view)
    view.resize(QSize(1088, 1170))
    view.show()
    pings = np.arange(PINGS)
    amplitude = rng.rayleigh(0.8, (PINGS, 2, BINS)).astype(np.float32)
    record.put(pings, amplitude, 0, 10.0 + np.sin(pings / 30.0))
    view.show_record(record, 50.0, 0.1)
    began = time.perf_counter()
    view.show_display(DisplayOptions(**options, scale="fill"))
    view.show_zoom(zoom)
    whole = time.perf_counter() - began
    view.show_top(PINGS - 1)
    seconds, picture = [], QImage(view.size(), QImage.Format.Format_RGB32)
    for ping in range(PINGS, PINGS + FRAMES):
        began = time.perf_counter()
        sent = np.array([ping])
        view.show_rows(record.put(sent, amplitude[sent % PINGS], 0, np.array([10.0 + np.sin(ping / 30.0)])))
        view.show_top(ping)
        view.render(picture)
        seconds.append(time.perf_counter() - began)
    frame = 1e3 * np.array(seconds)
    say(
        f"{name}: a frame of {PINGS} × {2 * BINS} in {np.median(frame):.1f} ms (p99 {np.quantile(frame, 0.99):.1f}); "
        f"options changed in {1e3 * whole:.0f} ms"
    )
