"""Steers the tow by keys, sends it to survey programs, and lets the person survey an exercise and be marked."""

import math
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from insonify.live.helm import Helm
from insonify.scene import Scene, SceneError
from insonify_viewer.core_types import Simulation
from insonify_viewer.panels.panel import Button, Panel, Place, Workbench
from insonify_viewer.panels.tow.view import TowView
from insonify_viewer.record.record import RecordGrowth, pings_held

if TYPE_CHECKING:
    from insonify.exercises.exercise import Exercise

TURN, FASTEST_TURN = 1.0, 12.0  # °/s, of one press of a key, and the most
FASTER, SLOWEST, FASTEST = 0.25, 0.5, 5.0  # m/s


class TowPanel(Panel):
    """Steering, live output and exercises."""

    name = "tow"
    title = "Tow"
    place = Place.LEFT
    button = Button("Tow", "Steer the tow, send it to survey programs, or survey an exercise", "Ctrl+T", menu="Tools")

    def __init__(self, workbench: Workbench) -> None:
        self._workbench, self._opened = workbench, workbench.session.opened
        self._exercise: Exercise | None = None
        self._file = ""
        self._wanted: tuple[Exercise, str] | None = None  # an exercise and its file while its scene is being opened
        self.view = TowView()
        self.view.steered.connect(self.steer)
        self.view.live_wanted.connect(self.go_live)
        self.view.marks_wanted.connect(self.mark)
        workbench.add_actions(self.view.keys)

    def steer(self, turn: int, faster: int) -> None:
        """Turn more to port for a positive step, to starboard for a negative one, straight for 0; or change speed."""
        tow = self._workbench.tow
        if tow.helm is None:
            self._follow(Helm(self._workbench.session.scene, tow.newest))
        helm = tow.helm
        assert helm is not None
        if faster:
            helm.speed = min(max(helm.speed + faster * FASTER, SLOWEST), FASTEST)
        else:
            helm.turn = min(max(helm.turn + turn * TURN, -FASTEST_TURN), FASTEST_TURN) if turn else 0.0
        self._show_helm()

    def go_live(self, ports: dict[str, int]) -> None:
        """Send the present scene, or the exercise, to survey programs; the list of jobs stops it."""
        work = self._workbench
        scene = self._file or work.jobs.write_scene(work.session.scene)
        options = [word for name, port in ports.items() for word in (f"--{name.lower()}", str(port))]
        work.jobs.begin("live tow", ["tow", scene, *options], None)
        listed = ", ".join(f"{name} on port {port}" for name, port in ports.items())
        work.say(f"live on this machine: {listed}; stop it in Jobs")

    def open_exercise(self, path: str) -> None:
        """Open an exercise: what is hidden there stays hidden from the window, and echoes in the record."""

        def read() -> Any:
            # lazy: loaded on the worker; the window opens before Numba is loaded
            from insonify.exercises.exercise import read_exercise

            return read_exercise(path)

        self._workbench.simulator.send(read, partial(self._open, path))

    def _open(self, path: str, exercise: "Exercise | SceneError") -> None:
        """Open the scene of an exercise that was read."""
        if isinstance(exercise, SceneError):
            self._workbench.complain(exercise)
            return
        self._wanted = exercise, path
        self._workbench.open_scene(exercise.bare, "", ask=True)
        self._wanted = None

    def mark(self) -> None:
        """Mark the contacts of the list, and show what was found and missed."""
        # lazy: loads Numba; the window opens before
        from insonify.exercises.marking import Found, Track, describe_marks, mark_contacts

        exercise, helm = self._exercise, self._workbench.tow.helm
        if exercise is not None and helm is not None:
            contacts = [
                Found(each.name, each.x, each.y, math.nan if each.height is None else each.height)
                for each in self._workbench.contacts.all
                if each.x is not None and each.y is not None
            ]
            scene, line = exercise.scene, helm.line(np.arange(helm.newest + 1))
            track = Track(line.x, line.y, scene.altitude, scene.sonar.range, helm.newest / scene.sonar.ping_rate)
            self.view.show_marks("\n".join(describe_marks(exercise, mark_contacts(exercise, contacts, [track]))))

    def scene_changed(self, scene: Scene, settled: bool) -> None:
        """Begin an exercise if its scene has been opened; end the one before, and its steering."""
        if self._workbench.session.opened is self._opened:
            return
        self._opened = self._workbench.session.opened
        self._exercise, self._file = exercise, _ = self._wanted or (None, "")
        helm = None
        if exercise is not None:
            helm = Helm(scene, 0, exercise.current)
            helm.advance(pings_held(scene) - 1)
            self._workbench.open_panel(self.name)
        self._follow(helm)
        self.view.show_exercise("" if exercise is None else f"{exercise.title}\n\n{' '.join(exercise.task.split())}")

    def record_grown(self, growth: RecordGrowth) -> None:
        """Show where the tow is by now."""
        self._show_helm()

    def _follow(self, helm: Helm | None) -> None:
        """Trace along a helm from now on, over what an exercise hides."""
        self._workbench.tow.helm = helm
        self._workbench.simulator.trace_as(None if helm is None else partial(_steered, helm, self._exercise))
        self._show_helm()

    def _show_helm(self) -> None:
        helm, text = self._workbench.tow.helm, ""
        if helm is not None:
            x, y, heading = (float(column[0]) for column in helm.line(np.array([helm.newest])))
            compass = (90.0 - math.degrees(heading)) % 360.0
            way = f"{abs(helm.turn):g}°/s to {'port' if helm.turn > 0.0 else 'starboard'}" if helm.turn else "straight"
            minutes = helm.newest / self._workbench.session.scene.sonar.ping_rate / 60.0
            limit = f" of {self._exercise.minutes:g}" if self._exercise else ""
            text = f"x {x:.0f} m, y {y:.0f} m, {compass:03.0f}°, {way}, {helm.speed:g} m/s, {minutes:.1f}{limit} min"
        self.view.show_helm(text)


def _steered(helm: Helm, exercise: "Exercise | None", simulation: Simulation) -> Simulation:
    """Steer a simulation, and trace what an exercise hides; all that the window draws is without it."""
    # lazy: loaded on the worker; the window opens before Numba is loaded
    from insonify.live.tow import steer_by

    return steer_by(simulation, helm, None if exercise is None else exercise.hide_in(simulation.scene))
