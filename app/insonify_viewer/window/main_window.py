"""Main window: seabed on the left, record on the right, panels around them, tools above."""

from collections.abc import Callable, Sequence
from pathlib import Path

from PySide6.QtCore import QPoint, QRect, QSize, Qt, Signal
from PySide6.QtGui import QAction, QCloseEvent, QDragEnterEvent, QDropEvent, QKeySequence
from PySide6.QtWidgets import (
    QAbstractButton,
    QApplication,
    QLabel,
    QMainWindow,
    QMenu,
    QStyle,
    QToolBar,
    QToolButton,
    QWidget,
)

from insonify.display.display_options import DisplayOptions
from insonify_viewer.errors import guard_override
from insonify_viewer.panels.panel import Panel, Place
from insonify_viewer.record.comparison.comparison_actions import ComparisonActions
from insonify_viewer.record.comparison.comparison_overlay import ComparisonOverlay
from insonify_viewer.record.comparison.record_a_view import RecordAView, RecordsSideBySide
from insonify_viewer.record.waterfall_view import WaterfallView
from insonify_viewer.state.tow_clock import SPEEDS
from insonify_viewer.widgets.buttons import make, make_action, set_icon, with_key
from insonify_viewer.widgets.layouts import make_splitter
from insonify_viewer.widgets.text import window_title
from insonify_viewer.widgets.theme import lecture_scale, scaled
from insonify_viewer.window.command_palette import CommandPalette, entries_of_menus, entries_of_scenes
from insonify_viewer.window.help_dialogs import AboutDialog, KeysDialog
from insonify_viewer.window.lecture import Lecture
from insonify_viewer.window.menus import (
    GainSlider,
    HistoryMenus,
    LooksMenu,
    Menus,
    RecentMenu,
    SaveMenu,
    button_of,
    make_combo,
)
from insonify_viewer.window.panel_docks import PanelDocks, PanelRoom
from insonify_viewer.window.scene_menu import SceneButton
from insonify_viewer.window.settings import Settings
from insonify_viewer.window.status_line import JobBar, StatusLine
from insonify_viewer.window.target_placement import target_menu
from insonify_viewer.window.tour import Tour, tour_steps

# px at the usual size of the text, and share of a large screen, that the window takes at the first start.
USUAL, ROOMY = (1480, 900), 0.7
VIEWS = 400, 600  # shares of the 3-D view and the record
SMALLEST_VIEW = (200, 140)  # px, of the 3-D view
SMALLEST = (760, 420)  # px, which fits half of a screen of 1600 × 900 at twice the scale
GAIN_REACH = 30  # dB either way


class MainWindow(QMainWindow):
    """Holds views and panels, and signals the person's requests."""

    running_changed = Signal(bool)
    target_wanted = Signal(str)
    closing = Signal()
    files_wanted = Signal(list)  # paths of files that are dropped together

    def __init__(self, *, native: bool, palettes: tuple[str, ...]) -> None:
        super().__init__()
        self.setWindowTitle("insonify")
        screen = self.screen().availableSize() - QSize(
            0, self.style().pixelMetric(QStyle.PixelMetric.PM_TitleBarHeight)
        )
        usual = QSize(*(scaled(self, pixels) for pixels in USUAL))
        self.resize(usual.expandedTo(screen * ROOMY).boundedTo(screen))
        self.setMinimumSize(*SMALLEST)
        self.waterfall = WaterfallView(native=native)
        tip = "Show the echo of one ping as a curve below the record"
        self.trace = make_action(self, "Echo", tip, "E", self.waterfall.toggle_trace)
        self._placeholder = QLabel("loading the 3-D view …", alignment=Qt.AlignmentFlag.AlignCenter)
        self._placeholder.setMinimumSize(*SMALLEST_VIEW)  # else the record becomes narrower when the view is there
        self.views = make_splitter(Qt.Orientation.Horizontal, self._placeholder, self.waterfall, sizes=VIEWS)
        self.record_a = RecordAView(native=native)
        self.records = RecordsSideBySide(self.views, self.waterfall, self.record_a)
        self._room = PanelRoom(self, self.views)
        self.docks = PanelDocks(self, self._room)
        self.overlay = ComparisonOverlay(self.record_a, self.waterfall)
        self.comparison = ComparisonActions(self)
        self.setCentralWidget(self.views)
        self.may_close: Callable[[], bool] = lambda: True
        self._closed = self._asking = False
        self.panels: dict[str, Panel] = {}
        self.buttons: dict[str, QAction] = {}
        self.settings = Settings()
        self.status = StatusLine()
        self.say, self.complain = self.status.say, self.status.complain
        self._add_tools(palettes)
        self.menus = Menus(self)
        self.lecture = Lecture(self, self.docks, self.views)
        self.lecture.begun.connect(self._enlarge_records)
        self.recent = RecentMenu(self, self.settings)
        docks, views = self.docks.by_panel, (lambda: self.waterfall, lambda: self.seabed)
        steps = tour_steps(lambda: self.scenes, lambda: docks["parameters"], *views, self.menuBar)
        self.tour = Tour(self, steps)
        self._fill_menus()
        self._add_status()
        self.setAcceptDrops(True)
        application = QApplication.instance()
        assert isinstance(application, QApplication)
        application.focusChanged.connect(self._share_space)
        self.waterfall.setFocus()

    def mount(self, panels: Sequence[Panel]) -> None:
        """Mount panels at their places, in this order."""
        self.panels = {panel.name: panel for panel in panels}
        self.docks.mount(panels)
        for panel in panels:
            if panel.place is Place.STATUS:
                self.statusBar().addPermanentWidget(panel.widget)
            if panel.button is not None:
                self._add_button(panel)
        self.lecture.mount([panel.strip for panel in panels if panel.strip is not None])

    def fit_screen(self) -> None:
        """Shrink and move the window, with its frame, into the room that its screen leaves to windows."""
        if self.isMaximized() or self.isFullScreen():
            return
        room, beside = self.screen().availableGeometry(), self.frameGeometry().size() - self.size()
        self.resize(self.size().boundedTo(room.size() - beside))
        frame = self.frameGeometry()
        left, top = room.right() + 1 - frame.width(), room.bottom() + 1 - frame.height()
        self.move(max(min(frame.left(), left), room.left()), max(min(frame.top(), top), room.top()))

    def open_panel(self, name: str) -> None:
        """Open a panel, or bring it to the front."""
        panel = self.panels[name]
        if panel.place is Place.WINDOW:
            self._open_window(panel)
            return
        if name in self.buttons:
            self.buttons[name].setChecked(True)
        if name in self.docks.by_panel:
            self.docks.bring_forward(name)

    def open_palette(self) -> CommandPalette:
        """Open the list of all commands, scenes, lessons and parameters."""
        entries = entries_of_menus(self.menus.all) + entries_of_scenes(self.scenes.wanted.emit)
        palette = CommandPalette(
            self, [*entries, *(entry for panel in self.panels.values() for entry in panel.entries())]
        )
        palette.show()
        return palette

    @property
    def seabed(self) -> QWidget | None:
        """The view of the seabed, or its placeholder until it is loaded."""
        return self.views.widget(0)

    def put_seabed(self, view: QWidget) -> None:
        """Put the view of the seabed into its place."""
        sizes = self.views.sizes()
        view.setMinimumSize(*SMALLEST_VIEW)
        self.views.replaceWidget(0, view)
        self.views.setSizes(sizes)
        view.show()
        self._room.make()
        self._placeholder.deleteLater()

    def show_display(self, look: DisplayOptions) -> None:
        """Set palette and gain among the tools to the display options."""
        self.palettes.setCurrentText(look.palette)
        self.gain.setValue(round(10 * look.gain))

    def show_title(self, title: str, file: str, *, unsaved: bool) -> None:
        """Show the title of the scene and the name of its file, with a mark for unsaved changes."""
        named = f"{title} · {Path(file).name}" if file else title
        self.setWindowTitle(f"{window_title(named)}[*] · insonify")
        self.setWindowModified(unsaved)

    def show_running(self, running: bool) -> None:
        """Set the button that pauses or plays; its text names what a click does."""
        self.pause.setChecked(not running)
        self.pause.setText("Pause" if running else "Play")
        set_icon(self.pause, "pause" if running else "play")
        tip = "Pause the tow; the mouse wheel then scrolls back" if running else "Continue the tow from the ping on top"
        self.pause.setToolTip(with_key(tip, self.pause.shortcut()))

    @guard_override(None)
    def closeEvent(self, event: QCloseEvent) -> None:
        """Signal the end while all widgets exist, unless the person stays; the worker may need a moment to finish."""
        if self._closed:
            return
        if self._asking or not self._is_left():
            event.ignore()
            return
        self._closed = True
        self.lecture.action.setChecked(False)
        self.status.stop()
        self.hide()
        self.closing.emit()
        super().closeEvent(event)

    @guard_override(None)
    def dragEnterEvent(self, event: QDragEnterEvent) -> None:
        """Accept a drag with local files."""
        _dropped_files(event)

    @guard_override(None)
    def dropEvent(self, event: QDropEvent) -> None:
        """Signal the files that are dropped."""
        if paths := _dropped_files(event):
            self.files_wanted.emit(paths)

    def _share_space(self, _left: QWidget | None, focused: QWidget | None) -> None:
        """Leave Space to the button or tick that has the keyboard; anywhere else it is a key of the window."""
        taken = isinstance(focused, QAbstractButton)
        context = Qt.ShortcutContext.WidgetShortcut if taken else Qt.ShortcutContext.WindowShortcut
        if self.pause.shortcutContext() is not context:
            self.pause.setShortcutContext(context)

    def _is_left(self) -> bool:
        """Ask whether the window may close; a second request to close does not ask again meanwhile."""
        self._asking = True
        try:
            return self.may_close()
        finally:
            self._asking = False

    def _add_button(self, panel: Panel) -> None:
        """Put the command of a panel into its menu and, if it has an icon, among the tools before the palettes."""
        assert panel.button is not None
        action = make_action(self, panel.button.text, panel.button.tooltip, panel.button.shortcut)
        self.menus.named(panel.button.menu).addAction(action)
        if panel.place is Place.WINDOW:
            action.triggered.connect(lambda: self._open_window(panel))
        else:
            action.setCheckable(True)
            action.toggled.connect(lambda shown: self.docks.show(panel, shown))
        if panel.button.icon:
            set_icon(action, panel.button.icon)
            self._bar.insertAction(self._after_buttons, action)
            name_button(button_of(self._bar, action))
        self.buttons[panel.name] = action

    def _open_window(self, panel: Panel) -> None:
        widget: QWidget = panel.widget
        if widget.parent() is not self:
            widget.setParent(self, Qt.WindowType.Window)
            widget.move(place_beside(self.frameGeometry(), widget.size(), self.screen().availableGeometry()))
        widget.show()
        widget.raise_()
        panel.opened(True)

    def _add_tools(self, palettes: tuple[str, ...]) -> None:
        bar = make(QToolBar, "Tools", self, objectName="tools", movable=False)
        bar.setIconSize(QSize(1, 1) * scaled(self, bar.iconSize().width()))
        bar.setContextMenuPolicy(Qt.ContextMenuPolicy.PreventContextMenu)
        self.addToolBar(bar)
        key = QKeySequence.StandardKey
        self.open_scene = make_action(self, "Open a file…", "Open a scene", key.Open)
        self.new_scene = make_action(self, "New…", "Put a scene together from bed, sonar, track and targets", key.New)
        self.open_recording = make_action(self, "Open a recording…", "Open a recording", "Ctrl+Shift+O")
        self.addActions([self.new_scene, self.open_scene, self.open_recording])
        self.scenes = SceneButton(self.open_scene, self.open_recording)
        bar.addWidget(self.scenes)
        tip = "Replace the bed by a grid of measured heights"
        self.open_dem = make_action(self, "Open a measured bed…", tip, "Ctrl+D")
        self._add_targets(bar)
        self.save = SaveMenu(self)
        bar.addWidget(self.save)
        bar.addSeparator()
        self.undo = self._tool(bar, "Undo", "Undo the last edit", key.Undo)
        self.redo = self._tool(bar, "Redo", "Redo the edit that was undone", key.Redo)
        undo, redo = ((action, button_of(bar, action)) for action in (self.undo, self.redo))
        self.history = HistoryMenus(undo, redo)
        bar.addSeparator()
        self.pause = self._tool(bar, "Pause", "Pause the tow; the mouse wheel then scrolls back", "Space")
        self.pause.setCheckable(True)
        self.pause.toggled.connect(lambda paused: self.running_changed.emit(not paused))
        speeds = [(f"{speed:g}×" if speed >= 1 else f"1/{1 / speed:g}×", speed) for speed in SPEEDS]
        self.speed = make_combo(speeds, "Speed of the tow")
        self.speed.setCurrentIndex(SPEEDS.index(1.0))
        bar.addWidget(self.speed)
        bar.addSeparator()
        self.palettes = make_combo([(name, name) for name in palettes], "Palette of the record")
        tip = "Reset view: put the camera behind and above the towfish again"
        self.reset_view = self._tool(bar, "Reset view", tip, "Home")
        self._bar, self._after_buttons = bar, bar.addWidget(self.palettes)
        self._add_gain(bar)

    def _add_targets(self, bar: QToolBar) -> None:
        """Add the menu with every kind of target."""
        shown, opens = Qt.ToolButtonStyle.ToolButtonTextBesideIcon, QToolButton.ToolButtonPopupMode.InstantPopup
        self.targets = make(QToolButton, text="Target", toolButtonStyle=shown, popupMode=opens)
        self.targets.setToolTip("Add a target on the bed, abeam of the track")
        menu = QMenu(self.targets)
        for kind, name in target_menu().items():
            action = QAction(name, menu)
            action.setData(kind)
            menu.addAction(action)
        menu.triggered.connect(lambda action: self.target_wanted.emit(action.data()))
        self.targets.setMenu(menu)
        bar.addWidget(self.targets)

    def _enlarge_records(self, large: bool) -> None:
        """Draw the rulers of both records in large type, or as usual."""
        for record in (self.waterfall, self.record_a):
            record.enlarge_text(lecture_scale(self) if large else 1.0)

    def _add_gain(self, bar: QToolBar) -> None:
        self.gain = GainSlider()
        self.gain.setRange(-10 * GAIN_REACH, 10 * GAIN_REACH)
        self.gain.setToolTip(f"Gain of the picture, −{GAIN_REACH} to +{GAIN_REACH} dB; the data stay as they are")
        self.gain.setAccessibleName("Display gain")
        self._gain_text = QLabel("0 dB")
        self._gain_text.setMinimumWidth(self.fontMetrics().horizontalAdvance("-30.0 dB") + 4)
        self.gain.valueChanged.connect(lambda tenths: self._gain_text.setText(f"{tenths / 10:g} dB"))
        bar.addWidget(QLabel("gain"))
        bar.addWidget(self.gain)
        bar.addWidget(self._gain_text)
        self.levels = self._tool(bar, "Auto", "Set gain and contrast from the record on screen", "A")

    def _add_status(self) -> None:
        status = self.statusBar()
        status.setSizeGripEnabled(False)
        self.jobs = JobBar()
        self.jobs.clicked.connect(lambda: self.open_panel("jobs"))
        self.save.jobs.triggered.connect(lambda: self.open_panel("jobs"))
        status.addWidget(self.status, 1)
        status.addPermanentWidget(self.jobs)

    def _fill_menus(self) -> None:
        """Put every command into the menus, before those of panels."""
        menus = self.menus
        menus.add("File", "Scenes…", self.scenes.toolTip(), do=self.scenes.show_pictures)
        menus.group("File", [self.new_scene, self.open_scene, self.open_recording, self.open_dem])
        tip = "Open a file of contacts, which replaces the list"
        self.open_contacts = menus.add("File", "Open contacts…", tip)
        menus.file.addMenu(self.recent)
        menus.group("File", [self.save.scene, self.save.scene_as, self.save.record, self.save.picture])
        menus.file.addSeparator()
        menus.add("File", "Quit", "Close the window", "Ctrl+Q", self.close)
        menus.group("Edit", [self.undo, self.redo])
        menus.edit.addSeparator()
        menus.edit.addMenu(self.targets.menu()).setText("Add a target")
        menus.group("Record", [self.pause, self.levels, self.trace])
        menus.group("Record", self.comparison.actions)
        menus.group("Tools", [self.save.jobs])
        tip = "Compile now what the bundled scenes need, in the background, so that none of them has to wait later"
        self.prepare_all = menus.add("Tools", "Prepare everything", tip)
        menus.group("View", [self.lecture.action])
        self.lecture.fill(menus.view)
        menus.group("View", [self.reset_view])
        self.looks = LooksMenu(self, menus.view, self.settings, self.say)
        menus.view.addSeparator()
        tip = "Find a command, scene, lesson or parameter by some letters of its name"
        menus.add("Help", "Find…", tip, "Ctrl+Shift+P", self.open_palette)
        tip = "Every command that has a key"
        menus.add("Help", "Keyboard shortcuts", tip, "?", lambda: KeysDialog(self, menus.all).show())
        menus.add("Help", "Tour", "See the window in five steps", do=self.tour.begin)
        menus.add("Help", "About insonify", "Versions, licence, citation", do=lambda: AboutDialog(self).show())
        self._show_icons()

    def _show_icons(self) -> None:
        """Give the tools icons, and names to those who reach them by keyboard."""
        for owner, name in (
            (self.scenes, "scenes"), (self.targets, "target"), (self.save, "save"), (self.undo, "undo"),
            (self.redo, "redo"), (self.pause, "pause"), (self.reset_view, "home"), (self.levels, "levels"),
        ):  # fmt: skip
            set_icon(owner, name)
        for button in self.findChildren(QToolButton):
            name_button(button)

    def _tool(self, bar: QToolBar, text: str, tip: str, key: QKeySequence | QKeySequence.StandardKey | str) -> QAction:
        action = make_action(self, text, tip, key)
        bar.addAction(action)
        return action


def place_beside(window: QRect, size: QSize, screen: QRect) -> QPoint:
    """Place another window right or left of one; where neither has room, at the side of the screen that has more."""
    right, left = screen.right() - window.right(), window.left() - screen.left()
    x = window.right() + 1 if right >= left else window.left() - size.width()
    x = max(min(x, screen.right() + 1 - size.width()), screen.left())
    return QPoint(x, max(min(window.top(), screen.bottom() + 1 - size.height()), screen.top()))


def name_button(button: QToolButton) -> None:
    """Let the keyboard reach a tool, and give it a name for screen readers."""
    button.setFocusPolicy(Qt.FocusPolicy.TabFocus)
    button.setAccessibleName(button.toolTip())


def _dropped_files(event: QDropEvent) -> list[str]:
    """Accept a drag or a drop with local files; return their paths."""
    paths = [url.toLocalFile() for url in event.mimeData().urls() if url.isLocalFile()]
    if paths:
        event.acceptProposedAction()
    return paths
