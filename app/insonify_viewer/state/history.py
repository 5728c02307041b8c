"""History of a session: scene, modelling, contacts and display before and after the present edit."""

from dataclasses import dataclass, field, replace
from typing import Self

from insonify.display.display_options import DisplayOptions
from insonify.io.contacts import Contact
from insonify.scene import Scene

USUAL = 0.03  # share of the record
# While a slider moves, one plane or few rays stand for the beam, which is 17 % of the record wrong for a fan of 1°.
# Finer methods would add nothing to that.
OF_FINENESS = ("method", "planes", "rays", "step")
UNDO_DEPTH = 200


@dataclass(frozen=True)
class Modelling:
    """The tolerance of a plan, and its forced choices."""

    tolerance: float = USUAL  # greatest error beyond 1.4 altitudes, as a share of the record
    # Subject and choice of the plan's entries that are forced; each subject at most once.
    forced: tuple[tuple[str, str], ...] = ()

    def forcing(self, subject: str, choice: str | None) -> Self:
        """Return a copy in which the choice of a subject is forced, or with None left to the plan again."""
        others = tuple(pair for pair in self.forced if pair[0] != subject)
        return replace(self, forced=others if choice is None else (*others, (subject, choice)))

    def tolerating(self, tolerance: float) -> Self:
        """Return a copy with another tolerance."""
        return replace(self, tolerance=tolerance)

    @property
    def automatic(self) -> Self:
        """A copy in which every choice is left to the plan."""
        return replace(self, forced=())

    @property
    def coarse(self) -> Self:
        """The coarse modelling that replaces it while a slider moves."""
        kept = tuple(pair for pair in self.forced if pair[0] not in OF_FINENESS)
        return replace(self, forced=(*kept, ("planes", "1"), ("rays", "1000")))


@dataclass(frozen=True)
class State:
    """What undo goes back to: declarations and small things, never arrays."""

    scene: Scene
    modelling: Modelling
    opened: Scene = field(compare=False)  # the scene as it was opened
    contacts: tuple[Contact, ...] = ()  # states share those that stay, with the compressed pictures around them
    display: DisplayOptions = field(default_factory=DisplayOptions)  # how records are shown
    edit: str = field(default="", compare=False)  # name of the edit that led to the state

    def simulates_as(self, other: Self) -> bool:
        """Whether another state has the same scene and the same modelling."""
        return (self.scene, self.modelling) == (other.scene, other.modelling)

    def shows(self, other: Self) -> bool:
        """Whether another state differs by the display alone."""
        return self.simulates_as(other) and self.contacts == other.contacts


class History:
    """The present state, and up to `UNDO_DEPTH` states before it."""

    def __init__(self, present: State) -> None:
        self.present = present
        self._past: list[State] = []
        self._future: list[State] = []

    @property
    def undoable(self) -> tuple[str, ...]:
        """Names of the edits that can be undone, the last first."""
        return tuple(state.edit for state in reversed([*self._past[1:], self.present])) if self._past else ()

    @property
    def redoable(self) -> tuple[str, ...]:
        """Names of the edits that can be redone, the next first."""
        return tuple(state.edit for state in reversed(self._future))

    def turn_to(self, state: State) -> None:
        """Make a state the present one, by one step if anything differs."""
        if state == self.present:
            self.present = replace(state, edit=self.present.edit)
            return
        self._past = [*self._past, self.present][-UNDO_DEPTH:]
        self._future = []
        self.present = state

    def show(self, display: DisplayOptions, name: str) -> None:
        """Change the display by a step, which takes up further changes of the same name."""
        state = replace(self.present, display=display, edit=name)
        if not all(state.shows(later) for later in self._future):
            self._show_throughout(display)
            return
        if self._past and self.present.edit == name and self._past[-1].shows(state):
            self.present, self._future = self._past.pop(), []
        self.turn_to(state)

    def show_first(self, display: DisplayOptions) -> None:
        """Begin with a display, without a step."""
        self.present = replace(self.present, display=display)

    def step(self, steps: int) -> bool:
        """Go forward some steps, or back by a negative number of them; return whether there was one."""
        taken, given = (self._future, self._past) if steps > 0 else (self._past, self._future)
        count = min(abs(steps), len(taken))
        for _ in range(count):
            given.append(self.present)
            self.present = taken.pop()
        return count > 0

    def take_back(self) -> None:
        """Take out the edit that led to the present scene and modelling; what was done to other things since stays."""
        since, wrong = [self.present], self.present
        while len(since) <= len(self._past) and self._past[-len(since)].simulates_as(wrong):
            since.append(self._past[-len(since)])
        if len(since) > len(self._past):
            return  # every state has this scene
        self._past = self._past[: len(self._past) - len(since) + 1]
        self.present = right = self._past.pop()
        for state in reversed(since[:-1]):
            self._past.append(self.present)
            self.present = replace(state, scene=right.scene, modelling=right.modelling, opened=right.opened)

    def _show_throughout(self, display: DisplayOptions) -> None:
        """Change the display here and in what can be redone, which is not given up for another look."""
        before = self.present.display._asdict()
        changed = {name: value for name, value in display._asdict().items() if value != before[name]}
        self.present = replace(self.present, display=display)
        self._future = [replace(state, display=state.display._replace(**changed)) for state in self._future]
