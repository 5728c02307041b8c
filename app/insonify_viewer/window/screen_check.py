"""Check for a screen before Qt is started, which would end the process without one."""

from __future__ import annotations

import ctypes
import os
import sys

LIBRARIES = (
    "libegl1 libgl1 libglib2.0-0 libxkbcommon0 libdbus-1-3 libfontconfig1 "
    "libxcb-cursor0 libxcb-icccm4 libxcb-keysyms1 libxcb-shape0 libxkbcommon-x11-0"
)
APT = f"apt-get install {LIBRARIES}"
WINDOW_LIBRARIES = (
    "libxcb.so.1",
    "libxcb-cursor.so.0",
    "libxcb-icccm.so.4",
    "libxcb-keysyms.so.1",
    "libxcb-shape.so.0",
    "libxkbcommon-x11.so.0",
)


def why_no_window() -> str:
    """Return the reason why no window can be opened, as a clause; empty if one can."""
    if os.environ.get("QT_QPA_PLATFORM", "").startswith(("offscreen", "minimal")):
        return "QT_QPA_PLATFORM asks for no window"
    if not sys.platform.startswith("linux") or os.environ.get("WAYLAND_DISPLAY"):
        return ""
    if not os.environ.get("DISPLAY"):
        return "there is no display"
    missing = [name for name in WINDOW_LIBRARIES if _library(name) is None]
    if missing:
        return f"the system lacks {missing[0]}; install it with: {APT}"
    return "" if _answers() else f"display {os.environ['DISPLAY']} does not answer"


def _library(name: str) -> ctypes.CDLL | None:
    try:
        return ctypes.CDLL(name)
    except OSError:
        return None


def _answers() -> bool:
    """Whether the X server of this environment accepts a connection."""
    xcb = ctypes.CDLL(WINDOW_LIBRARIES[0])
    xcb.xcb_connect.restype = ctypes.c_void_p
    connection = ctypes.c_void_p(xcb.xcb_connect(None, None))
    failed = xcb.xcb_connection_has_error(connection)
    xcb.xcb_disconnect(connection)
    return not failed
