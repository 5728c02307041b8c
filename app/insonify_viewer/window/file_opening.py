"""Opens files of every kind that the window takes: from dialogs, by drops, and from the list of recent ones."""

import math
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from psygnal import Signal
from PySide6.QtWidgets import QFileDialog

from insonify.commands.info import read_cast_or_navigation
from insonify.files import bundled_targets
from insonify.io.bathymetry import BATHYMETRY
from insonify.io.contacts import is_contacts, read_contacts
from insonify.io.formats import FormatRegistry
from insonify.io.meshes import MESHES
from insonify.io.navigation import NAVIGATION, RecordedNavigation
from insonify.io.records import RECORDS
from insonify.io.sealed import SUFFIX
from insonify.io.sound_speed_casts import CASTS, Cast
from insonify.scene import Scene, SceneError, bundled_meshes, bundled_scenes, edit, load_scene
from insonify_viewer.core_types import Ground
from insonify_viewer.errors import Failure
from insonify_viewer.record.comparison.recording import is_recording
from insonify_viewer.record.comparison.recording_player import RecordingPlayer
from insonify_viewer.state.session import ContactList, Session
from insonify_viewer.widgets.gallery import Gallery
from insonify_viewer.window.main_window import MainWindow
from insonify_viewer.window.new_scene import NewScene
from insonify_viewer.window.saving import Saving
from insonify_viewer.work.simulator import Simulator

SCENE = ".toml"
TAKES = "a scene (.toml), an exercise, a recording, contacts, a grid of heights, a mesh, a measured cast or navigation"
MAPS = "Pictures (*.png *.tif *.tiff);;All files (*)"
SHARE = 0.3  # slant range over the grid's shorter side
GRAZING = 0.15  # clearance over slant range
LONGEST_RANGE = 1000.0  # m


class FileOpening:
    """Asks for files, and opens a file by its suffix."""

    mesh_opened = Signal(str)  # path of a mesh that becomes a target
    exercise_opened = Signal(str)  # path of an exercise

    def __init__(
        self,
        session: Session,
        simulator: Simulator,
        window: MainWindow,
        recordings: RecordingPlayer,
        contacts: ContactList,
        saving: Saving,
        opened: Callable[[Scene, str], None],
    ) -> None:
        self._session, self._simulator, self._window, self._opened = session, simulator, window, opened
        self._recordings, self._contacts, self._saving = recordings, contacts, saving
        self._folder = str(next(iter(bundled_scenes().values())).parent)
        window.files_wanted.connect(self.open_dropped)
        window.open_contacts.triggered.connect(self.ask_for_contacts)
        window.scenes.wanted.connect(self.open_scene)
        window.recent.wanted.connect(self.open_recent)
        window.new_scene.triggered.connect(self.ask_for_new_scene)
        window.open_scene.triggered.connect(self.ask_for_scene)
        window.open_recording.triggered.connect(lambda: self.open_recording(self.ask_for_recording()))
        window.open_dem.triggered.connect(lambda: self.ask_for_dem(session.scene))

    def open_dropped(self, paths: Sequence[str]) -> None:
        """Open a file that is dropped; of several, one would replace what another had just become."""
        if len(paths) == 1:
            self.open(paths[0])
        else:
            self._window.complain(Failure(f"{len(paths)} files were dropped at once; drop one file at a time"))

    def open(self, path: str) -> None:
        """Open a file by its suffix; an error lists the kinds of files if none fits."""
        suffix = Path(path).suffix.lower()
        if suffix == SCENE:
            self.open_scene(path)
        elif suffix == SUFFIX:
            self.exercise_opened.emit(path)
        elif is_recording(path):
            self.open_recording(path)
        elif suffix in BATHYMETRY.readable():
            self.open_dem(self._session.scene, path)
        elif suffix in MESHES.readable():
            self.mesh_opened.emit(path)
        elif is_contacts(path):
            self.open_contacts(path)
        elif suffix in (*CASTS.readable(), *NAVIGATION.readable()):
            self._window.say(f"reading {Path(path).name} …")
            self._simulator.send(lambda: read_cast_or_navigation(path), partial(self._use, path))
        else:
            self._window.complain(Failure(f"{Path(path).name}: cannot be opened by its suffix; give {TAKES}"))

    def ask_for_new_scene(self) -> None:
        """Let the person put a scene together, after the question about unsaved changes."""
        if self._saving.may_leave():
            question = NewScene(self._window)
            if question.exec():
                try:
                    self._opened(question.scene, "")
                except SceneError as error:
                    self._window.complain(error)

    def ask_for_scene(self) -> None:
        """Let the person pick a scene, after the question about unsaved changes."""
        if self._saving.may_leave():
            kinds = f"Scenes (*{SCENE});;Exercises (*{SUFFIX})"
            path, _ = QFileDialog.getOpenFileName(self._window, "Open a scene", self._folder, kinds)
            if path.lower().endswith(SUFFIX):
                self.exercise_opened.emit(path)
            elif path:
                self._load(path)

    def open_recent(self, path: str) -> None:
        """Open a recent file; one that no longer exists is taken from the list, with a message."""
        if Path(path).exists():
            self.open(path)
        else:
            self._window.settings.forget_recent(path)
            self._window.say(f"{path} is no longer there; it was removed from the recent files")

    def open_scene(self, path: str) -> None:
        """Open a scene file, after the question about unsaved changes."""
        if self._saving.may_leave():
            self._load(path)

    def _load(self, path: str) -> None:
        try:
            scene = load_scene(path)
        except SceneError as error:
            self._window.complain(error)
            return
        self._folder = str(Path(path).parent)
        self._opened(scene, path)

    def ask_for_contacts(self) -> None:
        """Let the person pick a file of contacts, and read it in place of the present ones."""
        folder, kinds = str(Path(self._session.file or ".").parent), "Contacts (*.geojson *.csv);;All files (*)"
        path, _ = QFileDialog.getOpenFileName(self._window, "Open contacts", folder, kinds)
        if path:
            self.open_contacts(path)

    def open_contacts(self, path: str) -> None:
        """Read contacts in place of the present ones, after the question about those that are not saved."""
        if not self._saving.may_replace_contacts():
            return
        try:
            self._contacts.open(read_contacts(Path(path)), path)
        except SceneError as error:
            self._window.complain(error)
            return
        self._window.settings.add_recent(path)
        number = len(self._contacts)
        self._window.say(f"{number} contact{'s' * (number != 1)} of {Path(path).name}")

    def open_recording(self, path: str) -> None:
        """Show a recording; an empty path does nothing."""
        if path and Path(path).exists():
            self._window.settings.add_recent(path)
        self._recordings.open(path)

    def _use(self, path: str, part: Cast | RecordedNavigation | SceneError) -> None:
        """Make a cast the water of the scene, or navigation its motion, with a message, or show the error."""
        if isinstance(part, SceneError):
            self._window.complain(part)
            return
        if isinstance(part, Cast):
            name = f"sound speed of {Path(path).name}"
            said = f"{name}: {part.depth.size} depths, down to {part.depth[-1]:.4g} m"
            changes: dict[str, Any] = {"water.kind": "cast", "water.path": path}
        else:
            name = f"navigation of {Path(path).name}"
            said = f"{name}: {', '.join(part.columns)} at {part.time.size} times, {part.time[-1]:.4g} s in all"
            changes = {"track.motion": {"kind": "recorded", "path": path}}
        if self._session.settle(changes, name, said):
            self.keep_recent(path)

    def ask_for_recording(self) -> str:
        """Let the person pick a recording, or a record written here; return its path, empty if none was picked."""
        return self._ask("Open a recording", "Recordings and records", RECORDS)

    def _ask(self, title: str, kind: str, formats: FormatRegistry[Any]) -> str:
        """Let the person pick a file of one of the readable formats; return its path, empty if none was picked."""
        patterns = " ".join(f"*{suffix}" for suffix in formats.readable())
        return QFileDialog.getOpenFileName(self._window, title, "", f"{kind} ({patterns});;All files (*)")[0]

    def ask_for_dem(self, scene: Scene) -> bool:
        """Let the person pick a measured bed for a scene; return whether one was picked."""
        path = self._ask("Open a measured bed", "Grids of heights", BATHYMETRY)
        if path:
            self.open_dem(scene, path)
        return bool(path)

    def ask_for_mesh(self) -> str:
        """Let the person pick a mesh; return its path, the name of a bundled one, or an empty string."""
        gallery, picked = Gallery("Library of targets", self._window), list[str]()
        for name, file in bundled_meshes().items():
            gallery.add(str(file), bundled_targets().get(name, name), f"<p>{name}</p>")
        gallery.add("", "Other file…", "<p>Open a mesh of your own</p>")
        gallery.wanted.connect(picked.append)
        gallery.exec()
        path = self._ask("Open a mesh", "Meshes", MESHES) if picked == [""] else "".join(picked)
        return next((name for name, file in bundled_meshes().items() if file == Path(path)), path)

    def ask_for(self, path: str) -> str:
        """Let the person pick a file for a field of the scene; return its path, empty if none was picked."""
        if path.startswith("targets"):
            return self.ask_for_mesh()
        if path.startswith("track.motion"):
            return self._ask("Open recorded navigation", "Recorded navigation", NAVIGATION)
        if path.startswith("water"):
            return self._ask("Open a measured cast", "Measured casts", CASTS)
        title, kinds = "Open a file", "All files (*)"
        if path.startswith("seabed.material"):
            title, kinds = "Open a map of materials", MAPS
        return QFileDialog.getOpenFileName(self._window, title, "", kinds)[0]

    def open_dem(self, scene: Scene, path: str) -> None:
        """Lay a scene over a measured bed, which the worker reads, after the question about unsaved changes."""
        # It is another scene: another bed elsewhere, without the targets, and with a track of its own.
        if self._saving.may_leave():
            self._window.say(f"reading {Path(path).name} …")
            self._simulator.send(lambda: scene_over_dem(scene, path), partial(self._show_dem, path, len(scene.targets)))

    def keep_recent(self, path: str) -> None:
        """Put a file that became a part of the scene on top of the recent ones, if a drop would open it as the same."""
        taken = Path(path).suffix and Path(path).exists() and not is_recording(path)
        if taken and Path(path) not in bundled_meshes().values():
            self._window.settings.add_recent(path)

    def _show_dem(self, path: str, removed: int, result: Scene | SceneError) -> None:
        """Show a scene over a measured bed, or the error of reading it."""
        if isinstance(result, SceneError):
            self._window.complain(result)
            return
        self._opened(result, "")
        self.keep_recent(path)
        if removed:
            were = "target was" if removed == 1 else f"{removed} targets were"
            self._window.say(f"bed of {Path(path).name}; the {were} removed with the scene before (Undo restores it)")


def scene_over_dem(scene: Scene, path: str) -> Scene:
    """Replace the bed of a scene by a grid of heights, and lay the track across its middle."""
    # lazy: the window opens before Numba is loaded
    from insonify.acoustics.water import speed_at_sonar
    from insonify.terrain import EndlessGround, build_ground

    bare = edit(scene, {"seabed.relief": {"kind": "dem", "path": path}, "targets": []})
    ground = build_ground(bare)
    assert not isinstance(ground, EndlessGround)  # a measured bed is finite
    x, y, length = _crossing(ground)
    reach = _two_digits(min(SHARE * min(ground.heights.shape) * ground.spacing, LONGEST_RANGE))
    rate = min(scene.sonar.ping_rate, _two_digits(0.95 * speed_at_sonar(bare, ground.datum) / (2.0 * reach)))
    clearance = float(np.nanmax(ground.heights)) + GRAZING * reach
    return edit(
        bare,
        {
            "title": path.rsplit("/", 1)[-1],
            "sonar.range": reach,
            "sonar.ping_rate": rate,
            "track.start": [x, y],
            "track.heading": 0.0,
            "track.depth": None,
            "track.altitude": round(clearance, 2),
            "track.speed": min(max(_two_digits(length * rate / scene.track.pings), 0.01), 50.0),
        },
    )


def _crossing(ground: Ground) -> tuple[float, float, float]:
    """Start and length of the line along +x, among the middle rows, with most bed below it."""
    ny = len(ground.heights)
    rows = np.arange(ny // 4, max(3 * ny // 4, ny // 4 + 1))
    finite = np.isfinite(ground.heights[rows])
    row = int(rows[np.argmax(finite.sum(axis=1) - 1e-3 * abs(rows - ny / 2))])
    columns = np.flatnonzero(np.isfinite(ground.heights[row]))
    first, last = (int(columns[0]), int(columns[-1])) if columns.size else (0, ground.heights.shape[1] - 1)
    start = ground.x0 + first * ground.spacing
    return start, ground.y0 + row * ground.spacing, max((last - first) * ground.spacing, ground.spacing)


def _two_digits(value: float) -> float:
    """Round down to two significant digits."""
    step = 10.0 ** (math.floor(math.log10(value)) - 1)
    return round(math.floor(value / step + 1e-9) * step, 12)
