"""Presets of a lecture in the window: kept and shown by keys, opened and saved as files."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

from PySide6.QtWidgets import QFileDialog

from insonify.scene import Scene, SceneError
from insonify_viewer.state.playlist import Preset, read_playlist, write_playlist
from insonify_viewer.state.session import Session
from insonify_viewer.widgets.save_dialogs import ask_where_to_save
from insonify_viewer.window.main_window import MainWindow

PRESETS = ".toml"


class Presets:
    """The presets of a lecture; a file of them is read again at the next start."""

    def __init__(self, session: Session, window: MainWindow, opened: Callable[[Scene], None]) -> None:
        self._session, self._window, self._opened = session, window, opened
        self._all: dict[int, Preset] = {}
        lecture = window.lecture
        lecture.preset_wanted.connect(self.show)
        lecture.preset_kept.connect(self.keep)
        lecture.preset_named.connect(self.name)
        lecture.open.triggered.connect(self.ask_to_open)
        lecture.save.triggered.connect(self.save)
        if (file := window.settings.presets) and Path(file).exists():
            self.open(file)

    def show(self, key: int) -> None:
        """Show the preset of a key; undo returns to what was shown before, so that nothing is asked."""
        preset, session = self._all.get(key), self._session
        if preset is None:
            self._window.say(f"key {key} has no preset; Ctrl+{key} keeps scene and display on it")
            return
        session.count_as_saved(f"preset {key}", preset.scene)
        if preset.scene.title == session.scene.title:  # the tow goes on, so that the change is seen
            session.turn_to(preset.scene, session.modelling, preset.title)
        else:
            self._opened(preset.scene)
        session.show(f"display of preset {key}", **preset.display._asdict())

    def keep(self, key: int) -> None:
        """Keep scene and display on a key."""
        session = self._session
        scene, edits = session.scene, session.history.undoable
        edited = scene != session.opened and bool(edits)
        title = f"{scene.title}: {edits[0]}" if edited else scene.title
        self._all[key] = Preset(title, scene, session.display)
        self._show_titles()
        self._window.say(f"kept on key {key} of the lecture (F11): {title}; Save presets… writes all into a file")

    def name(self, key: int, title: str) -> None:
        """Give the preset of a key a name of its own."""
        self._all[key] = replace(self._all[key], title=title)
        self._show_titles()

    def ask_to_open(self) -> None:
        """Let the person pick a file of presets."""
        kinds = f"Presets (*{PRESETS})"
        path, _ = QFileDialog.getOpenFileName(self._window, "Open presets", self._window.settings.presets, kinds)
        if path:
            self.open(path)

    def open(self, file: str) -> None:
        """Read presets in place of the present ones."""
        try:
            self._all = read_playlist(Path(file))
        except SceneError as error:
            self._window.complain(error)
            return
        self._window.settings.presets = file
        self._show_titles()
        self._window.say(f"opened {len(self._all)} presets; F11 shows them on the keys of their numbers")

    def save(self) -> None:
        """Write the presets into a file that the person names."""
        if not self._all:
            self._window.say("there are no presets yet; Ctrl+1 to Ctrl+9 keep scene and display")
            return
        suggestion = self._window.settings.presets or "lecture.toml"
        path = ask_where_to_save(self._window, "Save the presets", suggestion, [("Presets", PRESETS)])
        if path is None:
            return
        try:
            write_playlist(path, self._all)
        except OSError as error:
            self._window.complain(error)
        else:
            self._window.settings.presets = str(path)
            self._window.say(f"saved {path}")

    def _show_titles(self) -> None:
        self._window.lecture.show_presets({key: preset.title for key, preset in self._all.items()})
