"""Measures in the background what each effect changes of the record on screen."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from insonify.scene import Scene, SceneError, edit
from insonify_viewer.record.comparison.record_difference import RecordDifference, RecordSnapshot, compare_records
from insonify_viewer.state.modelling import Modelling
from insonify_viewer.work.newest_wins import NewestWins

if TYPE_CHECKING:
    from insonify.simulation import Simulation
    from insonify_viewer.record.record import Record
    from insonify_viewer.work.simulator import Simulator

KEPT = 32  # scenes whose figures are kept, for undo and redo
FEWEST = 48  # pings
SECONDS = 0.1  # predicted, for the pings of one effect by the present plan
GRAIN = "receiver.speckle"  # drawn anew by most edits, which changes almost every bin and nothing that is seen


@dataclass
class _Measured:
    """Figures of a scene under a modelling, and its record without speckle, once that is known."""

    scene: Scene
    modelling: Modelling
    smooth: RecordSnapshot | None = None
    differences: dict[str, RecordDifference | None] = field(default_factory=dict)


class EffectMeter:
    """Compares the record on screen with that of the scene with one effect more or less, one after the other.

    Each record is relative to the level bed of its own scene, as it is shown. Both are compared without speckle, except
    for what the speckle itself changes. Figures of recent scenes are kept.
    """

    def __init__(self, simulator: Simulator, updated: Callable[[], None]) -> None:
        self._simulator, self._updated = simulator, updated
        self._thread = NewestWins("effects", simulator.call_later)
        self._known: deque[_Measured] = deque(maxlen=KEPT)
        self._turn = 0  # counts what is measured; what was begun before is dropped

    def differences(self, scene: Scene, modelling: Modelling) -> Mapping[str, RecordDifference | None]:
        """Differences by name of the effect, as far as they are known; None for one that cannot be measured."""
        found = self._find(scene, modelling)
        return {} if found is None else found.differences

    def stop(self) -> None:
        """Measure no further effect of the scene before; the one under way is still noted."""
        self._turn += 1

    def begin(
        self, simulation: Simulation, record: Record, modelling: Modelling, variants: Mapping[str, dict[str, Any]]
    ) -> None:
        """Measure what is not known yet."""
        self.stop()
        scene = simulation.scene
        found = self._find(scene, modelling)
        if found is None:
            found = _Measured(scene, modelling)
            self._known.append(found)
        wanted = [name for name in variants if name not in found.differences]
        if wanted:
            before = _snapshot_some(simulation, record)
            self._measure(self._turn, found, before, [(name, variants[name]) for name in wanted])

    def close(self, patience: float | None = None) -> None:
        """End the thread, after the effect under way."""
        self.stop()
        self._thread.close(patience)

    def _find(self, scene: Scene, modelling: Modelling) -> _Measured | None:
        return next((each for each in self._known if each.modelling == modelling and each.scene == scene), None)

    def _measure(
        self,
        turn: int,
        found: _Measured,
        before: RecordSnapshot,
        wanted: list[tuple[str, dict[str, Any]]],
    ) -> None:
        """Measure the first of some effects on the thread, then the others."""
        (name, changes), *others = wanted

        def take(difference: RecordDifference | None) -> None:
            found.differences[name] = difference
            if others and turn == self._turn:
                self._measure(turn, found, before, others)
            self._updated()

        self._thread.send(partial(self._difference, found, before, changes), take)

    def _difference(self, found: _Measured, before: RecordSnapshot, changes: dict[str, Any]) -> RecordDifference | None:
        """Difference that an edit makes to a record, on the thread; None if the edited scene cannot be simulated."""
        try:
            if GRAIN not in changes and has_grain(found.scene):
                found.smooth = found.smooth or self._trace(edit(found.scene, {GRAIN: "none"}), found, before.ping)
                before = found.smooth
            return compare_records(before, self._trace(edit(before.scene, changes), found, before.ping))
        except SceneError:
            return None

    def _trace(self, scene: Scene, found: _Measured, pings: NDArray[np.int64]) -> RecordSnapshot:
        amplitude = self._simulator.trace_beside(scene, found.modelling, pings)
        rows = np.concatenate([amplitude[:, 0, ::-1], amplitude[:, 1]], axis=1)
        return RecordSnapshot(scene, pings, np.square(rows))


def has_grain(scene: Scene) -> bool:
    """Whether the record of a scene has speckle."""
    return scene.receiver.speckle.kind != "none"


def _snapshot_some(simulation: Simulation, record: Record) -> RecordSnapshot:
    """Copy pings of a record, spread evenly, as many as are traced in a moment."""
    held = np.sort(record.ping[record.ping >= 0])
    count = min(max(simulation.pings_within(SECONDS), FEWEST), held.size)
    pings: NDArray[np.int64] = held[np.unique(np.linspace(0, held.size - 1, count).astype(np.int64))]
    intensity = np.square(record.amplitude[record.rows(pings)])
    return RecordSnapshot(simulation.scene, pings, intensity)
