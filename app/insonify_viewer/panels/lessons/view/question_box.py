"""Question of a step, with choices or a line for a number."""

from PySide6.QtCore import Qt, Signal
from PySide6.QtGui import QMouseEvent
from PySide6.QtWidgets import QButtonGroup, QHBoxLayout, QLabel, QLineEdit, QRadioButton, QVBoxLayout, QWidget

from insonify.lessons.questions import UNKNOWN, Ask, order_choices, read_number
from insonify_viewer.errors import guard_override
from insonify_viewer.widgets.buttons import light, make, make_label, push_button
from insonify_viewer.widgets.layouts import fill

NOTED = "Your answer is kept. Now make the change, and see."


class QuestionBox(QWidget):
    """Asks for a choice or a number before the step shows what to look for."""

    answered = Signal(str, object)  # the answer as text, and its number: a place among the choices, a number, or None

    def __init__(self) -> None:
        super().__init__()
        self.question = make_label("", form=Qt.TextFormat.MarkdownText)
        tip = "Type a number, with a point or a comma; Return answers"
        self.number = make(QLineEdit, objectName="line", accessibleName="Your answer, a number", toolTip=tip)
        self.number.returnPressed.connect(self._answer)
        self.number.textChanged.connect(self._enable)
        self.unit = QLabel()
        tip = "Keep this answer; it is judged after you have made the change"
        self.answer = push_button("Answer", tip, self._answer, wide=True)
        tip = "Go on without an answer; the right one follows after the change"
        self.unknown = push_button(UNKNOWN, tip, lambda: self.answered.emit(UNKNOWN, None), wide=True)
        self.note = make_label("quiet")
        self.choices: list[ChoiceRow] = []
        self._group = QButtonGroup(self)
        self._group.buttonToggled.connect(self._enable)
        self._lay_out()

    def show_question(self, question: str, ask: Ask, run: str) -> None:
        """Ask a question that has no answer yet, its choices in the order of a run."""
        self._clear()
        self.question.setText(f"**First, your guess** {question}")
        for place in order_choices(question, ask, run):
            row = ChoiceRow(ask.choices[place].text)
            self.choices.append(row)
            self._group.addButton(row.button, place)
            self._rows.addWidget(row)
        self._line.setVisible(not ask.choices)
        self.unit.setText(ask.unit)
        self._lock(False)

    def show_answered(self, text: str) -> None:
        """Show the answer that was given, which cannot be changed."""
        for row in self.choices:
            row.button.setChecked(row.label.text() == text)
        if not self.choices and text != UNKNOWN:
            self.number.setText(text)
        self._lock(True)

    def show_note(self, shown: bool) -> None:
        """Show or hide the sentence that the answer is kept and the change comes next."""
        self.note.setText(NOTED if shown else "")
        self.note.setVisible(shown)

    def show_asked(self, asked: bool) -> None:
        """Show question and buttons, or none of them."""
        for part in (self, self.answer, self.unknown):
            part.setVisible(asked)

    def _lock(self, locked: bool) -> None:
        for widget in (self.number, *(row.button for row in self.choices)):
            widget.setEnabled(not locked)
        self.answer.setVisible(not locked)
        self.unknown.setVisible(not locked)
        self.show_note(False)
        self._enable()

    def _enable(self) -> None:
        """Light the button as soon as there is an answer."""
        ready = self._group.checkedButton() is not None if self.choices else read_number(self.number.text()) is not None
        self.answer.setEnabled(ready)
        light(self.answer, ready)

    def _answer(self) -> None:
        """Signal the answer, if there is one."""
        if self.choices:
            if (chosen := self._group.checkedButton()) is not None:
                self.answered.emit(chosen.accessibleName(), self._group.checkedId())
        elif (number := read_number(self.number.text())) is not None:
            self.answered.emit(self.number.text().strip(), number)

    def _clear(self) -> None:
        for row in self.choices:
            self._group.removeButton(row.button)
            self._rows.removeWidget(row)
            row.deleteLater()
        self.choices = []
        self.number.clear()

    def _lay_out(self) -> None:
        self._rows = QVBoxLayout()
        self._line = QWidget()
        none = (0, 0, 0, 0)
        fill(QHBoxLayout(self._line), self.number, self.unit, growing=self.number, margins=none)
        self.buttons = fill(QHBoxLayout(), self.answer, self.unknown)  # for a place that does not scroll
        fill(QVBoxLayout(self), self.question, self._rows, self._line, self.note, margins=none)


class ChoiceRow(QWidget):
    """A choice with a text that wraps; a click on the text chooses it."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.button = make(QRadioButton, accessibleName=text, toolTip="Choose this answer")
        self.label = make(QLabel, text, wordWrap=True)
        row = QHBoxLayout(self)
        row.setContentsMargins(0, 0, 0, 0)
        row.addWidget(self.button, 0, Qt.AlignmentFlag.AlignTop)
        row.addWidget(self.label, 1)

    @guard_override(None)
    def mousePressEvent(self, event: QMouseEvent) -> None:
        """Choose it."""
        if self.button.isEnabled():
            self.button.setChecked(True)
        event.accept()
