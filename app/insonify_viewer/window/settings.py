"""Settings of the person, kept between starts."""

from __future__ import annotations

from collections.abc import Callable
from enum import Enum
from pathlib import Path
from typing import Any, Generic, TypeVar

from PySide6.QtCore import QByteArray, QSettings

from insonify.display.display_options import DisplayOptions, display_settings, read_display
from insonify.scene import SceneError
from insonify_viewer.widgets.theme import Theme

Value = TypeVar("Value")
RECENT = 10  # files
KEPT = (  # display options; gains and contrast suit one record, and begin anew
    *("side", "ground_range", "palette", "water_column", "reverse", "decibels", "newest_on_top", "bottom_line"),
    *("range_lines", "scale", "draped"),
)
SIZES = (100, 125, 150, 200)  # %, of the text and of all that takes its size from it


class _Kept(Generic[Value]):
    """A value of the settings by its name, as it is read from the file, which may hold none or anything."""

    def __init__(self, name: str, read: Callable[[Any], Value]) -> None:
        self._name, self._read = name, read

    def __get__(self, settings: Settings, _: object) -> Value:
        return self._read(settings.store.value(self._name))

    def __set__(self, settings: Settings, value: Value) -> None:
        settings.store.setValue(self._name, value.value if isinstance(value, Enum) else value)


class Settings:
    """Theme, size of the text, place of the window, display of the record and recent files, in a file of the person."""

    # Every value that is not understood, as of a file that was edited by hand, reads as the usual one.

    theme = _Kept("theme", lambda kept: next((theme for theme in Theme if theme.value == kept), Theme.SYSTEM))
    size = _Kept("size", lambda kept: int(kept) if str(kept) in map(str, SIZES) else 100)  # %; from the next start
    geometry = _Kept("geometry", lambda kept: kept if isinstance(kept, QByteArray) else QByteArray())  # of the window
    toured = _Kept("toured", lambda kept: str(kept).lower() == "true")  # whether the tour was shown
    presets = _Kept("presets", lambda kept: str(kept or ""))  # file of the presets that were opened or saved last

    def __init__(self) -> None:
        self.store = QSettings(QSettings.Format.IniFormat, QSettings.Scope.UserScope, "insonify", "insonify")

    @property
    def display(self) -> dict[str, Any]:
        """Display options of the record that differ from the usual ones, of those that are `KEPT`."""
        kept = self.store.value("display")
        texts = [kept] if isinstance(kept, str) else kept  # a list of one is read as its entry
        try:
            options = read_display(texts if isinstance(texts, list) else [])
        except (SceneError, TypeError):
            return {}
        return {name: value for name, value in options.items() if name in KEPT}

    def keep_display(self, look: DisplayOptions) -> None:
        """Keep display options for the next start; a gain that is dragged writes no file."""
        kept = display_settings(DisplayOptions()._replace(**{name: getattr(look, name) for name in KEPT}))
        if read_display(kept) != self.display:
            self.store.setValue("display", kept)

    @property
    def recent(self) -> list[str]:
        """Files that were opened last, the newest first."""
        kept = self.store.value("recent")
        files = [kept] if isinstance(kept, str) else kept  # a list of one is read as its entry
        return [file for file in files if isinstance(file, str) and file] if isinstance(files, list) else []

    def add_recent(self, file: str) -> None:
        """Put a file on top of the recent ones."""
        whole = str(Path(file).resolve())
        self.store.setValue("recent", [whole, *(other for other in self.recent if other != whole)][:RECENT])

    def forget_recent(self, file: str = "") -> None:
        """Take a file from the recent ones, or all of them."""
        self.store.setValue("recent", [other for other in self.recent if file and other != file])
