"""Settings of the person, kept between starts."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from PySide6.QtCore import QByteArray, QSettings

from insonify.display.display_options import DisplayOptions, display_settings, read_display
from insonify.scene import SceneError
from insonify_viewer.widgets.theme import Theme

RECENT = 10  # files
KEPT = (  # display options; gains and contrast suit one record, and begin anew
    *("side", "ground_range", "palette", "water_column", "reverse", "decibels", "newest_on_top", "bottom_line"),
    *("range_lines", "scale", "draped"),
)
SIZES = (100, 125, 150, 200)  # %, of the text and of all that takes its size from it


class Settings:
    """Theme, size of the text, place of the window, display of the record and recent files, in a file of the person."""

    # Every value that is not understood, as of a file that was edited by hand, reads as the usual one.

    def __init__(self) -> None:
        self._store = QSettings(QSettings.Format.IniFormat, QSettings.Scope.UserScope, "insonify", "insonify")

    @property
    def theme(self) -> Theme:
        """Theme of the window."""
        named = self._store.value("theme")
        return next((theme for theme in Theme if theme.value == named), Theme.SYSTEM)

    @theme.setter
    def theme(self, theme: Theme) -> None:
        self._store.setValue("theme", theme.value)

    @property
    def size(self) -> int:
        """Size of the text in per cent, one of `SIZES`; it counts from the next start."""
        kept = str(self._store.value("size", "100"))
        return int(kept) if kept in map(str, SIZES) else 100

    @size.setter
    def size(self, size: int) -> None:
        self._store.setValue("size", size)

    @property
    def geometry(self) -> QByteArray:
        """Place and size of the window, as Qt writes them; empty at the first start."""
        kept = self._store.value("geometry")
        return kept if isinstance(kept, QByteArray) else QByteArray()

    @geometry.setter
    def geometry(self, geometry: QByteArray) -> None:
        self._store.setValue("geometry", geometry)

    @property
    def toured(self) -> bool:
        """Whether the tour was shown."""
        return str(self._store.value("toured", "")).lower() == "true"

    @toured.setter
    def toured(self, toured: bool) -> None:
        self._store.setValue("toured", toured)

    @property
    def presets(self) -> str:
        """File of the presets that were opened or saved last; empty without one."""
        return str(self._store.value("presets", ""))

    @presets.setter
    def presets(self, file: str) -> None:
        self._store.setValue("presets", file)

    @property
    def display(self) -> dict[str, Any]:
        """Display options of the record that differ from the usual ones, of those that are `KEPT`."""
        kept = self._store.value("display")
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
            self._store.setValue("display", kept)

    @property
    def recent(self) -> list[str]:
        """Files that were opened last, the newest first."""
        kept = self._store.value("recent")
        files = [kept] if isinstance(kept, str) else kept  # a list of one is read as its entry
        return [file for file in files if isinstance(file, str) and file] if isinstance(files, list) else []

    def add_recent(self, file: str) -> None:
        """Put a file on top of the recent ones."""
        whole = str(Path(file).resolve())
        self._store.setValue("recent", [whole, *(other for other in self.recent if other != whole)][:RECENT])

    def forget_recent(self, file: str = "") -> None:
        """Take a file from the recent ones, or all of them."""
        self._store.setValue("recent", [other for other in self.recent if file and other != file])
