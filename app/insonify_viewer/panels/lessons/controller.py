"""Leads through lessons: opens their scenes, lights fields, notices that a step was done, and judges answers."""

from collections.abc import Mapping
from datetime import datetime
from functools import partial
from typing import Any

from insonify.files import bundled_scenes
from insonify.lessons.lesson import Lesson, load_lessons
from insonify.lessons.quantities import CHANNEL_SIDES
from insonify.lessons.states import AUTOMATIC, LessonState, split_move, subject_of
from insonify.scene import Scene
from insonify_viewer.panels.lessons.progress import Progress
from insonify_viewer.panels.lessons.view.lessons_view import LessonsView
from insonify_viewer.panels.panel import Button, Entry, Panel, Place, Workbench
from insonify_viewer.record.marked_point import MarkedPoint
from insonify_viewer.record.record import RecordGrowth
from insonify_viewer.state.history import Modelling
from insonify_viewer.state.inspection import Mark
from insonify_viewer.widgets.save_dialogs import ask_where_to_save

FRAME = {"side": "both", "scale": "fill"}  # of the record, where a lesson asks for nothing else


class LessonsPanel(Panel):
    """Shows the list of lessons, or the present step of one."""

    name = "lessons"
    title = "Lessons"
    place = Place.LEFT
    button = Button("Lessons", "Learn step by step what a side-scan sonar shows, and why", "Ctrl+L", icon="lessons")

    def __init__(self, workbench: Workbench) -> None:
        self._workbench, self._session = workbench, workbench.session
        self._lessons: tuple[Lesson, ...] = ()
        self.progress: Progress | None = None
        self._finished: set[str] = set()
        self._point: MarkedPoint | None = None
        self._newest = 0  # ping
        self._own: dict[str, Any] = {}  # display options of the person that the lesson has replaced
        self._open_now = False
        self._ended: dict[str, Progress] = {}  # lessons that have a summary
        self._shown: Progress | None = None  # answers of the summary on screen
        self.view = view = LessonsView()
        view.list.started.connect(self.start)
        view.list.reviewed.connect(self.review)
        view.page.left.clicked.connect(self.leave)
        view.page.show_me.clicked.connect(self.move)
        view.page.back.clicked.connect(self.back)
        view.page.next.clicked.connect(self.next)
        view.page.ask.answered.connect(self.answer)
        view.summary.left.clicked.connect(self.leave)
        view.summary.save.clicked.connect(self.save)
        view.summary.next.clicked.connect(self.go_on)
        for page in (view.list, view.page, view.summary):
            page.lecture.toggled.connect(workbench.lecture)

    def opened(self, shown: bool) -> None:
        """Read the lessons when the panel first opens; light no field while it is closed."""
        if shown and not self._lessons:
            self._lessons = load_lessons()
            self._show_list()
        self._open_now = shown
        self._light()

    def scene_changed(self, scene: Scene, settled: bool) -> None:
        """Notice what was moved; leave the lesson when the person opens another scene."""
        if self.progress is None:
            return
        if scene.title != self.progress.start.scene.title:
            self.leave()
        else:
            self._session.count_as_saved("lesson", scene)  # what a lesson changes is nobody's work
            self._notice()

    def record_grown(self, growth: RecordGrowth) -> None:
        """Note the newest ping."""
        self._newest = int(growth.record.ping.max())

    def point_marked(self, point: MarkedPoint | None) -> None:
        """Notice the point of the record under the mouse."""
        self._point = point
        self._notice()

    def in_lecture(self, large: bool) -> None:
        """Enlarge the text."""
        self.view.enlarge(large)

    def entries(self) -> list[Entry]:
        """List the lessons for the command palette."""
        return [
            Entry(
                "Lesson", each.title, "; ".join(step.title for step in each.steps), partial(self._begin_in_panel, each)
            )
            for each in load_lessons()
        ]

    def _begin_in_panel(self, lesson: Lesson) -> None:
        """Open the panel and begin a lesson."""
        self._workbench.open_panel(self.name)
        self.begin(lesson)

    def start(self, name: str) -> None:
        """Start a lesson of the list."""
        self.begin(next(lesson for lesson in self._lessons if lesson.name == name))

    def begin(self, lesson: Lesson) -> None:
        """Begin a lesson; undo returns to the scene of before with its changes."""
        progress = Progress(lesson)
        self.progress = None  # what changes on the way is not done by the person
        self.closing()
        display = self._session.display
        self._own = {name: getattr(display, name) for name in FRAME | lesson.display}
        self._open(progress)
        self._model(Modelling(), progress.start.window)
        self._show_step(progress)

    def leave(self) -> None:
        """Return to the list; the scene stays as it is, and the record is shown as before the lesson."""
        self.progress = None
        self.closing()
        self._workbench.light_fields(())
        self._show_list()

    def closing(self) -> None:
        """Show the record as before the lesson, so that this is kept for the next start."""
        if self._own:
            self._session.show_first(**self._own)
            self._own = {}

    def back(self) -> None:
        """Return to the step before, as it began."""
        if self.progress is not None and self.progress.index:
            self._go_to(self.progress, self.progress.index - 1)

    def next(self) -> None:
        """Go to the next step, or to the summary after the last; a step that was left out counts as done by the way."""
        progress = self.progress
        if progress is None:
            return
        self.view.keep_picture(progress.lesson.name, progress.index, self._workbench.record_views[0])
        if progress.finished:
            self._finished.add(progress.lesson.name)
        if progress.last:
            progress.worksheet.ended = datetime.now()
            self._ended[progress.lesson.name] = progress
            self.leave()
            self.review(progress.lesson.name)
        else:
            self._go_to(progress, progress.index + 1)

    def answer(self, text: str, number: float | None) -> None:
        """Keep the answer to the question of the present step, and judge it if the step was done."""
        if self.progress is not None and self.progress.given is None:
            self.progress.answer(text, number, self._state)
            self._explain(self.progress)

    def go_on(self) -> None:
        """Begin the lesson after the one that has ended."""
        following = self._following(self._shown.lesson) if self._shown is not None else None
        if following is not None:
            self.begin(following)

    def review(self, name: str) -> None:
        """Show the summary of a lesson that has ended."""
        self._shown = progress = self._ended[name]
        self.view.summary.show_summary(progress.worksheet, self._following(progress.lesson))
        self.view.setCurrentWidget(self.view.summary)

    def save(self) -> None:
        """Write the page to hand in, with pictures of the record."""
        if self._shown is None:
            return
        worksheet = self._shown.worksheet
        suggestion, formats = f"{worksheet.lesson.name}.pdf", [("PDF", ".pdf"), ("Markdown", ".md")]
        path = ask_where_to_save(self.view.window(), "Save the page to hand in", suggestion, formats)
        if path is None:
            return
        try:
            self.view.save_page(worksheet, path)
        except OSError as error:
            self._workbench.complain(error)
        else:
            self._workbench.say(f"wrote {path}")

    def move(self) -> None:
        """Do what the present step asks for."""
        if self.progress is None:
            return
        inside, outside = split_move(self.progress.step.move)
        if inside:
            self._session.settle(inside)
        self._model(self._session.modelling, outside)
        if "point.slant_range" in outside:
            self._session.point_at(self._mark(outside))

    def _go_to(self, progress: Progress, index: int) -> None:
        """Begin a step as it is meant to begin, or with what the person has just done in the step before."""
        forward, base = progress.done and index > progress.index, progress.base
        progress.go_to(index)
        self.progress = None
        if progress.base != base:
            self._open(progress)
        elif not forward or progress.step.set:
            self._session.open(progress.start.scene, _file_of(progress), bundled=True)
        if progress.base != base or not forward:
            self._model(Modelling(), progress.start.window)
        self._show_step(progress)

    def _open(self, progress: Progress) -> None:
        """Open the scene of a step at the start of its track, with the record and the 3-D view on its subject."""
        scene = progress.start.scene
        if self._session.scene != scene:
            self._workbench.open_scene(scene, _file_of(progress))
        self._session.show_first(**FRAME | progress.lesson.display)
        self._workbench.frame(subject_of(progress.step, scene))

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
        return Mark(ping, CHANNEL_SIDES.index(point.get("point.side", CHANNEL_SIDES[0])), place)

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
        if self.progress is not None and self.progress.notice(self._state):
            self.view.page.show_done(True)
            self._explain(self.progress)

    def _explain(self, progress: Progress) -> None:
        """Show what was answered, and the explanation once the step was done, too."""
        if progress.given is None:
            return
        page = self.view.page
        page.ask.show_answered(progress.given.text)
        if progress.explained:
            page.show_verdict(progress.verdict(self._state))
        else:
            page.ask.show_note(True)

    def _following(self, lesson: Lesson) -> Lesson | None:
        """Return the lesson of the list after a lesson, None after the last and for one that is not in the list."""
        names = [each.name for each in self._lessons]
        place = names.index(lesson.name) + 1 if lesson.name in names else len(names)
        return self._lessons[place] if place < len(names) else None

    def _show_step(self, progress: Progress) -> None:
        """Show the present step, and light what it speaks of."""
        self.progress = progress
        self.view.page.show_step(progress.lesson, progress.index, progress.worksheet.run)
        self.view.setCurrentWidget(self.view.page)
        self._light()
        self._explain(progress)
        self._notice()

    def _show_list(self) -> None:
        self.view.list.show_lessons(self._lessons, self._finished, self._ended)
        self.view.setCurrentWidget(self.view.list)

    def _light(self) -> None:
        """Light the fields of the present step, with the panel that shows them in front."""
        if self.progress is not None and self._open_now:
            fields = self.progress.step.fields
            self._workbench.open_panel("plan" if fields[0].startswith("plan.") else "parameters")
            self._workbench.light_fields(fields)
        else:
            self._workbench.light_fields(())


def _file_of(progress: Progress) -> str:
    """File of the bundled scene that a step is about."""
    return str(bundled_scenes()[progress.base])
