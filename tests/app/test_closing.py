"""What a closed window leaves behind."""

from __future__ import annotations

import gc
from typing import Any

import pytest

from insonify.scene import Scene
from insonify_viewer.application import has_opengl


def test_a_closed_view_names_nothing_that_qt_deletes_with_the_window(open_viewer: Any, small: Scene) -> None:
    from pyvistaqt import QtInteractor

    viewer = open_viewer(small)
    if not has_opengl():
        pytest.skip("no OpenGL for a widget")
    kept = [found for found in gc.get_objects() if type(found) is QtInteractor and found._surface is not None]
    assert len(kept) == 1  # this window's own: those of the tests before left none
    viewer.window.close()
    assert kept[0]._surface is None
