"""Menu bar, menus of undo, recent files, saving and appearance, and widgets of the tool bar."""

from collections.abc import Callable, Sequence
from pathlib import Path

from PySide6.QtCore import QObject, QSize, Qt, Signal
from PySide6.QtGui import QAction, QActionGroup, QGuiApplication, QKeySequence
from PySide6.QtWidgets import QApplication, QComboBox, QMainWindow, QMenu, QSlider, QToolBar, QToolButton, QWidget

from insonify_viewer.errors import guard_override
from insonify_viewer.widgets.buttons import make, make_action, refresh_icons
from insonify_viewer.widgets.text import entry_name, literal
from insonify_viewer.widgets.theme import Theme, apply_theme
from insonify_viewer.window.settings import SIZES, Settings

MOST = 20  # edits in a menu
TITLES = "File", "Edit", "View", "Record", "Tools", "Help"
NAMES = {Theme.SYSTEM: "As the system", Theme.DARK: "Dark", Theme.LIGHT: "Light"}


class Menus(QObject):
    """The menus of a window."""

    def __init__(self, window: QMainWindow) -> None:
        super().__init__(window)
        # From left to right.
        self.all = [window.menuBar().addMenu(f"&{title}") for title in TITLES]
        for menu in self.all:
            menu.setToolTipsVisible(True)
        self.file, self.edit, self.view, self.record, self.tools, self.help = self.all

    def named(self, title: str) -> QMenu:
        """Menu of a title such as ``View``."""
        return self.all[TITLES.index(title)]

    def add(self, title: str, text: str, tip: str, key: str = "", do: Callable[[], object] | None = None) -> QAction:
        """Append a command to the menu of a title and return its action."""
        menu = self.named(title)
        action = make_action(menu, text, tip, key, do)
        menu.addAction(action)
        return action

    def group(self, title: str, actions: Sequence[QAction]) -> None:
        """Append actions that exist elsewhere too, apart from those before by a line."""
        menu = self.named(title)
        if menu.actions():
            menu.addSeparator()
        menu.addActions(actions)


class HistoryMenus(QObject):
    """Names what undo and redo would do; their tool buttons, held, list all edits."""

    undone = Signal(int)  # steps
    redone = Signal(int)

    def __init__(self, undo: tuple[QAction, QToolButton], redo: tuple[QAction, QToolButton]) -> None:
        super().__init__(undo[0].parent())
        self._actions = undo[0], redo[0]
        self._words = undo[0].text(), redo[0].text()
        self.lists = QMenu(undo[1]), QMenu(redo[1])
        for (action, button), menu, signal in zip((undo, redo), self.lists, (self.undone, self.redone), strict=True):
            action.triggered.connect(lambda _, signal=signal: signal.emit(1))
            menu.triggered.connect(lambda chosen, signal=signal: signal.emit(chosen.data()))
            button.setMenu(menu)
            button.setPopupMode(QToolButton.ToolButtonPopupMode.DelayedPopup)

    def show_edits(self, undoable: Sequence[str], redoable: Sequence[str]) -> None:
        """Show the names of the edits that can be undone and redone, the next first."""
        for action, menu, word, edits in zip(self._actions, self.lists, self._words, (undoable, redoable), strict=True):
            key = action.shortcut().toString(QKeySequence.SequenceFormat.NativeText)
            name = f"{word}: {edits[0]}" if edits else word
            action.setText(entry_name(name))
            action.setIconText(word)  # which the tool bar shows
            action.setToolTip(literal(f"{name} ({key})"))
            action.setEnabled(bool(edits))
            menu.clear()
            for steps, edit in enumerate(edits[:MOST], 1):  # an entry undoes or redoes all down to it
                menu.addAction(entry_name(f"{word}: {edit}")).setData(steps)


class RecentMenu(QMenu):
    """Signals the recent file that the person picks; files that are gone are marked."""

    wanted = Signal(str)

    def __init__(self, window: QWidget, settings: Settings) -> None:
        super().__init__("Open recent", window, toolTipsVisible=True)
        self._settings = settings
        self.aboutToShow.connect(self.fill)
        self.triggered.connect(self._pick)
        self.fill()

    def fill(self) -> None:
        """List the files as they are now."""
        self.clear()
        for file in self._settings.recent:
            gone = "" if Path(file).exists() else "  (no longer there)"
            action = self.addAction(entry_name(Path(file).name) + gone)
            action.setData(file)
            action.setToolTip(literal(file))
        if self.isEmpty():
            self.addAction("no files yet").setEnabled(False)
        else:
            self.addSeparator()
            self.addAction("Clear the list").setData("")

    def _pick(self, action: QAction) -> None:
        if action.data():
            self.wanted.emit(action.data())
        else:
            self._settings.forget_recent()


class SaveMenu(QToolButton):
    """A button with one action for each kind of file."""

    def __init__(self, window: QWidget) -> None:
        super().__init__(window, popupMode=QToolButton.ToolButtonPopupMode.InstantPopup)
        self.setText("Save")
        self.setToolTip("Save scene, record or window")
        menu = QMenu(self, toolTipsVisible=True)
        self.scene = make_action(menu, "Save scene", "Save the scene in its file", "Ctrl+S")
        tip = "Save the scene as a TOML file of another name"
        self.scene_as = make_action(menu, "Save scene as…", tip, "Ctrl+Shift+S")
        tip = "Save every ping of the track as data or as a picture"
        self.record = make_action(menu, "Save record…", tip, "Ctrl+Alt+S")
        self.picture = make_action(menu, "Save picture of the window…", "Save a picture of this window", "Ctrl+P")
        tip = "Charts, data sets and records that are made in the background"
        self.jobs = make_action(menu, "Jobs…", tip, "Ctrl+J")
        menu.addActions([self.scene, self.scene_as, self.record, self.picture])
        menu.addSeparator()
        menu.addAction(self.jobs)
        window.addActions(menu.actions())
        self.setMenu(menu)


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
        self._say(f"the text will have {size} % of its usual size from the next start")


def _choices(menu: QMenu, entries: list[tuple[str, object]], chosen: object) -> list[QAction]:
    """Fill a menu with entries of which one is chosen."""
    group = QActionGroup(menu)
    for text, data in entries:
        action = group.addAction(QAction(text, group, checkable=True, checked=data == chosen))
        action.setData(data)
        menu.addAction(action)
    return group.actions()


class GainSlider(QSlider):
    """Slider with a small minimum width that takes all free width."""

    def __init__(self) -> None:
        super().__init__(Qt.Orientation.Horizontal)
        self.setMaximumWidth(130)

    @guard_override(QSize())
    def sizeHint(self) -> QSize:
        """Room for the handle and a few steps."""
        return QSize(40, super().sizeHint().height())


def make_combo(entries: Sequence[tuple[str, object]], name: str) -> QComboBox:
    """Make a list of entries (text, data) with a name for screen readers, which is its tooltip too."""
    # A click leaves the keyboard focus to the record, where Space pauses.
    combo = make(QComboBox, toolTip=name, accessibleName=name, focusPolicy=Qt.FocusPolicy.TabFocus)
    for text, data in entries:
        combo.addItem(text, data)
    return combo


def button_of(bar: QToolBar, action: QAction) -> QToolButton:
    """Return the button of an action in a tool bar."""
    button = bar.widgetForAction(action)
    assert isinstance(button, QToolButton)
    return button
