"""Solves the sonar equation of the scene on another thread, and shows it at the range under the cursor."""

from insonify.scene import Scene, SceneError
from insonify_viewer.panels.budget.levels import SolvedBudget
from insonify_viewer.panels.budget.view import BudgetView
from insonify_viewer.panels.panel import Button, Panel, Place, Workbench
from insonify_viewer.record.marked_point import MarkedPoint

Wanted = tuple[Scene, float]  # the scene and the target strength, dB


class BudgetPanel(Panel):
    """Shows the levels of bed, target and noise, line by line and over range, while it is open."""

    name = "budget"
    title = "Sonar equation"
    place = Place.BELOW
    button = Button("Sonar equation", "See the levels of bed, target and noise line by line, and over range", "Ctrl+B")

    def __init__(self, workbench: Workbench) -> None:
        self._session, self._executor = workbench.session, workbench.simulator.executor
        self._open = False
        self._asked: Wanted | None = None
        self._shown: Wanted | None = None
        self._solved: SolvedBudget | None = None
        self._range: float | None = None  # slant range under the cursor, m; None for half that of the record
        self.view = BudgetView()
        self.view.targeted.connect(lambda _: self._solve())
        self.view.ranged.connect(self._move)

    @property
    def complete(self) -> bool:
        """Whether the panel shows the present scene, or is closed."""
        return not self._open or self._shown == self._wanted

    @property
    def _wanted(self) -> Wanted:
        return self._session.scene, self.view.target_strength

    def opened(self, shown: bool) -> None:
        """Solve the equation of the present scene when the panel opens."""
        self._open = shown
        self._solve()

    def scene_changed(self, scene: Scene, settled: bool) -> None:
        """Solve the equation of another scene once its slider is released."""
        if settled:
            self._solve()

    def point_marked(self, point: MarkedPoint | None) -> None:
        """Show the terms at the range under the cursor."""
        if point is not None:
            self._move(point.slant_range)

    def _move(self, slant_range: float) -> None:
        """Show the terms at a slant range."""
        self._range = slant_range
        self._show()

    def _solve(self) -> None:
        """Solve the equation, unless that is done or under way."""
        wanted = self._wanted
        if not self._open or wanted in (self._asked, self._shown):
            return
        self._asked = wanted
        self._executor.submit("budget", lambda: _solved(*wanted), lambda found: self._take(wanted, found))

    def _take(self, asked: Wanted, found: SolvedBudget | SceneError | None) -> None:
        """Show a solution, unless another one is wanted by now."""
        if self._asked == asked:
            self._asked = None
        if asked != self._wanted:
            self._solve()
            return
        self._shown = asked
        self._solved = found if isinstance(found, SolvedBudget) else None
        if self._solved is None:
            self.view.show_nothing(str(found or "the sonar equation of this scene cannot be solved"))
        else:
            self.view.show_levels(self._solved)
            self._show()

    def _show(self) -> None:
        """Show the terms of the solved scene at the present range."""
        if self._solved is not None and self._open:
            reach = self._solved.scene.sonar.range
            self.view.show_range(min(0.5 * reach if self._range is None else self._range, reach))


def _solved(scene: Scene, target_strength: float) -> SolvedBudget | SceneError:
    # lazy: loads Numba on the thread of the panel; the window opens before
    from insonify.explanation.sonar_equation import solve_sonar_equation

    try:
        return SolvedBudget(scene, target_strength, *solve_sonar_equation(scene, target_strength))
    except SceneError as error:
        return error
