"""The panel of the tow: steering by keys, the live tow, and an exercise that keeps what it hides."""

import json
import socket
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from pytestqt.qtbot import QtBot

from insonify.exercises.exercise import make_exercise, read_exercise, write_exercise
from insonify.io.contacts import Contact
from insonify.scene import Scene
from insonify_viewer.panels.tow.controller import TowPanel
from insonify_viewer.viewer import Viewer


def panel_of(viewer: Viewer) -> TowPanel:
    panel = viewer.panels["tow"]
    assert isinstance(panel, TowPanel)
    return panel


def test_keys_steer(open_viewer: Any, small: Scene, qtbot: QtBot) -> None:
    viewer: Viewer = open_viewer(small)
    panel = panel_of(viewer)
    keys = {action.text(): action for action in panel.view.keys}
    newest = viewer.tow.newest
    for _ in range(3):
        keys["Steer: port"].trigger()
    keys["Steer: faster"].trigger()
    helm = viewer.tow.helm
    assert helm is not None
    assert (helm.turn, helm.speed) == (3.0, small.track.speed + 0.25)
    keys["Steer: straight"].trigger()
    keys["Steer: starboard"].trigger()
    assert helm.turn == -1.0
    viewer.run(True)
    qtbot.waitUntil(lambda: helm.newest > newest + 3)
    line = helm.line(np.array([newest, helm.newest]))
    assert line.heading[1] < line.heading[0]


@pytest.fixture
def exercise(tmp_path: Path) -> Path:
    path = tmp_path / "search.exercise"
    write_exercise(path, make_exercise("harbour-search", 11))
    return path


def test_an_exercise_is_surveyed_and_marked(open_viewer: Any, small: Scene, exercise: Path, qtbot: QtBot) -> None:
    viewer: Viewer = open_viewer(small, prepare=None)
    panel = panel_of(viewer)
    viewer.files.open(str(exercise))
    truth = read_exercise(exercise)
    qtbot.waitUntil(lambda: viewer.tow.helm is not None)
    assert not viewer.session.scene.targets
    assert viewer.session.scene == truth.bare
    assert viewer.tow.helm is not None
    qtbot.waitUntil(lambda: viewer.complete)
    answer = viewer.answer
    assert answer is not None
    simulation = answer.simulation
    assert not simulation.scene.targets
    assert simulation.arrays.mesh.target.size == 0
    assert simulation.hidden.arrays.mesh.target.size > 0
    pings = np.array([3, 9])
    np.testing.assert_array_equal(simulation.intensity(pings), simulation.hidden.record(pings, simulation.poses(pings)))
    target = next(each for each in truth.hidden if each.wanted)
    viewer.contacts.add(Contact("it", "", "", 3, "port", 9, 12.0, x=target.x, y=target.y + 0.6, height=target.height))
    panel.view.hand_in.click()
    assert f"it: {target.name}, 0.60 m away, height +0.00 m" in panel.view.marks
    assert "of the area covered, in " in panel.view.marks
    viewer.open(small)
    assert viewer.tow.helm is None
    assert not panel.view.hand_in.isEnabled()


def test_the_live_tow_runs_beside_the_window(open_viewer: Any, small: Scene, qtbot: QtBot) -> None:
    viewer: Viewer = open_viewer(small)
    panel = panel_of(viewer)
    for port in panel.view.ports.values():
        with socket.create_server(("127.0.0.1", 0)) as free:
            port.setValue(free.getsockname()[1])
    panel.view.live.click()
    (job,) = viewer.jobs.running
    port = panel.view.ports["Control"].value()

    def answer() -> bool:
        try:
            with socket.create_connection(("127.0.0.1", port), 5.0) as connection:
                connection.sendall(b'{"stream": true}\n')
                lines = connection.makefile()
                return json.loads(next(lines)) == {"done": "stream"} and json.loads(next(lines))["fish"] == 0
        except OSError:
            return False

    qtbot.waitUntil(answer)
    job.stop()
    qtbot.waitUntil(lambda: not job.running)
