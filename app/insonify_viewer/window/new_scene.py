"""A new scene, put together from a bed, a sonar, a track and targets."""

import math
from collections.abc import Iterable, Sequence
from pathlib import Path

import numpy as np
from PySide6.QtCore import QSize, Qt
from PySide6.QtWidgets import (
    QComboBox,
    QDoubleSpinBox,
    QListWidget,
    QSpinBox,
    QWidget,
)

from insonify.files import bundled_sonars
from insonify.scene import Scene, bundled_meshes, bundled_scenes, edit, load_scene, plain
from insonify.scene.sonar.presets import read_preset
from insonify.tow.line import tow_line_at
from insonify_viewer.widgets.gallery import add_choice, choices_list
from insonify_viewer.widgets.question import Question

# Beds by the bundled scenes that have them.
BEDS = {
    "level sand": "pipe-on-bed",
    "fractal sand": "default",
    "ripples in patches": "ripples",
    "ripples": "figure-6",
    "rough ground": "rough-ground",
    "seven sediments": "sediments",
    "rock and gravel": "wreck",
    "a measured landscape": "real-bed",
}
ABEAM, FLOWN = 0.4, 0.1  # of the ground range at which targets lie, and of the range at which the fish flies
ROW = 170  # px, height of a row of pictures


def compose_scene(bed: str, sonar: str, depth: float, altitude: float, pings: int, meshes: Sequence[str]) -> Scene:
    """Put a scene together: bed of a bundled scene, preset of a sonar, and meshes along the track, left and right."""
    bare = {"title": "Untitled", "description": "", "targets": [], "controls": []}
    seabed = plain(load_scene(bed))["seabed"] | ({} if bed == "real-bed" else {"depth": depth})
    scene = edit(load_scene("default"), bare | {"seabed": seabed})
    scene = edit(scene, {"sonar.preset": sonar})
    scene = edit(scene, {"track.altitude": altitude, "track.pings": pings})
    reach = ABEAM * math.sqrt(max(scene.sonar.range**2 - altitude**2, 0.0))
    line = tow_line_at(scene, (np.arange(len(meshes)) + 0.5) * pings / max(len(meshes), 1))
    sides = np.where(np.arange(len(meshes)) % 2 == 0, -reach, reach)
    places = np.round([line.x - sides * np.sin(line.heading), line.y + sides * np.cos(line.heading)], 2).T
    targets = [{"kind": "mesh", "path": mesh, "position": list(at)} for mesh, at in zip(meshes, places.tolist())]
    return edit(scene, {"targets": targets})


class NewScene(Question):
    """Asks for the parts of a new scene."""

    def __init__(self, window: QWidget) -> None:
        super().__init__("New scene", window)
        self.beds, self.targets = choices_list("Seabed"), choices_list("Targets")
        scenes, meshes = bundled_scenes(), bundled_meshes()
        _fill(self.beds, ((name, scenes[scene], scene) for name, scene in BEDS.items()))
        _fill(self.targets, ((name.replace("-", " "), path, name) for name, path in meshes.items()))
        self.beds.setCurrentRow(0)
        self.targets.setSelectionMode(self.targets.SelectionMode.MultiSelection)
        self.sonar = QComboBox()
        for name in bundled_sonars():
            self.sonar.addItem(str(read_preset(name)["title"]), name)
        self.sonar.setCurrentIndex(self.sonar.findData("towfish-400"))
        self.water_depth, self.altitude = (QDoubleSpinBox(suffix=" m", minimum=0.5, maximum=6000.0) for _ in range(2))
        self.water_depth.setValue(30.0)
        self.pings = QSpinBox(minimum=1, maximum=1_000_000, value=512)
        self.add("Seabed", self.beds, "The bed of a bundled scene")
        self.add("Sonar", self.sonar, "Frequency, beams, pulse and range of a class of sonars")
        self.add("Water depth", self.water_depth, "Depth of the water over the middle level of the bed")
        self.add("Altitude", self.altitude, "Height of the towfish over the bed; a tenth of the range is usual")
        self.add("Pings", self.pings, "Length of the track, in pings")
        self.add("Targets", self.targets, "Targets left and right of the track in turns; a click picks or drops one")
        self.end()
        self.sonar.currentIndexChanged.connect(self._fly)
        self._fly()
        self.resize(QSize(760, 640).boundedTo(window.window().size()))

    @property
    def scene(self) -> Scene:
        """The scene that is put together."""
        meshes = [str(item.data(Qt.ItemDataRole.UserRole)) for item in self.targets.selectedItems()]
        bed = str(self.beds.currentItem().data(Qt.ItemDataRole.UserRole))
        sonar = str(self.sonar.currentData())
        return compose_scene(bed, sonar, self.water_depth.value(), self.altitude.value(), self.pings.value(), meshes)

    def _fly(self) -> None:
        """Suggest an altitude, and a depth that has room for it."""
        self.altitude.setValue(FLOWN * float(read_preset(str(self.sonar.currentData()))["sonar"]["range"]))
        self.water_depth.setValue(max(self.water_depth.value(), 1.5 * self.altitude.value()))


def _fill(choices: QListWidget, files: Iterable[tuple[str, Path, str]]) -> None:
    """Fill a row of pictures with names, files that have pictures, and what they stand for."""
    choices.setFixedHeight(ROW)
    for title, path, value in files:
        add_choice(choices, str(path), title, title, value)
