"""File dialogs that open: scenes, recordings, measured beds, casts, navigation, meshes."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from PySide6.QtWidgets import QFileDialog

from insonify.io.bathymetry import BATHYMETRY
from insonify.io.formats import FormatRegistry
from insonify.io.meshes import MESHES
from insonify.io.navigation import NAVIGATION
from insonify.io.records import RECORDS
from insonify.io.sound_speed_casts import CASTS
from insonify.scene import Scene, SceneError, bundled_meshes, bundled_scenes, edit, load_scene
from insonify_viewer.record.comparison.recording import is_recording
from insonify_viewer.work.simulator import Simulator

if TYPE_CHECKING:
    from insonify.terrain.ground import Ground
    from insonify_viewer.window.main_window import MainWindow

MAPS = "Pictures (*.png *.tif *.tiff);;All files (*)"
SHARE = 0.3  # slant range over the grid's shorter side
GRAZING = 0.15  # clearance over slant range
LONGEST_RANGE = 1000.0


class FileDialogs:
    """Asks for files, opens them, and reports errors in one sentence."""

    def __init__(
        self,
        window: MainWindow,
        simulator: Simulator,
        opened: Callable[[Scene, str], None],
        may_leave: Callable[[], bool],
    ) -> None:
        self._window, self._simulator, self._opened, self._may_leave = window, simulator, opened, may_leave
        self._folder = str(next(iter(bundled_scenes().values())).parent)
        self._meshes = str(next(iter(bundled_meshes().values())).parent)

    def ask_for_scene(self) -> None:
        """Let the person pick a scene."""
        path, _ = QFileDialog.getOpenFileName(self._window, "Open a scene", self._folder, "Scenes (*.toml)")
        if path:
            self.open_scene(path)

    def ask_for_recording(self) -> str:
        """Let the person pick a recording, or a record written here; return its path, empty if none was picked."""
        return self._ask("Open a recording", "Recordings and records", RECORDS)

    def _ask(self, title: str, kind: str, formats: FormatRegistry[Any], folder: str = "") -> str:
        """Let the person pick a file of one of the readable formats; return its path, empty if none was picked."""
        patterns = " ".join(f"*{suffix}" for suffix in formats.readable())
        return QFileDialog.getOpenFileName(self._window, title, folder, f"{kind} ({patterns});;All files (*)")[0]

    def ask_for_dem(self, scene: Scene) -> bool:
        """Let the person pick a measured bed for a scene; return whether one was picked."""
        path = self._ask("Open a measured bed", "Grids of heights", BATHYMETRY)
        if path:
            self.open_dem(scene, path)
        return bool(path)

    def ask_for_tow(self) -> str:
        """Let the person pick recorded navigation; return its path, empty if none was picked."""
        return self._ask("Open recorded navigation", "Recorded navigation", NAVIGATION)

    def ask_for_map(self) -> str:
        """Let the person pick a map of materials; return its path, empty if none was picked."""
        return QFileDialog.getOpenFileName(self._window, "Open a map of materials", "", MAPS)[0]

    def ask_for_cast(self) -> str:
        """Let the person pick a measured cast; return its path, empty if none was picked."""
        return self._ask("Open a measured cast", "Measured casts", CASTS)

    def ask_for_contacts(self, folder: str) -> str:
        """Let the person pick a file of contacts; return its path, empty if none was picked."""
        kinds = "Contacts (*.geojson *.csv);;All files (*)"
        return QFileDialog.getOpenFileName(self._window, "Open contacts", folder, kinds)[0]

    def ask_for_mesh(self) -> str:
        """Let the person pick a mesh; return its path, the name of a bundled one, or an empty string."""
        path = self._ask("Open a mesh", "Meshes", MESHES, self._meshes)
        if path:
            self._meshes = str(Path(path).parent)
        return next((name for name, file in bundled_meshes().items() if file == Path(path)), path)

    def ask_for(self, path: str) -> str:
        """Let the person pick a file for a field of the scene; return its path, empty if none was picked."""
        dialogs = {
            "seabed.material": self.ask_for_map,
            "track.motion": self.ask_for_tow,
            "targets": self.ask_for_mesh,
            "water": self.ask_for_cast,
        }
        ask = next((ask for part, ask in dialogs.items() if path.startswith(part)), None)
        return ask() if ask else QFileDialog.getOpenFileName(self._window, "Open a file", "", "All files (*)")[0]

    def open_scene(self, path: str) -> None:
        """Open a scene file."""
        try:
            scene = load_scene(path)
        except SceneError as error:
            self._window.complain(error)
            return
        self._folder = str(Path(path).parent)
        self._opened(scene, path)

    def open_dem(self, scene: Scene, path: str) -> None:
        """Lay a scene over a measured bed, which the worker reads, after the question about unsaved changes.

        It is another scene: another bed elsewhere, without the targets, and with a track of its own.
        """
        if self._may_leave():
            self._window.say(f"reading {Path(path).name} …")
            self._simulator.send(lambda: scene_over_dem(scene, path), partial(self._show_dem, path, len(scene.targets)))

    def keep_recent(self, path: str) -> None:
        """Put a file that became a part of the scene on top of the recent ones, if a drop would open it as the same."""
        taken = Path(path).suffix and Path(path).exists() and not is_recording(path)
        if taken and Path(path) not in bundled_meshes().values():
            self._window.settings.add_recent(path)

    def _show_dem(self, path: str, removed: int, result: Scene | SceneError) -> None:
        """Show a scene over a measured bed, or say why that cannot be read."""
        if isinstance(result, SceneError):
            self._window.complain(result)
            return
        self._opened(result, "")
        self.keep_recent(path)
        if removed:
            targets = "target of the scene before is" if removed == 1 else f"{removed} targets of the scene before are"
            self._window.say(f"bed of {Path(path).name}; the {targets} removed (Undo brings all back)")


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
