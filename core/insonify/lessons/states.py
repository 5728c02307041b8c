"""States that a lesson passes through: the scene and the window's choices."""

from collections.abc import Iterator, Mapping, Sequence
from contextlib import AbstractContextManager
from dataclasses import dataclass, field, replace
from itertools import takewhile
from typing import Any, Self

from insonify.errors import SceneError, is_count, located
from insonify.files import bundled_scenes
from insonify.lessons.conditions import Reader, Value
from insonify.lessons.lesson import Lesson, Step
from insonify.lessons.quantities import CHANNEL_SIDES, QUANTITIES
from insonify.scene import Scene, edit, load_scene
from insonify.scene.base import Declaration, is_field

MOST_CONTROLS = 6  # fields that a scene pins
AUTOMATIC = "auto"  # value of a choice that the plan makes itself
USUAL_TOLERANCE = 0.03
WINDOW_FIELDS = {
    "plan": "`plan.tolerance` is the tolerance of the plan, `plan.method` and other choices of it are texts, "
    '`"auto"` where they are not forced',
    "point": '`point.side` (`"port"` or `"starboard"`), `point.slant_range` (m) and `point.ping` are the point of the '
    "record under the mouse",
}


@dataclass(frozen=True)
class LessonState:
    """A scene, and the state of the window about it."""

    scene: Scene  # the scene
    # Values by dotted path; each begins with a name in `WINDOW_FIELDS`.
    window: Mapping[str, Value] = field(default_factory=dict)

    def value(self, path: str) -> Value | None:
        """Value at a dotted path; None where there is none."""
        if not is_window_field(path):
            return field_value(self.scene, path)
        usual = USUAL_TOLERANCE if path == "plan.tolerance" else AUTOMATIC if path.startswith("plan.") else None
        return self.window.get(path, usual)

    def quantity(self, name: str, arguments: tuple[float, ...]) -> float | None:
        """Value of a quantity in the scene; None where only a record has it."""
        compute = QUANTITIES[name].compute
        return None if compute is None else compute(self.scene, *arguments)

    def reader(self, before: Self | None = None) -> Reader:
        """Return what questions read: this state, and that before the move."""
        return Reader(self.value, self.quantity, None if before is None else before.reader())

    def moved(self, move: Mapping[str, Any]) -> Self:
        """Return the state after a move."""
        inside, outside = split_move(move)
        scene = edit(self.scene, inside) if inside else self.scene
        for path, value in outside.items():
            _check_window_value(path, value, scene)
        return replace(self, scene=scene, window={**self.window, **outside})


def start_state(scene: str, changes: Mapping[str, Any]) -> LessonState:
    """Return the state in which a bundled scene is opened, with some values changed."""
    if scene not in bundled_scenes():
        raise SceneError(f"scene: {scene!r} does not come with insonify; choose one of {', '.join(bundled_scenes())}")
    loaded = load_scene(scene)
    return LessonState(edit(loaded, changes) if changes else loaded)


def is_window_field(path: str) -> bool:
    """Whether a dotted path names a field of the window, not of the scene."""
    return path.partition(".")[0] in WINDOW_FIELDS


def split_move(move: Mapping[str, Any]) -> tuple[dict[str, Any], dict[str, Any]]:
    """Split a move into the values of the scene and those of the window."""
    inside = {path: value for path, value in move.items() if not is_window_field(path)}
    return inside, {path: value for path, value in move.items() if path not in inside}


def field_value(scene: Scene, path: str) -> Value | None:
    """Value of a field of the scene; ``none`` is the kind of an effect that is off."""
    place: Any = scene
    fields: list[tuple[Any, str]] = []  # owner and name of every field on the way
    for step in path.split("."):
        fields.append((place, step))
        if isinstance(place, tuple):
            place = place[int(step)] if is_count(step) and int(step) < len(place) else None
        else:
            place = getattr(place, step, None) if step in getattr(type(place), "model_fields", {}) else None
    declared = [isinstance(owner, Declaration) and step in type(owner).model_fields for owner, step in fields]
    if place is None and declared[-1]:
        owner, step = fields[-1]
        place = owner.value_in_force(step, scene.sonar.scattering_frequency)
    elif fields[-1] == (None, "kind") and declared[-2]:
        place = "none"
    return place if isinstance(place, float | int | str) else None


def _check_window_value(path: str, value: Any, scene: Scene) -> None:
    """Reject a value that the window cannot have."""
    if path == "plan.tolerance":
        if isinstance(value, bool | str) or not 0.0 < value <= 1.0:
            raise SceneError(f"{path}: {value!r} is out of bounds; give a number above 0 and at most 1")
    elif path == "point.side":
        if value not in CHANNEL_SIDES:
            raise SceneError(f"{path}: {value!r} is not a side; choose one of {', '.join(CHANNEL_SIDES)}")
    elif path == "point.slant_range":
        if isinstance(value, bool | str) or not 0.0 <= value < scene.sonar.range:
            raise SceneError(f"{path}: {value!r} is outside the record; give 0 up to {scene.sonar.range:g} m")
    elif path == "point.ping":
        if not isinstance(value, int) or value < 0:
            raise SceneError(f"{path}: {value!r} is not the number of a ping; give a whole number from 0")
    elif not path.startswith("plan."):
        raise SceneError(f"{path}: is not known; use point.side, point.slant_range or point.ping")
    elif not isinstance(value, str):
        raise SceneError(f"{path}: {value!r} is not a text; put it in quotes")
    elif value != AUTOMATIC:
        # lazy: loads Numba, and few lessons force a choice
        from insonify.planning.selection import check_request

        check_request(scene, USUAL_TOLERANCE, "auto", {path.removeprefix("plan."): value})


def states_of(lesson: Lesson) -> Iterator[tuple[Step, LessonState, LessonState]]:
    """Yield every step of a lesson with the states before and after its move."""
    with named(lesson):
        end = start_state(lesson.scene, lesson.set | _pins(lesson.steps))
    for index, step in enumerate(lesson.steps):
        with named(lesson, step):
            if step.scene:
                start = start_state(step.scene, step.set | _pins(lesson.steps[index:]))
            else:
                start = end.moved(step.set)
            end = start.moved(step.move)
        yield step, start, end


def _pins(steps: Sequence[Step]) -> dict[str, Any]:
    """Change that pins on top of the parameters what steps move, up to the first that opens another scene."""
    own = takewhile(lambda step: not step.scene, steps[1:])
    moved = dict.fromkeys(path for step in (steps[0], *own) for path in step.move if is_field(Scene, path))
    return {"controls": list(moved)[:MOST_CONTROLS]} if moved else {}


def subject_of(step: Step, scene: Scene) -> tuple[float, float] | None:
    """Place of the target or the volume that a step speaks of, else of the first target; None without any."""
    named = [path.split(".") for path in step.fields if path.startswith(("targets.", "volumes."))]
    parts = [getattr(scene, family)[int(number)] for family, number, *_ in named] or [*scene.targets]
    return (parts[0].position[0], parts[0].position[1]) if parts else None


def named(lesson: Lesson, step: Step | None = None) -> AbstractContextManager[None]:
    """Put the names of the lesson and the step in front of a fault."""
    return located(f"lesson {lesson.name}" + ("" if step is None else f", step {step.title!r}") + ": ")
