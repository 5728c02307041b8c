"""List of lessons, the steps of one in large type, and its summary."""

from collections.abc import Collection, Sequence
from pathlib import Path

from PySide6.QtCore import QSize, Qt, QTimer, Signal
from PySide6.QtGui import QColor, QIcon, QKeySequence, QPixmap, QShortcut
from PySide6.QtWidgets import (
    QBoxLayout,
    QFrame,
    QHBoxLayout,
    QLabel,
    QListWidget,
    QListWidgetItem,
    QPushButton,
    QStackedWidget,
    QVBoxLayout,
    QWidget,
)

from insonify.files import bundled_picture, bundled_scenes
from insonify.io.atomic import write_text
from insonify.lessons.courses import Course, group_lessons
from insonify.lessons.lesson import Lesson
from insonify.lessons.questions import Grade, Verdict
from insonify.lessons.worksheet import Worksheet
from insonify_viewer.errors import guard_override
from insonify_viewer.panels.lessons.view.question_box import QuestionBox
from insonify_viewer.widgets.buttons import light, make, make_label, push_button
from insonify_viewer.widgets.layouts import fill
from insonify_viewer.widgets.save_dialogs import print_markdown, save_pixmap
from insonify_viewer.widgets.side_panel import ScrollColumn
from insonify_viewer.widgets.theme import TEXT, lecture_scale

USUAL = 1.2  # factor on the size of the text, which a lecture enlarges further
HEADING = 1.25  # factor on the size of headings
SIGNS = {Grade.RIGHT: "✓", Grade.CLOSE: "≈", Grade.WRONG: "✗", Grade.UNKNOWN: "→"}
PICTURE = QSize(48, 32)  # px, of the record of a lesson
NARROWEST, WIDE = 230, 300  # px, least and preferred width at the usual size


class LessonsView(QStackedWidget):
    """Shows lessons; its pages hold the buttons."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setObjectName("panel")
        self.list = ListPage()
        self.page = StepPage()
        self.summary = SummaryPage()
        for page in (self.list, self.page, self.summary):
            self.addWidget(page)
        self._pictures: dict[str, dict[int, QPixmap]] = {}  # of the record, by lesson and step
        self._size = self.font().pointSizeF()
        self.enlarge(False)

    @guard_override(QSize())
    def sizeHint(self) -> QSize:
        """Preferred size."""
        return QSize(self._wide, super().sizeHint().height())

    def keep_picture(self, lesson: str, index: int, record: QWidget) -> None:
        """Keep a picture of the record at the end of a step of a lesson."""
        self._pictures.setdefault(lesson, {})[index] = record.grab()

    def save_page(self, worksheet: Worksheet, path: Path) -> None:
        """Write the page to hand in with its pictures: as PDF, else as Markdown with the pictures beside it."""
        pictures = self._pictures.get(worksheet.lesson.name, {})
        names = {index: path.with_name(f"{path.stem}-{index + 1}.png") for index in pictures}
        markdown = worksheet.to_markdown(names)
        if path.suffix.lower() == ".pdf":
            print_markdown(markdown, {names[index].name: picture for index, picture in pictures.items()}, path)
            return
        for index, picture in pictures.items():
            save_pixmap(picture, names[index])
        write_text(path, markdown)

    def enlarge(self, large: bool) -> None:
        """Show text as large as a lecture asks for, or at the usual size."""
        factor = USUAL * (lecture_scale(self) if large else 1.0)
        points = self._size * factor
        self.setStyleSheet(
            f"QLabel, QPushButton, QListWidget, QLineEdit {{ font-size: {points:g}pt; }}"
            f"QLabel#lesson {{ font-size: {HEADING * points:g}pt; font-weight: 600; }}"
            "QLabel#step, QLabel#verdict { font-weight: 600; }"
        )
        self.setMinimumWidth(max(round(NARROWEST * factor / USUAL), self.minimumSizeHint().width()))
        self._wide = round(WIDE * factor / USUAL)
        for page in (self.list, self.page, self.summary):
            page.lecture.setChecked(large)
        self.page.spread(large)


class ListPage(QWidget):
    """The list of lessons by course, with a button that starts one."""

    started = Signal(str)
    reviewed = Signal(str)

    def __init__(self) -> None:
        super().__init__()
        tip = "A double click, or Enter, starts the lesson"
        self.lessons = make(QListWidget, objectName="lessons", accessibleName="Lessons", toolTip=tip, wordWrap=True)
        self.lessons.setFrameShape(QFrame.Shape.NoFrame)
        self.lessons.setIconSize(PICTURE)
        self.lessons.setSpacing(1)
        self.lessons.itemActivated.connect(self._start)
        self.lessons.currentItemChanged.connect(self._describe)
        self.about = _words()
        tip = "Show your answers to this lesson, and save them as a page"
        self.results = push_button(
            "Results", tip, lambda: self.reviewed.emit(_lesson_of(self.lessons.currentItem())), wide=True
        )
        tip = "Open the scene of this lesson, and show its first step"
        self.start = push_button("Start", tip, lambda: self._start(self.lessons.currentItem()), wide=True)
        self.lecture = _lecture_button()
        self._courses: dict[str, Course] = {}
        self._ended: Collection[str] = ()
        row = _row(self.lecture, self.results)
        fill(QVBoxLayout(self), self.lessons, self.about, row, self.start, growing=self.lessons)

    def show_lessons(self, lessons: Sequence[Lesson], finished: Collection[str], ended: Collection[str]) -> None:
        """Show lessons by course, given those with all steps done and those with a summary; select the first to do."""
        self._ended = ended
        groups = group_lessons(lessons)
        self._courses = {lesson.name: course for course, members in groups for lesson in members}
        self.lessons.clear()
        todo = None
        for course, members in groups:
            if course.name:
                self._add_heading(course, sum(lesson.minutes for lesson in members))
            for lesson in members:
                done = "✓ " if lesson.name in finished else ""
                item = QListWidgetItem(f"{done}{lesson.title}")
                if scene := bundled_scenes().get(lesson.scene):
                    item.setIcon(QIcon(str(bundled_picture(scene))))  # beside it, a title of two lines is indented
                item.setData(Qt.ItemDataRole.UserRole, lesson.name)
                self.lessons.addItem(item)
                if todo is None and lesson.name not in finished:
                    todo = item
        current = todo or self._first()
        if current is not None:
            self.lessons.setCurrentItem(current)
        self.start.setEnabled(bool(lessons))

    def _add_heading(self, course: Course, minutes: int) -> None:
        item = QListWidgetItem(f"{course.title}, {minutes} min")
        item.setFlags(Qt.ItemFlag.NoItemFlags)
        font = item.font()
        font.setBold(True)
        item.setFont(font)
        item.setForeground(QColor(TEXT))  # a disabled item is too faint to read
        self.lessons.addItem(item)

    def _first(self) -> QListWidgetItem | None:
        """Return the first lesson."""
        items = (self.lessons.item(row) for row in range(self.lessons.count()))
        return next((item for item in items if _lesson_of(item)), None)

    def _describe(self, item: QListWidgetItem | None) -> None:
        """Show aims and prerequisites of the course of a lesson."""
        name = _lesson_of(item)
        course = self._courses.get(name)
        self.about.setVisible(course is not None and bool(course.aims))
        if course is not None:
            self.about.setText(f"**{course.title}** ({course.level}). {course.aims} *Assumes:* {course.assumes}")
        self.results.setEnabled(name in self._ended)

    def _start(self, item: QListWidgetItem | None) -> None:
        if name := _lesson_of(item):
            self.started.emit(name)


class StepPage(QWidget):
    """One step: a question to answer first, what to move, what to look for, and why."""

    # A step without a question of that kind shows what to look for, a question and a button for its answer.

    def __init__(self) -> None:
        super().__init__()
        self.left = push_button("‹ Lessons", "Leave this lesson; the scene stays as it is now", wide=True)
        self.lecture = _lecture_button()
        self.lesson, self.step = make_label("lesson"), make_label("step")
        self.introduction, self.text = _words(), _words()
        self.tick, self.look_for, self.question, self.answer = _words("tick"), _words(), _words(), _words()
        self.ask, self.verdict = QuestionBox(), _words("verdict")
        self.show_me = push_button("Show me", "Make the change that this step describes", wide=True)
        tip = "Show the answer to the question"
        self.reveal = push_button("Show the answer", tip, lambda: self._show_answer(True), wide=True)
        self.back = push_button("Back", "Return to the step before (Page Up)", wide=True)
        self.next = push_button("Next", "Go to the next step (Page Down)", wide=True)
        for key, button in (("PgUp", self.back), ("PgDown", self.next)):  # which remote controls of projectors send
            QShortcut(QKeySequence(key), self, button.click)
        self.tick.setAlignment(Qt.AlignmentFlag.AlignCenter)
        self._lay_out()

    def show_step(self, lesson: Lesson, index: int, run: str) -> None:
        """Show a step, not yet done, its answer hidden."""
        step = lesson.steps[index]
        first = step.ask is not None
        if step.ask is not None:
            self.ask.show_question(step.question, step.ask, run)
        self.ask.show_asked(first)
        self.lesson.setText(lesson.title)
        self.introduction.setText(lesson.introduction)
        self.introduction.setVisible(index == 0 and bool(lesson.introduction))
        self.step.setText(f"{index + 1} of {len(lesson.steps)}: {step.title}")
        self.text.setText(step.text)
        self.look_for.setText(f"**Look for** {step.look_for}")
        self.question.setText(f"**Question** {step.question}")
        self.answer.setText(f"**{'Why' if first else 'Answer'}** {step.answer}")
        self.back.setEnabled(index > 0)
        self.next.setText("Next" if index + 1 < len(lesson.steps) else "Finish")
        self._show_answer(False)
        self.reveal.setVisible(not first)
        for part in (self.look_for, self.question):
            part.setVisible(not first)
        self.verdict.hide()
        self.show_done(False)
        self._scroll.verticalScrollBar().setValue(0)

    def show_done(self, done: bool) -> None:
        """Tick the step, and light the button that goes on."""
        self.tick.setText("✓ done" if done else "○ not done yet")
        light(self.tick, done)
        light(self.next, done)
        self.show_me.setEnabled(not done)

    def show_verdict(self, verdict: Verdict | None) -> None:
        """Show how good the answer is, what to look for, and why; None if the question has no answer here."""
        self.ask.show_note(False)
        if verdict is not None:
            self.verdict.setText(f"{SIGNS[verdict.grade]} {verdict.words}")
        self.verdict.setVisible(verdict is not None)
        self.look_for.show()
        self._show_answer(True)
        # The column is laid out when the event loop runs next.
        QTimer.singleShot(0, self, lambda: self._scroll.ensureWidgetVisible(self.look_for))

    def _show_answer(self, shown: bool) -> None:
        self.answer.setVisible(shown)
        self.reveal.setVisible(not shown)

    def _lay_out(self) -> None:
        self._scroll = ScrollColumn()
        self._scroll.setAccessibleName("Step of the lesson")
        task = fill(QVBoxLayout(), self.lesson, self.introduction, self.step, self.text, spacing=10)
        parts = self.verdict, self.look_for, self.question, self.reveal, self.answer
        reply = fill(QVBoxLayout(), self.ask, _row(self.tick, self.show_me), *parts, spacing=10)
        self._halves, self._page = QBoxLayout(QBoxLayout.Direction.TopToBottom), QVBoxLayout(self)
        self._halves.setSpacing(10)
        self._halves.addLayout(task, 1)
        self._halves.addLayout(reply, 1)
        fill(self._scroll.column, self._halves, None)
        self._ends = _row(self.left, self.lecture), _row(self.back, self.next)
        foot = fill(QVBoxLayout(), self.ask.buttons, self._ends[1])
        fill(self._page, self._ends[0], self._scroll, foot, growing=self._scroll)

    def spread(self, wide: bool) -> None:
        """Lay task, reply and buttons side by side, as in a wide low place, or one below the other."""
        down, right = QBoxLayout.Direction.TopToBottom, QBoxLayout.Direction.LeftToRight
        for layout in (self._page, self._halves):
            layout.setDirection(right if wide else down)
        for layout in self._ends:
            layout.setDirection(down if wide else right)


class SummaryPage(QWidget):
    """What became of a lesson: its questions, a page to hand in, and the lesson that follows."""

    def __init__(self) -> None:
        super().__init__()
        self.left = push_button("‹ Lessons", "Return to the list; the scene stays as it is now", wide=True)
        self.lecture = _lecture_button()
        self.lesson, self.text = _words("lesson"), _words()
        tip = "Write a page to hand in, with your answers, settings and pictures of the record"
        self.save = push_button("Save page…", tip, wide=True)
        self.next = push_button("Next lesson", "Begin the lesson that follows in the list", wide=True)
        fill(QVBoxLayout(self), _row(self.left, self.lecture), self.lesson, self.text, self.save, None, self.next)

    def show_summary(self, worksheet: Worksheet, following: Lesson | None) -> None:
        """Show the summary of a lesson, and offer the lesson that follows."""
        self.lesson.setText(f"{worksheet.lesson.title}: done")
        lines = [worksheet.summary, *(f"- {result}" for result in worksheet.results())]
        self.text.setText("\n".join([*lines, "", f"{worksheet.minutes} min."]))
        self.next.setVisible(following is not None)
        if following is not None:
            self.next.setToolTip(f"Begin “{following.title}”")
        light(self.next, following is not None)


def _lesson_of(item: QListWidgetItem | None) -> str:
    """Return the name of the lesson of an item, empty for a heading."""
    return "" if item is None else item.data(Qt.ItemDataRole.UserRole) or ""


def _row(left: QWidget, right: QWidget) -> QHBoxLayout:
    row = QHBoxLayout()
    row.addWidget(left, 1)
    row.addWidget(right, 1)
    return row


def _words(name: str = "") -> QLabel:
    return make_label(name, form=Qt.TextFormat.MarkdownText)


def _lecture_button() -> QPushButton:
    button = push_button("Lecture", "Fill the screen with record and 3-D view, in large type (F11)", wide=True)
    button.setCheckable(True)
    return button
