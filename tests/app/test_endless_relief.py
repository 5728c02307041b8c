"""Heights of endless ground may take a second: the main thread never computes them."""

from __future__ import annotations

import threading
from typing import Any

import pytest

from insonify.array_cache import ARRAYS
from insonify.scene import edit, load_scene
from insonify.simulation import prepare
from insonify.terrain import build
from insonify.terrain.endless_ground import Tiles
from insonify_viewer.session import Mark


@pytest.fixture
def summing(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """Names of the threads that sum the relief of a tile."""
    names: list[str] = []
    endless_heights = build.endless_heights

    def watched(*given: Any) -> Tiles:
        tiles = endless_heights(*given)

        def tile(row: int, column: int) -> Any:
            names.append(threading.current_thread().name)
            return tiles(row, column)

        return tile

    monkeypatch.setattr(build, "endless_heights", watched)
    build._kept_tiles.cache_clear()
    return names


def test_the_main_thread_never_sums_the_relief(open_viewer: Any, summing: list[str], qtbot: Any) -> None:
    scene = edit(load_scene("endless"), {"sonar.bins": 100, "track.pings": 128, "seed": 77})
    viewer = open_viewer(scene, prepare=prepare)
    qtbot.waitUntil(lambda: viewer.seabed.complete, timeout=60000)
    ARRAYS.clear()  # as when other scenes were open meanwhile
    summing.append("looking back")
    viewer.go_to(40)
    qtbot.waitUntil(lambda: viewer.window.waterfall.top == 40)
    qtbot.waitUntil(lambda: summing[-1] != "looking back", timeout=60000)
    ARRAYS.clear()
    summing.append("pointing")
    viewer.session.point_at(Mark(30, 0, 60))
    qtbot.waitUntil(lambda: summing[-1] != "pointing", timeout=60000)
    assert threading.main_thread().name not in summing
    qtbot.waitUntil(lambda: viewer._marks._point is not None and viewer._marks._point.mark == Mark(30, 0, 60))
