"""Lessons read from Markdown files with TOML in front and in every step."""

import json
import re
from pathlib import Path
from typing import Any, TypeVar

from pydantic import Field, ValidationError, field_validator

from insonify.display.display_options import read_display
from insonify.errors import SceneError, plain_text
from insonify.files import bundled_lessons
from insonify.io.file_access import FileFault, parse_toml, read_named
from insonify.lessons.conditions import Condition, parse_condition
from insonify.lessons.questions import Ask
from insonify.scene.base import Declaration
from insonify.scene.faults import describe_fault

LARGEST = 2**20  # bytes of a lesson
PARTS = {"Look for": "look_for", "Question": "question", "Answer": "answer"}
_FRONT = re.compile(r"\A\+\+\+[ \t]*\n(.*?)^\+\+\+[ \t]*$", re.DOTALL | re.MULTILINE)
_STEP = re.compile(r"^## +(.+?)[ \t]*$", re.MULTILINE)
_BLOCK = re.compile(r"^```toml[ \t]*\n(.*?)^```[ \t]*$", re.DOTALL | re.MULTILINE)
_PART = re.compile(rf"^({'|'.join(PARTS)}):[ \t]*", re.MULTILINE)
Head = TypeVar("Head", bound=Declaration)


class LessonHead(Declaration):
    """Front matter of a lesson: its title, course and place, the scene that it starts from, and how that is shown."""

    title: str = Field(min_length=1)
    scene: str = Field(min_length=1)
    order: int
    course: str = ""
    minutes: int = Field(default=0, ge=0)
    set: dict[str, Any] = Field(default={})
    draw: dict[str, tuple[float, float]] = Field(default={})  # least and greatest value of fields that every run draws
    display: dict[str, Any] = Field(default={})  # display options of the record

    @field_validator("display")
    @classmethod
    def _is_display(cls, display: dict[str, Any]) -> dict[str, Any]:
        return read_display([f"{name}={json.dumps(value)}" for name, value in display.items()])


class StepHead(Declaration):
    """Machine-readable part of a step: the move to make, and the condition that it fulfils."""

    done: str = Field(min_length=1)
    move: dict[str, Any] = Field(min_length=1)
    scene: str = ""
    set: dict[str, Any] = Field(default={})
    topic: str = ""  # of its course
    ask: Ask | None = None


class Step(StepHead):
    """One step of a lesson."""

    title: str
    text: str
    look_for: str
    question: str
    answer: str

    @property
    def condition(self) -> Condition:
        """The condition, parsed."""
        return parse_condition(self.done)

    @property
    def fields(self) -> tuple[str, ...]:
        """Dotted paths of the step: those that it moves, then others of its condition."""
        return tuple(dict.fromkeys((*self.move, *self.condition.fields)))


class Lesson(LessonHead):
    """A lesson."""

    name: str
    introduction: str
    steps: tuple[Step, ...]


def load_lesson(name_or_path: str | Path) -> Lesson:
    """Read a lesson."""
    path = bundled_lessons().get(str(name_or_path)) or Path(name_or_path)
    text = read_named("lesson", str(name_or_path), path, form="Markdown", bundled=bundled_lessons(), largest=LARGEST)
    return parse_lesson(plain_text(text), path.stem)


def load_lessons() -> tuple[Lesson, ...]:
    """Read the bundled lessons, in their order."""
    lessons = (load_lesson(name) for name in bundled_lessons())
    return tuple(sorted(lessons, key=lambda lesson: (lesson.order, lesson.name)))


def parse_lesson(text: str, name: str) -> Lesson:
    """Parse the text of a lesson."""
    front = _FRONT.match(text)
    if front is None:
        raise SceneError(f"lesson {name}: has no front matter; begin with title, scene and order between lines of +++")
    head = _declared(LessonHead, front[1], f"lesson {name}")
    introduction, *parts = _STEP.split(text[front.end() :])
    steps = tuple(_step(title, body, f"lesson {name}, step {title!r}") for title, body in zip(parts[::2], parts[1::2]))
    if not steps:
        raise SceneError(f"lesson {name}: has no step; add a heading '## What to do' and what belongs below it")
    return Lesson(name=name, introduction=introduction.strip(), steps=steps, **dict(head))


def _step(title: str, body: str, where: str) -> Step:
    """Parse one step."""
    blocks = _BLOCK.findall(body)
    if len(blocks) != 1:
        raise SceneError(f"{where}: has {len(blocks)} blocks of TOML; write one ```toml block with move and done")
    head = _declared(StepHead, blocks[0], where)
    text, *rest = _PART.split(_BLOCK.sub("", body))
    parts = {PARTS[name]: paragraph.strip() for name, paragraph in zip(rest[::2], rest[1::2])}
    for name, key in PARTS.items():
        if not parts.get(key):
            raise SceneError(f"{where}: has no paragraph '{name}: …'; add it")
    if not text.strip():
        raise SceneError(f"{where}: has no text about what to move; begin with a sentence")
    return Step(title=title, text=text.strip(), **parts, **dict(head))


def _declared(kind: type[Head], toml: str, where: str) -> Head:
    """Validate a block of TOML."""
    try:
        values: dict[str, Any] = parse_toml(toml)
        return kind.model_validate(values)
    except FileFault as fault:
        raise SceneError(f"{where}: its TOML {fault}") from None
    except ValidationError as error:
        raise SceneError(f"{where}: {describe_fault(error, kind)}") from None
