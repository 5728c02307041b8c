"""Solves the sonar equation of the scene on another thread, and shows it at the range under the cursor."""

from functools import partial

from insonify.scene import Scene, SceneError
from insonify_viewer.panels.budget.levels import SolvedBudget
from insonify_viewer.panels.budget.view import BudgetView
from insonify_viewer.panels.panel import Button, Panel, Place, Workbench
from insonify_viewer.record.marked_point import MarkedPoint
from insonify_viewer.work.newest_wins import NewestWins

Wanted = tuple[Scene, float]  # the scene and the target strength, dB


class BudgetPanel(Panel):
    """Shows the levels of bed, target and noise, line by line and over range, while it is open."""

    name = "budget"
    title = "Sonar equation"
    place = Place.BELOW
    button = Button("Sonar equation", "See the levels of bed, target and noise line by line, and over range", "Ctrl+B")

    def __init__(self, workbench: Workbench) -> None:
        self._session = workbench.session
        self._open = False
        send = partial(workbench.simulator.executor.submit, "budget")
        self._question = NewestWins(lambda: self._wanted, send, _solved, self._take)
        self.solved: SolvedBudget | None = None
        self.range: float | None = None  # slant range under the cursor, m; None for half that of the record
        self.view = BudgetView()
        self.view.targeted.connect(lambda _: self._question.ask())
        self.view.ranged.connect(self._move)

    @property
    def complete(self) -> bool:
        """Whether the panel shows the present scene, or is closed."""
        return self._question.complete

    @property
    def _wanted(self) -> Wanted | None:
        return (self._session.scene, self.view.target_strength) if self._open else None

    def opened(self, shown: bool) -> None:
        """Solve the equation of the present scene when the panel opens."""
        self._open = shown
        self._question.ask()

    def scene_changed(self, scene: Scene, settled: bool) -> None:
        """Solve the equation of another scene once its slider is released."""
        if settled:
            self._question.ask()

    def point_marked(self, point: MarkedPoint | None) -> None:
        """Show the terms at the range under the cursor."""
        if point is not None:
            self._move(point.slant_range)

    def _move(self, slant_range: float) -> None:
        """Show the terms at a slant range."""
        self.range = slant_range
        self._show()

    def _take(self, found: SolvedBudget | SceneError | None) -> None:
        """Show a solution, or why there is none."""
        self.solved = found if isinstance(found, SolvedBudget) else None
        if self.solved is None:
            self.view.show_nothing(str(found or "the sonar equation of this scene cannot be solved"))
        else:
            self.view.show_levels(self.solved)
            self._show()

    def _show(self) -> None:
        """Show the terms of the solved scene at the present range."""
        if self.solved is not None and self._open:
            reach = self.solved.scene.sonar.range
            self.view.show_range(min(0.5 * reach if self.range is None else self.range, reach))


def _solved(scene: Scene, target_strength: float) -> SolvedBudget | SceneError:
    # lazy: loads Numba on the thread of the panel; the window opens before
    from insonify.explanation.sonar_equation import solve_sonar_equation

    try:
        return SolvedBudget(scene, target_strength, *solve_sonar_equation(scene, target_strength))
    except SceneError as error:
        return error
