"""Buttons of record A, what B changes, and of a recording its navigation and its statistics."""

import html
from collections.abc import Mapping, Sequence

from PySide6.QtCore import Qt, Signal
from PySide6.QtGui import QAction
from PySide6.QtWidgets import QHBoxLayout, QLabel, QMenu, QWidget

from insonify.errors import plain_text
from insonify.scene import Scene
from insonify_viewer.record.comparison.arrangement import Arrangement, find_pairs
from insonify_viewer.record.comparison.kept_record import Change
from insonify_viewer.record.comparison.recording import Recording
from insonify_viewer.widgets.buttons import make_label, push_button
from insonify_viewer.widgets.field_rows import Combo
from insonify_viewer.widgets.layouts import fill
from insonify_viewer.widgets.save_dialogs import ask_where_to_save
from insonify_viewer.widgets.side_panel import FoldingBox, SidePanel

HINT = (
    "Compare two records: keep this one as A, then change the scene or open another one. The live record is B. Hold X "
    "to see A in its place.\nA can also be a recording of a real sonar (XTF, JSF) or a saved record (.nc, .npz, .zarr)."
)
PARTS = ("recorded", "simulated")
MOST = 8  # changes that are listed


class ComparisonView(SidePanel):
    """Shows what is known of record A and its differences, and signals the person's choices."""

    pair_wanted = Signal(str)  # name of a scene that is opened with its partner
    arranged = Signal(object)  # Arrangement
    frequency_wanted = Signal(float)
    learn_wanted = Signal(str)  # file of the scene

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.title, self.changes = make_label("about"), make_label("change")
        self.keep = push_button("Keep as A", "Keep this record as A, to compare others with it (K)")
        self.open = push_button("Open…", "Open a recording as A (Ctrl+Shift+O)")
        self.back = push_button("Return to A", "Go back to the scene of A (Shift+K); Undo reverses it")
        self.leave = push_button("Close A", "End the comparison")
        self.partner = push_button("Partner as A", "Simulate the other scene of the pair as A (P)")
        self.pairs = push_button("Pairs", "Scenes that are made to be compared in pairs")
        self.pairs_menu = QMenu(self.pairs)
        self.pairs_menu.aboutToShow.connect(lambda: self.show_pairs(find_pairs()))
        self.pairs_menu.triggered.connect(lambda action: self.pair_wanted.emit(action.data()))
        self.pairs.setMenu(self.pairs_menu)
        tip = "Fit a scene whose record resembles this recording, and open it"
        self.learn = push_button("Make a scene like this…", tip, self._ask_for_scene)
        self.arrangement, self.frequency = Combo("Arrangement of the two records"), Combo("Frequency of the sonar")
        for arrangement in Arrangement:
            self.arrangement.addItem(arrangement.value)
        self.arrangement.activated.connect(lambda index: self.arranged.emit(list(Arrangement)[index]))
        self.frequency.activated.connect(lambda: self.frequency_wanted.emit(self.frequency.currentData()))
        self.point, self.statistics = _Table(), _Table()
        self._point_box = FoldingBox("Point", self.point, unfolded=True)
        self._statistics_box = FoldingBox("Statistics", self.statistics, unfolded=True)
        self._found: dict[str, dict[str, str] | str] = {}
        self._lay_out()
        self.show_recording(None)

    def show_recording(self, recording: Recording | None) -> None:
        """Show a recording, or how to open one."""
        there = recording is not None
        for part in (self.leave, self.arrangement, self.learn, self._point_box, self._statistics_box):
            part.setVisible(there)
        self.back.hide()
        self.changes.hide()
        self._name = "" if recording is None else recording.path.stem
        self.title.setText(HINT if recording is None else plain_text(_about(recording)))
        self._show_frequencies([] if recording is None else _frequencies(recording), recording)
        if not there:
            self._found = {}

    def show_kept(self, title: str | None) -> None:
        """Show the title of a kept record; None if A is none."""
        if title is not None:
            self.show_recording(None)
            self.title.setText(plain_text(f"A: {title}"))
            for part in (self.leave, self.arrangement, self.back, self.changes):
                part.show()
        elif not self.back.isHidden():
            self.show_recording(None)

    def show_changes(self, changes: Sequence[Change], difference: str) -> None:
        """List what differs in B from A, and what that changes of the record."""
        listed = [change.in_words() for change in changes[:MOST]]
        if len(changes) > MOST:
            listed.append(f"and {len(changes) - MOST} more")
        named = "B: " + "\n     ".join(listed)
        self.changes.setText(plain_text(f"{named}\n{difference}") if changes else "B equals A")

    def show_point(self, point: dict[str, str], *, at_mouse: bool) -> None:
        """Show what is known of a point; only the ping where the mouse is elsewhere."""
        shown = {name: text for name, text in point.items() if at_mouse or name not in ("slant range", "level")}
        self.point.show_rows({name: (text,) for name, text in shown.items()})

    def show_measured(self, part: str, found: dict[str, str] | str) -> None:
        """Show the statistics of the recorded or the simulated record, or a sentence instead."""
        self._found[part] = found
        known = {part: found for part, found in self._found.items() if isinstance(found, dict)}
        names = [name for found in known.values() for name in found]
        rows = {"": PARTS} | {name: tuple(known.get(part, {}).get(name, "") for part in PARTS) for name in names}
        said = [f"{part}: {found}" for part, found in self._found.items() if isinstance(found, str)]
        self.statistics.show_rows(rows, "\n".join(said))

    def show_pairs(self, pairs: Mapping[str, Scene] | None) -> None:
        """List the bundled pairs in their menu, once."""
        if self.pairs_menu.actions():
            return
        for name, scene in (pairs or {}).items():
            action = QAction(f"{name}\t{scene.title}", self.pairs_menu)
            action.setData(name)
            self.pairs_menu.addAction(action)

    def _ask_for_scene(self) -> None:
        """Let the person name the file of the scene to be learned."""
        path = ask_where_to_save(self.window(), "Save the learned scene", f"{self._name}.toml", [("Scenes", ".toml")])
        if path is not None:
            self.learn_wanted.emit(str(path))

    def _show_frequencies(self, frequencies: list[float], recording: Recording | None) -> None:
        """Offer the frequencies of a recording with several."""
        self.frequency.setVisible(len(frequencies) > 1)
        self.frequency.clear()
        for frequency in frequencies:
            self.frequency.addItem(f"{frequency / 1e3:g} kHz", frequency)
        if frequencies and recording is not None:
            self.frequency.setCurrentIndex(self.frequency.findData(float(recording.dataset.attrs["frequency"])))

    def _lay_out(self) -> None:
        rows = (
            (self.keep, self.open),
            (self.pairs, self.partner),
            (self.back, self.leave),
            (self.arrangement, self.frequency),
            (self.learn,),
        )
        lines = (fill(QHBoxLayout(), *row) for row in rows)
        fill(self.column, *lines, self.title, self.changes, self._point_box, self._statistics_box, None)


class _Table(QLabel):
    """Rows of a name and its values, with a sentence below."""

    def __init__(self) -> None:
        copied = Qt.TextInteractionFlag.TextSelectableByMouse
        super().__init__(wordWrap=True, margin=6, textFormat=Qt.TextFormat.RichText, textInteractionFlags=copied)
        self.setObjectName("numbers")
        self.rows: dict[str, tuple[str, ...]] = {}
        self.said = ""

    def show_rows(self, rows: dict[str, tuple[str, ...]], said: str = "") -> None:
        """Show rows and a sentence."""
        self.rows, self.said = rows, said
        lines = ["".join(f"<td>{_escaped(text)}</td>" for text in (name, *texts)) for name, texts in rows.items()]
        table = f'<table width="100%" cellpadding="2">{"".join(f"<tr>{line}</tr>" for line in lines)}</table>'
        self.setText(f"{table}<p>{_escaped(said)}</p>")


def _escaped(text: str) -> str:
    return html.escape(plain_text(text))


def _about(recording: Recording) -> str:
    """Describe a recording in two lines."""
    kilohertz = float(recording.dataset.attrs.get("frequency", 0.0)) / 1e3
    parts = [f"{recording.pings} pings of 2 × {recording.bins} bins", f"{recording.slant_range:.4g} m"]
    parts += [f"{kilohertz:g} kHz"] if kilohertz > 0.0 else []
    return f"{recording.path.name}\n{'  ·  '.join(parts)}"


def _frequencies(recording: Recording) -> list[float]:
    """Frequencies of a recording with several, in Hz."""
    return [float(text) for text in str(recording.dataset.attrs.get("frequencies", "")).split(",") if text.strip()]
