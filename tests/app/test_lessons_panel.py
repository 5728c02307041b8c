"""The lessons' panel in a window: steps are noticed, fields are lit, and scenes follow."""

import re
from typing import Any
from unittest.mock import Mock

import numpy as np
import pytest
from controls import finish
from PySide6.QtCore import Qt
from PySide6.QtWidgets import QMessageBox

from insonify.lessons.lesson import Lesson, load_lessons, parse_lesson
from insonify.lessons.questions import order_choices
from insonify.lessons.states import LessonState, split_move, states_of
from insonify.planning import plan
from insonify.scene import edit
from insonify_viewer.application import enlarge_text, keep_display
from insonify_viewer.panels.lessons.view.question_box import QuestionBox
from insonify_viewer.state.history import Modelling
from insonify_viewer.state.sections import sections_of
from insonify_viewer.state.session import Session
from insonify_viewer.widgets.theme import Theme
from insonify_viewer.window.settings import SIZES

LESSON = """+++
title = "Range"
scene = "pipe-on-bed"
order = 1
display = { scale = "true" }
set = { "sonar.bins" = 100 }
+++

About *range*.

## See farther

Move the range to 60 m.

```toml
move = { "sonar.range" = 60.0 }
done = "sonar.range >= 60"
```

Look for: more bed.
Question: How much?
Answer: 10 m.

## Accept an error

Move the tolerance to 20 %.

```toml
move = { "plan.tolerance" = 0.2 }
done = "plan.tolerance >= 0.2"
```

Look for: a faster record.
Question: How fast?
Answer: Faster.

## Point at the pipe

Move the mouse over the port side of another scene.

```toml
scene = "figure-4b"
set = { "sonar.bins" = 100 }
move = { "point.side" = "port", "point.slant_range" = 20.2, "point.ping" = 60 }
done = 'point.side == "port" and point.slant_range > 20'
```

Look for: a cross.
Question: Where?
Answer: There.
"""


MISTAKES = '[{ value = "sonar.range", because = "Slant range is no distance on the bed." }]'
CHOICES = '[{ text = "Faster", right = true }, { text = "Slower", because = "Fewer planes are traced." }]'
ASKING = LESSON.replace('>= 60"\n', f'>= 60"\nask = {{ value = "swath()", unit = "m", mistakes = {MISTAKES} }}\n')
ASKING = ASKING.replace('>= 0.2"\n', f'>= 0.2"\nask.choices = {CHOICES}\n')
RANGE = parse_lesson(LESSON, "range")
ASKED = parse_lesson(ASKING, "range"), parse_lesson(LESSON.replace("Range", "Another", 1), "another")


@pytest.fixture
def open_lessons(open_viewer, small, qtbot, monkeypatch):
    """Open a viewer with its panel of lessons, which may offer some lessons alone; its first may be started."""

    def open_panel(*offered: Lesson, started: bool = False) -> tuple[Any, Any]:
        if offered:
            monkeypatch.setattr("insonify_viewer.panels.lessons.controller.load_lessons", lambda: offered)
        viewer = open_viewer(small)
        viewer.window.open_panel("lessons")
        panel = viewer.panels["lessons"]
        qtbot.waitUntil(panel.view.isVisible)
        if started:
            finish(viewer, qtbot, panel.view.list.start.click)
        return viewer, panel

    return open_panel


def lit_rows(viewer) -> set[str]:
    boxes = viewer.panels["parameters"].view.sections.values()
    return {path for box in boxes for path, row in box.rows.items() if row.label.property("lit")}


def test_a_lesson_from_its_first_step_to_its_last_and_back_lights_its_fields(open_lessons, small, qtbot):
    viewer, panel = open_lessons(RANGE, started=True)
    page, session = panel.view.page, viewer.session
    assert (session.scene.title, session.scene.sonar.bins) == ("A pipe on the bed", 100)
    assert (page.lesson.text(), page.step.text()) == ("Range", "1 of 3: See farther")
    assert lit_rows(viewer) == {"sonar.range"}
    assert not viewer.panels["parameters"].view.row("sonar.range").label.visibleRegion().isEmpty()
    assert not page.next.property("lit")
    assert not page.back.isEnabled()
    assert (session.scene.controls, session.display.scale, viewer.tow.running) == (("sonar.range",), "true", False)
    camera = viewer.seabed.view.canvas.plotter.camera
    qtbot.waitUntil(lambda: camera.focal_point == pytest.approx((20.0, -30.0, 0.0), abs=1e-6))  # it glides there

    assert page.question.isVisible()
    assert not page.answer.isVisible()
    page.reveal.click()
    assert page.answer.isVisible()
    assert "10 m" in page.answer.text()

    session.drag({"sonar.range": 59.0})
    assert not page.next.property("lit")
    session.drag({"sonar.range": 61.0})  # noticed while the slider moves
    session.settle()
    assert page.next.property("lit")
    assert "done" in page.tick.text()
    session.settle({"sonar.range": 50.0})
    assert page.next.property("lit"), "what was done stays done"

    page.next.click()
    assert page.step.text() == "2 of 3: Accept an error"
    assert lit_rows(viewer) == set()
    tolerance = viewer.panels["plan"].view.tolerance.label
    assert tolerance.property("lit")
    assert not tolerance.visibleRegion().isEmpty(), "the panel of the plan is in front"
    assert not page.answer.isVisible()
    assert not page.next.property("lit")
    session.model(session.modelling.tolerating(0.25))
    assert page.next.property("lit")

    page.next.click()
    assert not tolerance.property("lit")
    assert session.scene.title.startswith("Three pairs of spheres, fan")
    assert session.modelling == Modelling()
    qtbot.waitUntil(lambda: viewer.complete, timeout=20000)
    page.show_me.click()
    qtbot.waitUntil(lambda: bool(page.next.property("lit")), timeout=10000)
    assert page.next.text() == "Finish"
    page.next.click()
    assert panel.progress is None
    assert panel.view.list.lessons.item(0).text().startswith("✓")
    # Back returns to a step as it began, and another scene ends the lesson.
    finish(viewer, qtbot, panel.start, "range")
    page.next.click()  # a step that is left out is done by the way
    assert (session.scene.sonar.range, panel.progress.index) == (60.0, 1)
    page.show_me.click()
    assert session.modelling.tolerance == 0.2
    page.back.click()
    assert page.step.text().startswith("1 of 3")
    assert (session.scene.sonar.range, session.modelling) == (50.0, Modelling())
    assert not page.next.property("lit")
    viewer.open(edit(small, {"seed": 3}))
    assert panel.progress is None
    assert panel.view.currentWidget() is panel.view.list
    assert lit_rows(viewer) == set()


def shown(page) -> tuple[bool, bool]:
    """Whether what to look for and the explanation show."""
    return page.look_for.isVisible(), page.answer.isVisible()


def test_the_explanation_waits_for_an_answer_and_the_move_on_which_it_is_judged(open_lessons, qtbot):
    viewer, panel = open_lessons(*ASKED, started=True)
    page = panel.view.page
    actions = [lambda: (page.ask.number.setText("60 m"), page.ask.answer.click()), page.show_me.click]
    for order in (actions, actions[::-1]):
        assert page.ask.isVisible()
        assert not page.reveal.isVisible()
        for action in order:
            assert shown(page) == (False, False)
            action()
        assert shown(page) == (True, True)
        assert page.verdict.text() == "✗ Not quite. Answer: 118 m. Slant range is no distance on the bed."
        assert not page.ask.number.isEnabled()
        viewer.session.settle({"sonar.range": 70.0})
        assert "118 m" in page.verdict.text(), "it is judged once"
        finish(viewer, qtbot, panel.start, "range")
    viewer.session.settle({"track.altitude": 20.0})  # her own scene
    page.ask.number.setText("113")
    page.ask.number.returnPressed.emit()
    assert page.ask.note.isVisible()
    viewer.session.settle({"sonar.range": 65.0})
    assert page.verdict.text() == "✓ Right: 113 m."
    assert not page.ask.note.isVisible()


@pytest.mark.parametrize("run", ["morning", "noon", "evening", "night"])
@pytest.mark.parametrize("text", ["Faster", "Slower"])
def test_a_choice_is_signalled_by_its_place_in_the_file_wherever_it_stands(qtbot, run, text):
    ask = next(step.ask for step in ASKED[0].steps if step.ask and step.ask.choices)
    box, answers = QuestionBox(), []
    qtbot.addWidget(box)
    box.answered.connect(lambda *answer: answers.append(answer))
    box.show_question("Faster?", ask, run)
    rows = [row.label.text() for row in box.choices]
    assert rows == [ask.choices[place].text for place in order_choices("Faster?", ask, run)]
    box.choices[rows.index(text)].button.click()
    box.answer.click()
    assert answers == [(text, [choice.text for choice in ask.choices].index(text))]


def test_choices_unknown_answers_and_the_summary(open_lessons, qtbot, tmp_path, monkeypatch):
    _, panel = open_lessons(*ASKED, started=True)
    page, summary = panel.view.page, panel.view.summary
    page.ask.unknown.click()
    page.show_me.click()
    assert page.verdict.text() == "→ Answer: 118 m."
    page.next.click()
    assert shown(page) == (False, False)
    assert not page.ask.answer.isEnabled()
    rows = {row.label.text(): row for row in page.ask.choices}
    qtbot.mouseClick(rows["Slower"].label, Qt.MouseButton.LeftButton)
    page.ask.answer.click()
    page.show_me.click()
    assert page.verdict.text() == "✗ Not quite. Answer: Faster. Fewer planes are traced."
    page.next.click()
    assert page.reveal.isVisible(), "the last step asks nothing in advance"
    page.back.click()
    assert [*rows] == [row.label.text() for row in page.ask.choices], "the order is that of the run"
    assert [row.label.text() for row in page.ask.choices if row.button.isChecked()] == ["Slower"], "the answer is kept"
    page.next.click()
    page.next.click()
    assert panel.view.currentWidget() is summary
    assert "2 questions: 1 wrong, 1 not known." in summary.text.text()
    file = tmp_path / "page.md"
    monkeypatch.setattr("insonify_viewer.panels.lessons.controller.ask_where_to_save", lambda *_: file)
    summary.save.click()
    text = file.read_text(encoding="utf-8")
    assert "- **Answer**: Slower" in text
    assert all((tmp_path / f"page-{step}.png").exists() and f"page-{step}.png" in text for step in (1, 2, 3))
    monkeypatch.setattr("insonify_viewer.panels.lessons.controller.ask_where_to_save", lambda *_: tmp_path / "page.pdf")
    summary.save.click()
    printed = (tmp_path / "page.pdf").read_bytes()
    assert printed.startswith(b"%PDF")
    widths = [int(width) for width in re.findall(rb"/Subtype /Image\n/Width (\d+)", printed)]
    assert len(widths) == 3
    assert min(widths) > 200, "each is the record, not the sign of a missing picture"
    assert len([*tmp_path.iterdir()]) == 5, "of a PDF no pictures lie beside it"
    panel.leave()
    viewed = panel.view.list
    assert viewed.results.isEnabled() is (viewed.lessons.currentRow() == 0)
    viewed.lessons.setCurrentRow(0)
    viewed.results.click()
    assert panel.view.currentWidget() is summary, "answers are kept"
    summary.next.click()
    assert panel.progress.lesson.name == "another"
    panel.leave()
    panel.start("another")
    for _ in range(3):
        page.next.click()
    assert not summary.next.isVisible(), "no lesson follows the last"
    summary.left.click()
    assert panel.view.currentWidget() is panel.view.list


def test_lessons_stand_under_the_titles_of_their_courses_and_show_their_first_field(open_lessons, qtbot):
    viewer, panel = open_lessons()
    page = panel.view.list
    texts = [page.lessons.item(row).text() for row in range(page.lessons.count())]
    assert texts[0] == "First look, 55 min"
    assert page.lessons.currentRow() == 1
    assert "(beginner)" in page.about.text()
    headings = [row for row in range(len(texts)) if not page.lessons.item(row).flags() & Qt.ItemFlag.ItemIsEnabled]
    assert len(texts) - len(headings) == len(load_lessons())
    page.lessons.itemActivated.emit(page.lessons.item(0))
    assert panel.progress is None, "a heading starts nothing"
    # Its first field comes into view with the scene of a lesson.
    finish(viewer, qtbot, panel.start, "time-varied-gain")
    row = viewer.panels["parameters"].view.row("receiver.tvg.spreading")
    qtbot.waitUntil(lambda: not row.label.visibleRegion().isEmpty(), timeout=5000)
    assert row.label.property("lit")


def test_a_lesson_asks_nothing_and_leaves_scene_and_display_as_they_were(open_lessons, qtbot, monkeypatch):
    one_sided = LESSON.replace('{ scale = "true" }', '{ side = "port", water_column = false }')
    viewer, panel = open_lessons(RANGE, parse_lesson(one_sided, "port"))
    viewer.session.settle({"track.altitude": 7.0})
    mine = viewer.session.scene
    assert viewer.saving.unsaved
    monkeypatch.setattr(QMessageBox, "question", Mock(side_effect=AssertionError("asked")))
    panel.view.list.start.click()
    panel.move()
    panel.start("range")
    panel.move()
    assert not viewer.saving.unsaved, "what a lesson changes is nobody's work"
    assert panel.progress is not None
    while viewer.session.scene != mine:
        viewer.session.undo()
    assert panel.progress is None, "another scene ends the lesson"
    assert viewer.saving.unsaved
    # As ``insonify view --lesson`` begins one: in a window that shows its scene already.
    scene = next(states_of(RANGE))[1].scene
    finish(viewer, qtbot, viewer.open, scene)
    undoable = viewer.session.history.undoable
    panel.begin(RANGE)
    assert panel.view.isVisible()
    assert panel.view.page.lesson.text() == "Range"
    assert lit_rows(viewer) == {"sonar.range"}
    assert viewer.session.scene is scene
    assert viewer.session.history.undoable == undoable
    panel.view.page.left.click()
    assert lit_rows(viewer) == set()
    # It shows both sides unless it names one, and restores the display.
    keep_display(viewer)
    session, settings = viewer.session, viewer.window.settings
    session.show(side="starboard", scale="true")
    mine = session.display
    panel.start("port")
    assert (session.display.side, session.display.scale, session.display.water_column) == ("port", "fill", False)
    panel.start("range")
    assert (session.display.side, session.display.scale, session.display.water_column) == ("both", "true", True)
    panel.leave()
    assert session.display == mine
    panel.start("port")
    viewer.window.close()
    assert settings.display == {"side": "starboard", "scale": "true"}, "kept for the next start"


def test_a_lecture_is_full_screen_in_large_type_with_the_record_on_more_than_half(open_lessons, qtbot, qapp):
    viewer, panel = open_lessons(RANGE, started=True)
    window, page = viewer.window, panel.view.page

    def sizes():
        return np.array([part.font().pointSizeF() for part in (page.text, window.waterfall)])

    before = sizes()
    window.lecture.action.trigger()
    assert window.isFullScreen()
    assert page.lecture.isChecked()
    assert (sizes() >= 1.5 * before).all()
    assert list(viewer.panels["parameters"].strip.rows) == ["sonar.range"], "what the step speaks of"
    qtbot.waitUntil(lambda: panel.view.isVisible() and panel.view.width() > 0.9 * window.width())
    window.looks.show_theme(Theme.LIGHT)
    assert (sizes() >= 1.5 * before).all()
    window.looks.show_theme(Theme.DARK)
    page.lecture.click()
    assert not window.isFullScreen()
    assert sizes() == pytest.approx(before)
    # Above the lesson the record keeps more than half of the screen, whatever the size of the text.
    record = window.waterfall
    for size in SIZES:
        enlarge_text(qapp, size)
        window.lecture.action.trigger()
        qtbot.waitUntil(lambda: record.width() * record.height() > 0.5 * window.width() * window.height())
        window.lecture.action.trigger()
        qtbot.waitUntil(lambda: not window.isFullScreen())


@pytest.mark.parametrize("name", [lesson.name for lesson in load_lessons()])
def test_every_field_of_a_lesson_is_in_the_window_every_choice_in_the_plan_and_every_move_is_noticed(name):
    """A field has a row, a choice in the plan, or a curve of the water.

    A move has the dependent edits that the window adds, one field after the other as by hand, and all at once.
    """
    lesson = next(lesson for lesson in load_lessons() if lesson.name == name)
    for step, start, end in states_of(lesson):
        scenes = [start.scene, start.moved(step.move).scene]
        rows = {row.path for scene in scenes for section in sections_of(scene) for row in section.parameters}
        elsewhere = ("water.depth.", "water.sound_speed.", "plan.", "point.")
        assert all(path in rows or path.startswith(elsewhere) for path in step.move), step.move
        inside, _ = split_move(step.move)
        for changes in ([inside], [{path: value} for path, value in inside.items()]):
            session = Session(start.scene)
            assert all(session.settle(change) for change in changes if change)
            state = LessonState(session.scene, end.window)
            assert step.condition.holds(state.value)
            assert session.scene.title == start.scene.title
        if any(path.startswith("plan.") for path in step.move):
            forced = {path.removeprefix("plan."): choice for path, choice in step.move.items()}
            made = plan(end.scene, forced=forced)
            forced.pop("tolerance", None)
            assert all(choice in made.entry(subject).options for subject, choice in forced.items())
