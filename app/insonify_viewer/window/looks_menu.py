"""Menus of the theme and of the size of the text."""

from __future__ import annotations

from collections.abc import Callable

from PySide6.QtCore import QObject
from PySide6.QtGui import QAction, QActionGroup, QGuiApplication
from PySide6.QtWidgets import QApplication, QMainWindow, QMenu

from insonify_viewer.widgets.icons import refresh_icons
from insonify_viewer.widgets.theme import Theme, apply_theme
from insonify_viewer.window.settings import SIZES, Settings

NAMES = {Theme.SYSTEM: "As the system", Theme.DARK: "Dark", Theme.LIGHT: "Light"}


class LooksMenu(QObject):
    """Changes the looks of a window and keeps them in the settings."""

    def __init__(self, window: QMainWindow, menu: QMenu, settings: Settings, say: Callable[[str], None]) -> None:
        super().__init__(window)
        self._window, self._settings, self._say = window, settings, say
        themes, sizes = menu.addMenu("Theme"), menu.addMenu("Size of text")
        self.themes = _choices(themes, [(NAMES[theme], theme) for theme in Theme], settings.theme)
        self.sizes = _choices(sizes, [(f"{size} %", size) for size in SIZES], settings.size)
        themes.triggered.connect(lambda action: self.show_theme(action.data()))
        sizes.triggered.connect(lambda action: self._keep_size(action.data()))
        QGuiApplication.styleHints().colorSchemeChanged.connect(self._follow)

    def show_theme(self, theme: Theme) -> None:
        """Show and keep a theme."""
        self._settings.theme = theme
        application = QApplication.instance()
        assert isinstance(application, QApplication)
        apply_theme(application, theme)
        refresh_icons(self._window)

    def _follow(self) -> None:
        if self._settings.theme is Theme.SYSTEM:
            self.show_theme(Theme.SYSTEM)

    def _keep_size(self, size: int) -> None:
        self._settings.size = size
        self._say(f"text of {size} % from the next start of the viewer")


def _choices(menu: QMenu, entries: list[tuple[str, object]], chosen: object) -> list[QAction]:
    """Fill a menu with entries of which one is chosen."""
    group = QActionGroup(menu)
    for text, data in entries:
        action = group.addAction(text)
        action.setCheckable(True)
        action.setData(data)
        action.setChecked(data == chosen)
        menu.addAction(action)
    return group.actions()
