"""The page that a student hands in: answers, verdicts, and the settings of her scene."""

from collections import Counter
from dataclasses import dataclass, field
from datetime import datetime
from pathlib import Path

from insonify.lessons.conditions import Value
from insonify.lessons.lesson import Lesson
from insonify.lessons.questions import Grade, Verdict


@dataclass(frozen=True)
class Answer:
    """Answer of a student to the question of one step."""

    text: str  # as the student gave it
    verdict: Verdict
    settings: tuple[tuple[str, Value], ...]  # fields of the step and their values in her scene


@dataclass
class Worksheet:
    """What a student did in one lesson."""

    lesson: Lesson
    began: datetime
    answers: dict[int, Answer] = field(default_factory=dict)  # by the number of the step, from 0
    ended: datetime | None = None

    @property
    def run(self) -> str:
        """Name of this run, by which the choices of its questions are ordered."""
        return self.began.isoformat()

    @property
    def minutes(self) -> int:
        """Whole minutes from the beginning to the end, at least 1."""
        return max(round(((self.ended or datetime.now()) - self.began).total_seconds() / 60.0), 1)

    @property
    def summary(self) -> str:
        """How many questions of the lesson were answered, and how well."""
        asked = sum(step.ask is not None for step in self.lesson.steps)
        if not asked:
            return "This lesson asks no question in advance."
        grades = Counter(answer.verdict.grade for answer in self.answers.values())
        parts = [f"{grades[grade]} {grade.value}" for grade in Grade if grades[grade]]
        if left := asked - len(self.answers):
            parts.append(f"{left} not answered")
        return f"{asked} question{'s' * (asked > 1)}: {', '.join(parts)}."

    def results(self) -> list[str]:
        """One line for every step that asks: its title and the grade of the answer."""
        return [
            f"{step.title}: {self.answers[index].verdict.grade.value if index in self.answers else 'not answered'}"
            for index, step in enumerate(self.lesson.steps)
            if step.ask is not None
        ]

    def to_markdown(self, pictures: dict[int, Path]) -> str:
        """Write the page, with pictures of records by the number of their step."""
        lines = [
            f"# {self.lesson.title}",
            "",
            "Name:",
            "",
            f"{self.began:%Y-%m-%d %H:%M}, {self.minutes} min. {self.summary}",
        ]
        for index, step in enumerate(self.lesson.steps):
            lines += ["", f"## {index + 1}. {step.title}", "", step.question]
            answer = self.answers.get(index)
            if answer is not None:
                lines += ["", f"- **Answer**: {answer.text}", f"- **Verdict**: {answer.verdict.words}"]
                for path, value in answer.settings:
                    lines.append(f"- `{path}` = {f'{value:.6g}' if isinstance(value, float) else value}")
            elif step.ask is not None:
                lines += ["", "- **Answer**: none"]
            if index in pictures:
                lines += ["", f"![Record after step {index + 1}]({pictures[index].name})"]
            lines += ["", f"**Why**: {step.answer}"]
        return "\n".join(lines) + "\n"
