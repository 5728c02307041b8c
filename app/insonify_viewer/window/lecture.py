"""View for a lecture: record and 3-D view fill the screen, with chosen controls and presets in a strip below."""

from collections.abc import Callable, Mapping, Sequence
from functools import partial

from PySide6.QtCore import QObject, QSignalBlocker, Qt, Signal
from PySide6.QtGui import (
    QAction,
    QColor,
    QCursor,
    QGuiApplication,
    QKeySequence,
    QPainter,
    QPen,
    QPixmap,
    QResizeEvent,
    QShortcut,
)
from PySide6.QtWidgets import (
    QGridLayout,
    QHBoxLayout,
    QInputDialog,
    QMainWindow,
    QMenu,
    QPushButton,
    QSizePolicy,
    QSplitter,
    QToolBar,
    QVBoxLayout,
    QWidget,
)

from insonify_viewer.errors import guard_override
from insonify_viewer.state.playlist import KEYS
from insonify_viewer.widgets.buttons import make, make_action
from insonify_viewer.widgets.layouts import fill, fill_grid
from insonify_viewer.widgets.text import entry_name, literal, one_line
from insonify_viewer.widgets.theme import ACCENT_IN_WATER, HALO
from insonify_viewer.window.panel_docks import PanelDocks
from insonify_viewer.window.tour import lay_over_native_views

VIEWS = 450, 550, 550  # shares of the 3-D view and the records
ABOVE_LESSON = 180, 820, 820  # likewise, so that the record keeps more than half of the screen above a lesson
POINTER, RING = 44, 17  # px: of the picture of the pointer, and the radius of its ring
IN_A_ROW = 4  # presets; more take two rows
GROWS, FITS = QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Preferred
LESSON = 0.28  # of the height, of a lesson below the views
BLANK, LEAVE = ".", "Esc"  # keys


class Lecture(QObject):
    """Turns a window into the view for a lecture and back."""

    begun = Signal(bool)  # and left with False
    preset_wanted = Signal(int)  # key from 1 to 9
    preset_kept = Signal(int)
    preset_named = Signal(int, str)

    def __init__(self, window: QMainWindow, docks: PanelDocks, views: QSplitter) -> None:
        super().__init__(window)
        self._window, self._docks, self._views = window, docks, views
        tip = "Fill the screen with record and 3-D view, in large type, with presets on the keys 1 to 9"
        self.action = make_action(window, "Lecture", tip, "F11")
        self.action.setCheckable(True)
        self.action.toggled.connect(self._turn)
        self._black = QWidget(window)
        self._black.setStyleSheet("background: black")
        self._black.hide()
        self._strip = make(QToolBar, "Lecture", window, objectName="lecture", movable=False)
        self._controls = QHBoxLayout()
        self._lay_strip()
        self.open = make_action(window, "Open presets…", "Open a file of presets for a lecture")
        self.save = make_action(window, "Save presets…", "Write the presets of the lecture into a file, to pass it on")
        self._keys = [self._shortcut(str(key), partial(self.preset_wanted.emit, key)) for key in KEYS]
        self._keys += [self._shortcut(BLANK, self.blank), self._shortcut(LEAVE, self._step_back)]
        self._borrowed: dict[QAction, QKeySequence] = {}
        self._before: Callable[[], None] = lambda: None

    def fill(self, menu: QMenu) -> None:
        """Add what keeps, opens and saves presets to a menu."""
        keep = menu.addMenu("Keep as preset")
        for key in KEYS:
            tip, kept = f"Keep scene and display on key {key}", partial(self.preset_kept.emit, key)
            keep.addAction(make_action(self._window, f"Preset {key}", tip, f"Ctrl+{key}", kept))
        menu.addActions([self.open, self.save])

    def mount(self, strips: Sequence[QWidget]) -> None:
        """Put widgets with chosen controls into the strip."""
        for strip in strips:
            self._controls.addWidget(strip, 1)

    def show_presets(self, titles: Mapping[int, str]) -> None:
        """Offer presets in the strip, by key."""
        while (item := self.presets.takeAt(0)) is not None:
            if (button := item.widget()) is not None:
                button.deleteLater()
        columns = -(-len(titles) // 2) if len(titles) > IN_A_ROW else IN_A_ROW
        for k, (key, title) in enumerate(sorted(titles.items())):
            button = _PresetButton(f"{key}  {one_line(title)}")
            button.clicked.connect(partial(self.preset_wanted.emit, key))
            button.addAction(make_action(button, "Rename…", "", do=partial(self._rename, key, title)))
            self.presets.addWidget(button, k // columns, k % columns)

    def _rename(self, key: int, title: str) -> None:
        name, given = QInputDialog.getText(self._window, f"Preset {key}", "Name", text=title)
        if given and name.strip():
            self.preset_named.emit(key, name.strip())

    def blank(self) -> None:
        """Make the screen black, or show it again."""
        lay_over_native_views(self._black)
        self._black.setGeometry(self._window.rect())
        self._black.setVisible(self._black.isHidden())
        self._black.raise_()

    @property
    def blanked(self) -> bool:
        """Whether the screen is black."""
        return not self._black.isHidden()

    def _shortcut(self, key: str, do: Callable[[], None]) -> QShortcut:
        shortcut = QShortcut(QKeySequence(key), self._window, do)
        shortcut.setEnabled(False)
        return shortcut

    def _step_back(self) -> None:
        """Show a black screen again, else leave the lecture."""
        if self.blanked:
            self.blank()
        else:
            self.action.setChecked(False)

    def _lay_strip(self) -> None:
        inner, presets = make(QWidget, sizePolicy=QSizePolicy(GROWS, FITS)), QWidget()
        self.presets = fill_grid(QGridLayout(presets), (), 1, margins=(8, 0, 8, 0))
        presets.setSizePolicy(QSizePolicy.Policy.Ignored, FITS)
        fill(QVBoxLayout(inner), self._controls, presets)
        self._strip.addWidget(inner)
        self._window.addToolBar(Qt.ToolBarArea.BottomToolBarArea, self._strip)
        self._strip.hide()

    def _turn(self, on: bool) -> None:
        """Begin the lecture, or return to the window as it was."""
        if on:
            self._begin()
        else:
            self._before()
        self.begun.emit(on)

    def _begin(self) -> None:
        window, bar = self._window, self._window.menuBar()
        sizes, state = self._views.sizes(), window.windowState()
        high, least = (bar.minimumHeight(), bar.maximumHeight()), window.minimumSize()
        window.setMinimumSize(1, 1)  # of the panels; the screen of a projector may be smaller
        restore_panels = self._docks.stow(round(LESSON * window.height()))
        for part in (*window.findChildren(QToolBar), window.statusBar()):
            part.setVisible(part is self._strip)
        bar.setFixedHeight(0)  # a hidden menu bar would take the keys of its commands along
        lesson = any(not dock.isHidden() for dock in self._docks.by_panel.values())
        self._views.setSizes([*(ABOVE_LESSON if lesson else VIEWS)])
        self._lend_keys(True)
        QGuiApplication.setOverrideCursor(_pointer())
        window.showFullScreen()

        def restore() -> None:
            QGuiApplication.restoreOverrideCursor()
            self._black.hide()
            self._lend_keys(False)
            bar.setMinimumHeight(high[0])
            bar.setMaximumHeight(high[1])
            for part in (*window.findChildren(QToolBar), window.statusBar()):
                part.setVisible(part is not self._strip)
            window.setMinimumSize(least)
            window.setWindowState(state)
            restore_panels()
            self._views.setSizes(sizes)

        self._before = restore

    def _lend_keys(self, lent: bool) -> None:
        """Take the keys of the lecture from the commands that have them, or give them back."""
        if lent:
            keys = [shortcut.key() for shortcut in self._keys]
            actions = self._window.findChildren(QAction)
            self._borrowed = {action: action.shortcut() for action in actions if action.shortcut() in keys}
        for action, key in self._borrowed.items():
            with QSignalBlocker(action):
                action.setShortcut(QKeySequence() if lent else key)
        for shortcut in self._keys:
            shortcut.setEnabled(lent)


class _PresetButton(QPushButton):
    """Button whose text ends in dots where it is too long."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.setFocusPolicy(Qt.FocusPolicy.TabFocus)
        self.setObjectName("small")
        self.setToolTip(literal(f"{text} (a right click renames it)"))
        self.setAccessibleName(text)
        self.setSizePolicy(QSizePolicy.Policy.Ignored, FITS)
        self.setContextMenuPolicy(Qt.ContextMenuPolicy.ActionsContextMenu)
        self._text = text

    @guard_override(None)
    def resizeEvent(self, event: QResizeEvent) -> None:
        """Show as much of the text as fits."""
        super().resizeEvent(event)
        inner = self.width() - 2 * self.fontMetrics().height()
        self.setText(entry_name(self.fontMetrics().elidedText(self._text, Qt.TextElideMode.ElideRight, inner)))


def _pointer() -> QCursor:
    """Pointer that is seen from the last row: a ring about its place."""
    picture = QPixmap(POINTER, POINTER)
    picture.fill(Qt.GlobalColor.transparent)
    with QPainter(picture) as painter:
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        for colour, width in ((HALO, 7.0), (ACCENT_IN_WATER, 4.0)):
            painter.setPen(QPen(QColor(colour), width))
            painter.drawEllipse(picture.rect().center(), RING, RING)
            painter.drawPoint(picture.rect().center())
    return QCursor(picture)
