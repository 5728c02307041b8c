"""Leads through lessons: opens their scenes, lights fields, and notices that a step was done."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from insonify.files import bundled_scenes
from insonify.lessons import AUTOMATIC, SIDES, Lesson, LessonState, Step, load_lessons, split_move, states_of
from insonify.scene import Scene
from insonify_viewer.panels.lessons.view import LessonsView
from insonify_viewer.panels.panel import Button, Panel, Place, Workbench
from insonify_viewer.record.marked_point import MarkedPoint
from insonify_viewer.record.record import RecordGrowth
from insonify_viewer.state.history import Modelling
from insonify_viewer.state.inspection import Mark


class LessonsPanel(Panel):
    """Shows the list of lessons, or the present step of one."""

    name = "lessons"
    title = "Lessons"
    place = Place.LEFT
    button = Button("Lessons", "Learn step by step what a side-scan sonar shows, and why", "Ctrl+L", icon="lessons")

    def __init__(self, workbench: Workbench) -> None:
        self._workbench, self._session = workbench, workbench.session
        self._lessons: tuple[Lesson, ...] = ()
        self.course: Course | None = None
        self._finished: set[str] = set()
        self._point: MarkedPoint | None = None
        self._newest = 0  # ping
        self._open_now = False
        self._left: Scene | None = None  # as a lesson left it, which is not the person's own work
        self.view = view = LessonsView()
        view.list.started.connect(self.start)
        view.page.left.clicked.connect(self.leave)
        view.page.show_me.clicked.connect(self.move)
        view.page.back.clicked.connect(self.back)
        view.page.next.clicked.connect(self.next)
        for page in (view.list, view.page):
            page.projector.toggled.connect(workbench.project)

    def opened(self, shown: bool) -> None:
        """Read the lessons when the panel first opens; light no field while it is closed."""
        if shown and not self._lessons:
            self._lessons = load_lessons()
            self._show_list()
        self._open_now = shown
        self._light()

    def scene_changed(self, scene: Scene, settled: bool) -> None:
        """Notice what was moved; leave the lesson when the person opens another scene."""
        del settled
        if self.course is None:
            return
        if scene.title != self.course.start.scene.title:
            self.leave()
            self._left = None
        else:
            self._notice()

    def record_grown(self, growth: RecordGrowth) -> None:
        """Note the newest ping."""
        self._newest = int(growth.record.ping.max())

    def point_marked(self, point: MarkedPoint | None) -> None:
        """Notice the point of the record under the mouse."""
        self._point = point
        self._notice()

    def projected(self, large: bool) -> None:
        """Enlarge the text."""
        self.view.enlarge(large)

    def start(self, name: str) -> None:
        """Start a lesson of the list."""
        self.begin(next(lesson for lesson in self._lessons if lesson.name == name))

    def begin(self, lesson: Lesson) -> None:
        """Begin a lesson; the person is asked first what becomes of changes that are not of a lesson."""
        course, asked = Course(lesson), self.course is None and self._session.scene is not self._left
        self.course = None  # what changes on the way is not done by the person
        if self._session.scene == course.start.scene or self._open(course, ask=asked):
            self._model(Modelling(), course.start.window)
            self._show_step(course)
        else:
            self.leave()

    def leave(self) -> None:
        """Return to the list; the scene stays as it is."""
        if self.course is not None:
            self._left = self._session.scene
        self.course = None
        self._workbench.light_fields(())
        self._show_list()

    def back(self) -> None:
        """Return to the step before, as it began."""
        if self.course is not None and self.course.index:
            self._go_to(self.course, self.course.index - 1)

    def next(self) -> None:
        """Go to the next step, or to the list after the last; a step that was left out counts as done by the way."""
        course = self.course
        if course is None:
            return
        if course.finished:
            self._finished.add(course.lesson.name)
        if course.last:
            self.leave()
        else:
            self._go_to(course, course.index + 1)

    def move(self) -> None:
        """Do what the present step asks for."""
        if self.course is None:
            return
        inside, outside = split_move(self.course.step.move)
        if inside:
            self._session.settle(inside)
        self._model(self._session.modelling, outside)
        if "point.slant_range" in outside:
            self._session.point_at(self._mark(outside))

    def _go_to(self, course: Course, index: int) -> None:
        """Begin a step as it is meant to begin, or with what the person has just done in the step before."""
        forward, base = course.done and index > course.index, course.base
        course.go_to(index)
        self.course = None
        if course.base != base:
            self._open(course, ask=False)
        elif not forward or course.step.set:
            self._session.open(course.start.scene, _file_of(course), bundled=True)
        if course.base != base or not forward:
            self._model(Modelling(), course.start.window)
        self._show_step(course)

    def _open(self, course: Course, *, ask: bool) -> bool:
        """Open the scene of a step at the start of its track; return whether the person agreed."""
        return self._workbench.open_scene(course.start.scene, _file_of(course), ask=ask)

    def _model(self, modelling: Modelling, window: Mapping[str, Any]) -> None:
        """Turn to a modelling, with the choices of the plan that a state of the window names."""
        for path, value in window.items():
            subject = path.removeprefix("plan.")
            if path == "plan.tolerance":
                modelling = modelling.tolerating(float(value))
            elif subject != path:
                modelling = modelling.forcing(subject, None if value == AUTOMATIC else str(value))
        if modelling != self._session.modelling:
            self._session.model(modelling)

    def _mark(self, point: Mapping[str, Any]) -> Mark:
        """Bin of the record at a point that a step names."""
        sonar = self._session.scene.sonar
        ping = int(point.get("point.ping", self._newest))
        place = int(point["point.slant_range"] / sonar.range * sonar.bins)
        return Mark(ping, SIDES.index(point.get("point.side", SIDES[0])), place)

    @property
    def _state(self) -> LessonState:
        """What conditions read."""
        modelling, point = self._session.modelling, self._point
        window: dict[str, Any] = {"plan.tolerance": modelling.tolerance}
        window |= {f"plan.{subject}": choice for subject, choice in modelling.forced}
        if point is not None:
            mark = point.mark
            window |= {"point.ping": mark.ping, "point.side": mark.side_name, "point.slant_range": point.slant_range}
        return LessonState(self._session.scene, window)

    def _notice(self) -> None:
        if self.course is not None and self.course.notice(self._state):
            self.view.page.show_done(True)

    def _show_step(self, course: Course) -> None:
        """Show the present step, and light what it speaks of."""
        self.course = course
        self.view.page.show_step(course.lesson, course.index)
        self.view.setCurrentWidget(self.view.page)
        self._light()
        self._notice()

    def _show_list(self) -> None:
        self.view.list.show_lessons(self._lessons, self._finished)
        self.view.setCurrentWidget(self.view.list)

    def _light(self) -> None:
        """Light the fields of the present step, with the panel that shows them in front."""
        if self.course is not None and self._open_now:
            fields = self.course.step.fields
            self._workbench.open_panel("plan" if fields[0].startswith("plan.") else "parameters")
            self._workbench.light_fields(fields)
        else:
            self._workbench.light_fields(())


def _file_of(course: Course) -> str:
    """File of the bundled scene that a step is about."""
    return str(bundled_scenes()[course.base])


class Course:
    """A lesson under way."""

    def __init__(self, lesson: Lesson) -> None:
        self.lesson, self.index = lesson, 0
        self._states = tuple(states_of(lesson))
        self._done: set[int] = set()

    @property
    def step(self) -> Step:
        """The present step."""
        return self.lesson.steps[self.index]

    @property
    def start(self) -> LessonState:
        """The state in which the present step begins."""
        return self._states[self.index][1]

    @property
    def base(self) -> str:
        """Name of the bundled scene that the present step is about."""
        own = [step.scene for step in self.lesson.steps[: self.index + 1] if step.scene]
        return own[-1] if own else self.lesson.scene

    @property
    def done(self) -> bool:
        """Whether the present step was done."""
        return self.index in self._done

    @property
    def last(self) -> bool:
        """Whether the present step is the last."""
        return self.index + 1 == len(self.lesson.steps)

    @property
    def finished(self) -> bool:
        """Whether every step was done."""
        return len(self._done) == len(self.lesson.steps)

    def notice(self, state: LessonState) -> bool:
        """Note the present step as done if its condition holds; return whether it does for the first time."""
        if self.done or not self.step.condition.holds(state.value):
            return False
        self._done.add(self.index)
        return True

    def go_to(self, index: int) -> None:
        """Go to a step, which is to be done anew, with those that follow it."""
        self.index = index
        self._done = {number for number in self._done if number < index}
