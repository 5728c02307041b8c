"""Buttons that steer, ports of the live tow, and the task and the marks of an exercise."""

from functools import partial

from PySide6.QtCore import Signal
from PySide6.QtWidgets import QHBoxLayout, QSpinBox, QVBoxLayout, QWidget

from insonify_viewer.widgets.buttons import make, make_action, make_label, push_button
from insonify_viewer.widgets.layouts import fill

STEERING = (  # text, tip, key, steps to port and of speed
    ("Port", "Turn more to port, or less to starboard", "Ctrl+Left", (1, 0)),
    ("Straight", "Turn no more", "Ctrl+K", (0, 0)),
    ("Starboard", "Turn more to starboard, or less to port", "Ctrl+Right", (-1, 0)),
    ("Faster", "Tow faster", "Ctrl+Up", (0, 1)),
    ("Slower", "Tow more slowly", "Ctrl+Down", (0, -1)),
)
PORTS = {"JSF": 4000, "NMEA": 4001, "Control": 4002}
LIVE = "Tow over this scene in real time, for survey programs on this machine"


class TowView(QWidget):
    """Shows how the tow is steered, and what is asked of the person."""

    steered = Signal(int, int)
    live_wanted = Signal(dict)  # ports by their names
    marks_wanted = Signal()

    def __init__(self) -> None:
        super().__init__()
        self.keys, buttons = [], []
        for text, tip, key, steps in STEERING:
            self.keys.append(make_action(self, f"Steer: {text.lower()}", tip, key, partial(self.steered.emit, *steps)))
            buttons.append(push_button(text, self.keys[-1].toolTip(), self.keys[-1].trigger))
        self._helm, self._task, self._marks = make_label(""), make_label(""), make_label("")
        self.ports = {}
        for name, port in PORTS.items():
            tip = f"Port of {name}"
            box = make(QSpinBox, minimum=1024, maximum=65535, value=port, prefix=f"{name} ", toolTip=tip)
            box.setAccessibleName(tip)
            self.ports[name] = box
        self.live = push_button("Live", LIVE, self._go_live)
        self.hand_in = push_button("Hand in the contacts", "Be marked: found, missed, false", self.marks_wanted.emit)
        rows = (fill(QHBoxLayout(), *some, None) for some in (buttons[:3], buttons[3:], self.ports.values()))
        column = fill(QVBoxLayout(), *rows, self._helm, self.live, self._task, self.hand_in, self._marks, None)
        self.setLayout(column)
        self.show_exercise("")

    @property
    def marks(self) -> str:
        """The marks that are shown."""
        return self._marks.text()

    def show_helm(self, text: str) -> None:
        """Show place, heading and speed of the tow."""
        self._helm.setText(text)

    def show_exercise(self, task: str) -> None:
        """Show the task of an exercise, or that there is none."""
        self._task.setText(task)
        self._marks.clear()
        self.hand_in.setEnabled(bool(task))

    def show_marks(self, text: str) -> None:
        """Show the marks."""
        self._marks.setText(text)

    def _go_live(self) -> None:
        self.live_wanted.emit({name: box.value() for name, box in self.ports.items()})
