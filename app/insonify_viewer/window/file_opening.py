"""Opens files of every kind that a window takes: from dialogs, by drops, and from the list of recent ones."""

from __future__ import annotations

import contextlib
from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from insonify.io.bathymetry import BATHYMETRY
from insonify.io.meshes import MESHES
from insonify.io.navigation import NAVIGATION, RecordedNavigation, read_navigation
from insonify.io.sound_speed_casts import CASTS, Cast, read_cast
from insonify.scene import SceneError
from insonify_viewer.errors import Failure
from insonify_viewer.record.comparison.recording import is_recording
from insonify_viewer.state.contacts import is_contacts, read_contacts

if TYPE_CHECKING:
    from insonify_viewer.record.comparison.recording_player import RecordingPlayer
    from insonify_viewer.state.contact_list import ContactList
    from insonify_viewer.state.session import Session
    from insonify_viewer.window.file_dialogs import FileDialogs
    from insonify_viewer.window.main_window import MainWindow
    from insonify_viewer.window.saving import Saving
    from insonify_viewer.window.target_editor import TargetEditor
    from insonify_viewer.work.simulator import Simulator

SCENE = ".toml"
TAKES = "a scene (.toml), a recording, contacts, a grid of heights, a mesh, a measured cast or navigation"


class FileOpening:
    """Opens a file as what its suffix says it is."""

    def __init__(
        self,
        session: Session,
        simulator: Simulator,
        window: MainWindow,
        files: FileDialogs,
        recordings: RecordingPlayer,
        targets: TargetEditor,
        contacts: ContactList,
        saving: Saving,
    ) -> None:
        self._session, self._simulator, self._window, self._files = session, simulator, window, files
        self._recordings, self._targets, self._contacts, self._saving = recordings, targets, contacts, saving
        window.files_wanted.connect(self.open_dropped)
        window.contacts_wanted.connect(self.ask_for_contacts)
        window.scenes.wanted.connect(self.open_scene)
        window.recent.wanted.connect(self.open_recent)
        window.open_scene.triggered.connect(self.ask_for_scene)
        window.open_recording.triggered.connect(lambda: self.open_recording(files.ask_for_recording()))
        window.open_dem.triggered.connect(lambda: files.ask_for_dem(session.scene))

    def open_dropped(self, paths: Sequence[str]) -> None:
        """Open a file that is dropped; of several, one would replace what another had just become."""
        if len(paths) == 1:
            self.open(paths[0])
        else:
            self._window.complain(Failure(f"{len(paths)} files were dropped at once; drop one file at a time"))

    def open(self, path: str) -> None:
        """Open a file by its suffix; a sentence says what is taken if that is none of them."""
        suffix = Path(path).suffix.lower()
        if suffix == SCENE:
            self.open_scene(path)
        elif is_recording(path):
            self.open_recording(path)
        elif suffix in BATHYMETRY.readable():
            self._files.open_dem(self._session.scene, path)
        elif suffix in MESHES.readable():
            self._targets.add("mesh", path)
        elif is_contacts(path):
            self.open_contacts(path)
        elif suffix in (*CASTS.readable(), *NAVIGATION.readable()):
            self._window.say(f"reading {Path(path).name} …")
            self._simulator.send(lambda: _read_part(path), partial(self._use, path))
        else:
            self._window.complain(Failure(f"{Path(path).name}: cannot be opened by its suffix; give {TAKES}"))

    def ask_for_scene(self) -> None:
        """Let the person pick a scene, after the question about unsaved changes."""
        if self._saving.may_leave():
            self._files.ask_for_scene()

    def open_recent(self, path: str) -> None:
        """Open a recent file, or say that it is gone and take it from the list."""
        if Path(path).exists():
            self.open(path)
        else:
            self._window.settings.forget_recent(path)
            self._window.say(f"{path} is no longer there; it was taken from the recent files")

    def open_scene(self, path: str) -> None:
        """Open a scene, after the question about unsaved changes."""
        if self._saving.may_leave():
            self._files.open_scene(path)

    def ask_for_contacts(self) -> None:
        """Let the person pick a file of contacts, and read it in place of the present ones."""
        path = self._files.ask_for_contacts(str(Path(self._session.file or ".").parent))
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
        """Make a cast the water of the scene, or navigation its motion, and say so; or say why it cannot be read."""
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
            self._files.keep_recent(path)


def _read_part(path: str) -> Cast | RecordedNavigation:
    """Read a cast, or else navigation; both may be tables in CSV."""
    suffix = Path(path).suffix.lower()
    if suffix not in NAVIGATION.readable():
        return read_cast(path)
    if suffix in CASTS.readable():
        with contextlib.suppress(SceneError):
            return read_cast(path)
    return read_navigation(path)
