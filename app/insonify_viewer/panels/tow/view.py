"""Buttons that steer, ports of the live tow, and the task and the marks of an exercise."""

from functools import partial

from PySide6.QtCore import Signal
from PySide6.QtWidgets import QHBoxLayout, QSpinBox, QVBoxLayout, QWidget

from insonify_viewer.widgets.buttons import make, make_action, make_label, push_button
from insonify_viewer.widgets.layouts import fill

STEERING = (  # text, tip, key, steps to port and of speed
    ("Port", "Turn more to port, or less to starboard", "Ctrl+Left", (1, 0)),
    ("Straight", "Turn no more", "Ctrl+Home", (0, 0)),
    ("Starboard", "Turn more to starboard, or less to port", "Ctrl+Right", (-1, 0)),
    ("Faster", "Tow faster", "Ctrl+Up", (0, 1)),
    ("Slower", "Tow more slowly", "Ctrl+Down", (0, -1)),
)
PORTS = {"JSF": 4000, "NMEA": 4001, "Control": 4002}


class TowView(QWidget):
    """Shows how the tow is steered, and what is asked of the person."""

    steered = Signal(int, int)
    live_wanted = Signal(int, int, int)
    marks_wanted = Signal()

    def __init__(self) -> None:
        super().__init__()
        self.keys = [
            make_action(self, f"Steer: {text.lower()}", tip, key, partial(self.steered.emit, *steps))
            for text, tip, key, steps in STEERING
        ]
        steering = [
            push_button(text, action.toolTip(), action.trigger) for (text, *_), action in zip(STEERING, self.keys)
        ]
        self._helm = make_label("")
        self.ports = [
            make(QSpinBox, minimum=1024, maximum=65535, value=port, prefix=f"{name} ", toolTip=tip, accessibleName=tip)
            for name, port, tip in ((name, port, f"Port of {name}") for name, port in PORTS.items())
        ]
        self.live = push_button(
            "Live", "Tow over this scene in real time, for survey programs on this machine", self._go_live
        )
        self.hand_in = push_button("Hand in the contacts", "Be marked: found, missed, false", self.marks_wanted.emit)
        self._task, self._marks = make_label(""), make_label("")
        fill(
            QVBoxLayout(self),
            fill(QHBoxLayout(), *steering[:3]),
            fill(QHBoxLayout(), *steering[3:], None),
            self._helm,
            fill(QHBoxLayout(), *self.ports),
            self.live,
            self._task,
            self.hand_in,
            self._marks,
            None,
        )
        self.show_exercise("", "")

    @property
    def marks(self) -> str:
        """The marks that are shown."""
        return self._marks.text()

    def show_helm(self, text: str) -> None:
        """Show place, heading and speed of the tow."""
        self._helm.setText(text)

    def show_exercise(self, title: str, task: str) -> None:
        """Show the task of an exercise, or that there is none."""
        self._task.setText(f"{title}\n\n{task}".strip())
        self._marks.clear()
        self.hand_in.setEnabled(bool(title))

    def show_marks(self, text: str) -> None:
        """Show the marks."""
        self._marks.setText(text)

    def _go_live(self) -> None:
        self.live_wanted.emit(*(port.value() for port in self.ports))
