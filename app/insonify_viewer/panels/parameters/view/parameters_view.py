"""Search, description, effects, and a section of rows for each part of the scene."""

import html
from collections.abc import Callable, Mapping, Sequence

from PySide6.QtCore import QEvent, Qt, QTimer, QVariantAnimation, Signal
from PySide6.QtGui import QKeySequence, QShortcut
from PySide6.QtWidgets import QCheckBox, QGridLayout, QLabel, QLineEdit, QSizePolicy, QToolButton, QWidget

from insonify.scene import Scene
from insonify.scene.links import Link
from insonify_viewer.errors import guard_override
from insonify_viewer.panels.parameters.effects import EffectRow
from insonify_viewer.panels.parameters.view.section_box import Row, SectionBox, make_tool
from insonify_viewer.state.sections import PINNED, FieldSection
from insonify_viewer.widgets.buttons import make, make_label, set_icon, tick_box
from insonify_viewer.widgets.later import Later
from insonify_viewer.widgets.side_panel import FoldingBox, SidePanel
from insonify_viewer.widgets.text import literal
from insonify_viewer.widgets.theme import ACCENT

DELAY = 20  # ms, by which the other numbers follow a slider that moves
STILL = 400  # ms without another call, before what takes longer begins
GLIDE = 900  # ms, in which a value that is tried is reached
OPEN_AT_FIRST = (PINNED, "sonar", "seabed", "track")
BACK = "↩ "  # before the words of a link that leads back


class ParametersView(SidePanel):
    """Shows the fields of a scene and signals the edits of the person."""

    narrowest = 316

    dragged = Signal(str, object)
    settled = Signal(str, object)
    file_asked = Signal(str)
    removed = Signal(str)
    followed = Signal(int)  # number of a link of the description
    ticked = Signal(str, bool)  # name of an effect
    reset = Signal(object)  # dotted paths
    duplicated = Signal(str)
    locked = Signal(str, bool)
    searched = Signal(str)  # words

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.search = _search_line(self)
        self.search.textChanged.connect(self.searched)
        self.column.addWidget(self.search)
        self.found: SectionBox | None = None
        self.about = AboutBox()
        self.about.label.linkActivated.connect(lambda number: self.followed.emit(int(number)))
        self.column.addWidget(self.about)
        self.effects = EffectsBox(self.ticked.emit)
        self.column.addWidget(self.effects)
        self._glide: QVariantAnimation | None = None
        self.soon, self.still = Later(self, DELAY, anew=False), Later(self, STILL)
        self.column.addStretch(1)
        self.sections: dict[str, SectionBox] = {}
        self._lit: tuple[str, ...] = ()
        self._building = QTimer(self)
        self._building.timeout.connect(self._build)

    def stop_waiting(self) -> None:
        """Drop what waits."""
        for timer in (self.soon, self.still, self._building):
            timer.stop()
        self.drop_glide()

    def glide(self, move: Callable[[float], object], arrive: Callable[[], object]) -> None:
        """Call ``move`` with shares from 0 to 1 during a moment, then ``arrive``; a glide under way arrives first."""
        self.end_glide()
        self._glide = glide = QVariantAnimation(self)
        glide.setDuration(GLIDE)
        glide.setStartValue(0.0)
        glide.setEndValue(1.0)
        glide.valueChanged.connect(move)
        glide.finished.connect(arrive)
        glide.start(QVariantAnimation.DeletionPolicy.KeepWhenStopped)

    def end_glide(self) -> None:
        """Let a glide under way arrive now."""
        glide, self._glide = self._glide, None
        if glide is not None:
            glide.setCurrentTime(GLIDE)
            glide.deleteLater()

    def drop_glide(self) -> None:
        """Leave a glide under way where it is."""
        glide, self._glide = self._glide, None
        if glide is not None:
            glide.stop()
            glide.deleteLater()

    def show_sections(self, sections: tuple[FieldSection, ...]) -> None:
        """Show these fields; only sections whose rows change are rebuilt, at most one of them at once."""
        keys = {section.key for section in sections}
        for key in [key for key in self.sections if key not in keys]:
            self._drop(key)
        for place, section in enumerate(sections):
            box = self.sections.get(section.key)
            if box is not None and box.structure == section.structure:
                box.show_values(section)
                continue
            unfolded = section.key in OPEN_AT_FIRST if box is None else box.unfolded
            more = box is not None and box.shows_more
            if box is not None:
                self._drop(section.key)
            box = SectionBox(section, self, unfolded=unfolded, more=more, tools=self._tools(section))
            self.sections[section.key] = box
            # Search and description stand first, and the effects between what is pinned and the rest.
            self.column.insertWidget(place + 2 if section.key == PINNED else place + 3, box)
            if self.found is not None:
                box.hide()
        self._light_rows()
        self._build()

    def show_values(self, sections: tuple[FieldSection, ...]) -> None:
        """Show other values in the rows that are there."""
        for section in sections:
            self.sections[section.key].show_values(section)

    def _build(self) -> None:
        """Build the rows of the first section that waits; the others follow when events have been handled."""
        waiting = [box for box in self.sections.values() if box.waits]
        if waiting:
            waiting[0].build()
        if len(waiting) > 1:
            self._building.start()
        else:
            self._building.stop()

    def show_changed(self, changed: Mapping[str, str]) -> None:
        """Mark the fields that differ from the scene as it was opened, given the texts of those values."""
        for box in (*self.sections.values(), *([self.found] if self.found is not None else [])):
            box.show_changed(changed)

    def show_found(self, section: FieldSection | None) -> None:
        """Show the fields that were searched for in place of all others; None ends the search."""
        if self.found is not None and section is not None and self.found.structure == section.structure:
            self.found.show_values(section)
            return
        if self.found is not None:
            self.column.removeWidget(self.found)
            self.found.hide()
            self.found.deleteLater()
        self.found = None
        if section is not None:
            self.found = SectionBox(section, self, unfolded=True, tools=[])
            self.found.build()
            self.column.insertWidget(1, self.found)
        self.about.setVisible(section is None and bool(self.about.words))
        for box in (self.effects, *self.sections.values()):
            box.setVisible(section is None)

    def show_pictures(self, scene: Scene) -> None:
        """Show the curves of a scene, and the spectrum of its bed."""
        for box in self.sections.values():
            box.show_pictures(scene)

    def turn_to(self, key: str) -> None:
        """Unfold the section of a target, fold those of the others, and scroll to it."""
        for name, box in self.sections.items():
            if box.removable:
                box.unfold(name == key)
        self.sections[key].show()
        self._lay_out()
        self.ensureWidgetVisible(self.sections[key], 0, 8)

    def light(self, paths: tuple[str, ...]) -> None:
        """Light the rows of these fields and no others; unfold their sections and scroll to the first that is there."""
        self._lit = paths
        self._light_rows()
        if paths:
            self.search.clear()
        for path in paths:
            for box in self._boxes(path)[:1]:
                box.reveal(path)
        QTimer.singleShot(0, self, self._scroll_to_lit)  # sections of a scene just opened have no place before

    def _scroll_to_lit(self) -> None:
        """Bring the first row that is lit into view, in the order of the fields."""
        rows = [box.rows[path] for path in self._lit for box in self._boxes(path)[:1]]
        if rows:
            self._lay_out()
            self.ensureWidgetVisible(rows[0].label, 0, self.height() // 3)

    def row(self, path: str) -> Row:
        """Find the row of a field by its dotted path; of one that is pinned, that on top."""
        return next(box.rows[path] for box in self._boxes(path))

    def _boxes(self, path: str) -> list[SectionBox]:
        """Sections that hold the row of a field, the pinned one first."""
        boxes = [box for box in self.sections.values() if box.holds(path)]
        return sorted(boxes, key=lambda box: box is not self.sections.get(PINNED))

    def _tools(self, section: FieldSection) -> list[QToolButton]:
        """Buttons beside the heading of a section."""
        key, tools = section.key, []
        if key.startswith("targets."):
            tip = "Unlock this target" if section.locked else "Lock this target against mouse and sliders"
            copy = make_tool("copy", "", "Duplicate this target", lambda: self.duplicated.emit(key))
            lock = make_tool("lock", "", tip, lambda: self.locked.emit(key, not section.locked))
            set_icon(copy, "copy")
            set_icon(lock, "lock" if section.locked else "unlock")
            tools = [copy, lock]
        if section.removable:
            tools.append(make_tool("remove", "×", "Remove this target", lambda: self.removed.emit(key)))
        return tools

    def _lay_out(self) -> None:
        """Lay the sections out now: the scroll bar reaches a new one only after that."""
        self.column.activate()
        self.body.resize(self.body.width(), self.body.sizeHint().height())

    def _light_rows(self) -> None:
        for box in self.sections.values():
            box.light(self._lit)

    def _drop(self, key: str) -> None:
        box = self.sections.pop(key)
        self.column.removeWidget(box)
        box.hide()
        box.deleteLater()


def _search_line(view: ParametersView) -> QLineEdit:
    """Make the line into which a name is typed; Ctrl+F goes there, Escape empties it."""
    line = make(QLineEdit, objectName="search", placeholderText="Search a parameter (Ctrl+F)", clearButtonEnabled=True)
    line.setAccessibleName("Search a parameter")
    line.setToolTip("Find a parameter by words of its name or description (Ctrl+F)")

    def begin() -> None:
        view.verticalScrollBar().setValue(0)
        line.setFocus()
        line.selectAll()

    def end() -> None:
        line.clear()
        line.clearFocus()

    QShortcut(QKeySequence.StandardKey.Find, view, begin)
    # Qt for Python ignores a context among the arguments; Escape would be taken from the whole window.
    QShortcut(QKeySequence(Qt.Key.Key_Escape), line, end).setContext(Qt.ShortcutContext.WidgetShortcut)
    return line


class AboutBox(FoldingBox):
    """The description of the scene, under a heading that folds."""

    def __init__(self) -> None:
        self.label, flag = make_label("about", form=Qt.TextFormat.RichText), Qt.TextInteractionFlag
        self.label.setTextInteractionFlags(
            flag.TextSelectableByMouse | flag.LinksAccessibleByMouse | flag.LinksAccessibleByKeyboard
        )
        self.label.setFocusPolicy(Qt.FocusPolicy.TabFocus)  # a click leaves the keyboard where it is
        self.label.setAccessibleName("About this scene")
        self.label.linkHovered.connect(self._explain)
        self._shown: tuple[Sequence[str | Link], Sequence[bool]] = ((), ())
        super().__init__("About this scene", self.label, unfolded=True)

    @property
    def words(self) -> str:
        """The text without its links."""
        return "".join(part if isinstance(part, str) else part.words for part in self._shown[0])

    def say(self, parts: Sequence[str | Link], tried: Sequence[bool]) -> None:
        """Show a description; links that are tried at present lead back. Without one, hide the heading too."""
        self._shown = (parts, tried)
        text, number = "", 0
        for part in parts:
            if isinstance(part, str):
                text += html.escape(part)
                continue
            words = html.escape(BACK * tried[number] + part.words)
            text += f'<a href="{number}" style="color: {ACCENT.name()}">{words}</a>'
            number += 1
        if text != self.label.text():
            start, length = self.label.selectionStart(), len(self.label.selectedText())
            self.label.setText(text)
            if self.label.hasFocus() and start >= 0:
                self.label.setSelection(start, length)  # the Tab key goes on from the link that was followed
        self.setVisible(bool(parts))

    @guard_override(None)
    def changeEvent(self, event: QEvent) -> None:
        """Colour the links by another theme."""
        if event.type() is QEvent.Type.StyleChange and self._shown[0]:
            self.say(*self._shown)
        super().changeEvent(event)

    def _explain(self, number: str) -> None:
        """State in the tooltip what the link under the mouse does."""
        links = [part for part in self._shown[0] if isinstance(part, Link)]
        if not number:
            self.label.setToolTip("")
        elif self._shown[1][int(number)]:
            self.label.setToolTip("Click to go back to the value before")
        else:
            link = links[int(number)]
            self.label.setToolTip(literal(f"Click to try it: {link.path} = {_shown(link.value)}"))


def _shown(value: object) -> str:
    """Write a value as people write it in a scene."""
    return str(value.get("kind", value)) if isinstance(value, dict) else f"{value}"


class EffectsBox(FoldingBox):
    """One tick box an effect, under a heading that folds."""

    def __init__(self, ticked: Callable[[str, bool], None]) -> None:
        self.ticks: dict[str, QCheckBox] = {}
        self.figures: dict[str, QLabel] = {}
        self._ticked = ticked
        body = QWidget()
        self._grid = QGridLayout(body)
        self._grid.setContentsMargins(6, 4, 6, 4)
        self._grid.setVerticalSpacing(3)
        self._grid.setColumnStretch(1, 1)
        super().__init__("Effects", body, unfolded=True)

    def show_rows(self, rows: tuple[EffectRow, ...]) -> None:
        """Show which effects the scene has, and what each changes."""
        for row in rows:
            if row.name not in self.ticks:
                self._add(row)
            tick, figure = self.ticks[row.name], self.figures[row.name]
            tick.setChecked(row.on)
            figure.setText(row.figure)
            figure.setToolTip(row.explanation)

    def _add(self, row: EffectRow) -> None:
        tick, right = tick_box(row.name, row.meaning), Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter
        tick.clicked.connect(lambda on, name=row.name: self._ticked(name, on))
        figure = make(QLabel, objectName="figure", alignment=right)
        figure.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Preferred)
        line = len(self.ticks)
        self._grid.addWidget(tick, line, 0)
        self._grid.addWidget(figure, line, 1)
        self.ticks[row.name], self.figures[row.name] = tick, figure
