"""Effects that can be taken out of a scene, such as speckle, and what each changes of the record."""

from collections import deque
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import partial
from typing import Any, NamedTuple

import numpy as np

from insonify.acoustics.water import speed_at_sonar
from insonify.arrays import Integers
from insonify.scene import Scene, SceneError, edit, plain
from insonify.scene.edit import part_at
from insonify.scene.water import WaterKind
from insonify_viewer.core_types import Simulation
from insonify_viewer.panels.parameters.values import value_at
from insonify_viewer.record.comparison.record_difference import (
    NOTHING_SEEN,
    VISIBLE,
    RecordDifference,
    RecordSnapshot,
    compare_records,
    say_percent,
)
from insonify_viewer.record.record import Record
from insonify_viewer.state.history import Modelling
from insonify_viewer.work.simulator import Simulator

Changes = dict[str, Any]
KEPT = 32  # scenes whose figures are kept, for undo and redo
FEWEST = 48  # pings
SECONDS = 0.1  # predicted, for the pings of one effect by the present plan
GRAIN = "receiver.speckle"  # drawn anew by most edits, which changes almost every bin and nothing that is seen
GRAIN_APART = " Both records are compared without speckle, whose random grain changes single pixels but no shape."
AUDIBLE = 0.05  # dB, the least change of the mean level that is shown


@dataclass(frozen=True)
class Effect:
    """A part of the scene with a kind for its absence."""

    name: str  # texts to show
    meaning: str
    path: str  # dotted path of the part
    off: str  # kind without the effect, and the kind that a scene gets that never had it
    on: str

    def is_on(self, scene: Scene) -> bool:
        """Whether a scene has the effect."""
        part = part_at(scene, self.path)
        return part is not None and bool(part.kind != self.off)

    def settings(self, scene: Scene) -> Changes:
        """Plain values of the part."""
        return dict(value_at(plain(scene), self.path))

    def take_out(self, scene: Scene) -> Changes:
        """Edit that takes the effect out of a scene."""
        return {self.path: self.off}

    def bring_back(self, scene: Scene, settings: Changes | None) -> Changes:
        """Edit that brings the effect back into a scene, with earlier settings if there are any."""
        return {self.path: settings or self.on}


class Bending(Effect):
    """Sound speed that varies in the water; absorption and sea surface are not part of it."""

    def take_out(self, scene: Scene) -> Changes:
        """Edit that gives the water everywhere the speed at the sonar."""
        return {f"{self.path}.kind": self.off, f"{self.path}.sound_speed": round(speed_at_sonar(scene), 2)}

    def bring_back(self, scene: Scene, settings: Changes | None) -> Changes:
        """Edit that brings the sound speeds back, with absorption and surface as they are now."""
        if settings is None:
            return {f"{self.path}.kind": self.on}
        own = {name: value for name, value in settings.items() if name not in WaterKind.model_fields}
        now = {name: value for name, value in self.settings(scene).items() if name in WaterKind.model_fields}
        return {self.path: now | own}


EFFECTS = (
    Effect("beam", "The beam widens with range and blurs targets along the track; without it, it is infinitely narrow",
           "sonar.beam", "knife", "fan"),
    Effect("pulse", "The pulse has a length, which blurs echoes in range; without it, it is shorter than a range bin",
           "sonar.pulse", "ideal", "tone"),
    Bending("bending", "Sound bends where its speed changes with depth; without it, sound travels straight",
            "water", "uniform", "profile"),
    Effect("ghosts", "Echoes that return by way of the sea surface (multipath), later than the direct one",
           "water.surface", "none", "flat"),
    Effect("speckle", "Grain: echoes of many scatterers within one pixel interfere", "receiver.speckle", "none",
           "rayleigh"),
    Effect("noise", "Noise of the sea and of the receiver, added to the echoes", "receiver.noise", "none", "ambient"),
    Effect("TVG", "Time-varied gain amplifies late echoes; the picture is relative to a level bed under the same gain",
           "receiver.tvg", "none", "power"),
)  # fmt: skip


@dataclass
class _Measured:
    """Figures of a scene under a modelling, and its record without speckle, once that is known."""

    scene: Scene
    modelling: Modelling
    smooth: RecordSnapshot | None = None
    differences: dict[str, RecordDifference | None] = field(default_factory=dict)


class EffectMeter:
    """Compares the record on screen with that of the scene with one effect more or less, one after the other."""

    # Each record is relative to the level bed of its own scene, as it is shown. Both are compared without speckle,
    # except for what the speckle itself changes. Figures of recent scenes are kept.

    def __init__(self, simulator: Simulator, updated: Callable[[], None]) -> None:
        self._simulator, self._updated = simulator, updated
        self._known: deque[_Measured] = deque(maxlen=KEPT)
        self._turn = 0  # counts what is measured; what was begun before is dropped

    def differences(self, scene: Scene, modelling: Modelling) -> Mapping[str, RecordDifference | None]:
        """Known differences by name of the effect; None for one that cannot be measured."""
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

        self._simulator.executor.submit("effects", partial(self._difference, found, before, changes), take)

    def _difference(self, found: _Measured, before: RecordSnapshot, changes: dict[str, Any]) -> RecordDifference | None:
        """Difference that an edit makes to a record, on the thread; None if the edited scene cannot be simulated."""
        try:
            if GRAIN not in changes and has_grain(found.scene):
                found.smooth = found.smooth or self._trace(edit(found.scene, {GRAIN: "none"}), found, before.ping)
                before = found.smooth
            return compare_records(before, self._trace(edit(before.scene, changes), found, before.ping))
        except SceneError:
            return None

    def _trace(self, scene: Scene, found: _Measured, pings: Integers) -> RecordSnapshot:
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
    pings: Integers = held[np.unique(np.linspace(0, held.size - 1, count).astype(np.int64))]
    intensity = np.square(record.amplitude[record.rows(pings)])
    return RecordSnapshot(simulation.scene, pings, intensity)


class EffectRow(NamedTuple):
    """What is shown of an effect."""

    name: str  # texts of the tick box
    meaning: str
    on: bool  # whether the scene has it
    figure: str  # what it changes, "…" while that is measured, and the same in a sentence
    explanation: str


class EffectTicks:
    """Remembers the settings of effects that are taken out, as long as the same scene is open."""

    def __init__(self) -> None:
        self._opened: Scene | None = None
        self._settings: dict[str, Changes] = {}

    def follow(self, scene: Scene, opened: Scene) -> None:
        """Note the settings of the effects that a scene has; forget them when another scene is opened."""
        if opened is not self._opened:
            self._opened, self._settings = opened, {}
        for effect in EFFECTS:
            if effect.is_on(scene):
                self._settings[effect.name] = effect.settings(scene)

    def tick(self, scene: Scene, name: str, on: bool) -> Changes:
        """Edit that brings an effect back with its last settings, or takes it out."""
        effect = next(each for each in EFFECTS if each.name == name)
        return effect.bring_back(scene, self._settings.get(name)) if on else effect.take_out(scene)

    def variants(self, scene: Scene) -> dict[str, Changes]:
        """Edits that take out each effect of a scene, and bring back those that were taken out."""
        return {
            effect.name: self.tick(scene, effect.name, not effect.is_on(scene))
            for effect in EFFECTS
            if effect.is_on(scene) or effect.name in self._settings
        }

    def rows(self, scene: Scene, differences: Mapping[str, RecordDifference | None]) -> tuple[EffectRow, ...]:
        """Rows to show for a scene, given what is known of the changes."""
        return tuple(
            EffectRow(effect.name, effect.meaning, on, *self._figure(effect.name, on, differences, scene))
            for effect in EFFECTS
            for on in [effect.is_on(scene)]
        )

    def _figure(
        self, name: str, on: bool, differences: Mapping[str, RecordDifference | None], scene: Scene
    ) -> tuple[str, str]:
        if not on and name not in self._settings:
            return "", "Not in this scene; tick it to add it with usual settings"
        if name not in differences:
            return "…", "measuring how much of the record it changes"
        difference = differences[name]
        if difference is None:
            return "–", "how much it changes cannot be measured in this scene"
        grain = GRAIN_APART if has_grain(scene) and name != "speckle" else ""
        return say_difference(difference), explain_difference(difference, on) + grain


def say_difference(difference: RecordDifference) -> str:
    """State how much of the picture something changes visibly: "changes 12 %"."""
    if difference.visible >= NOTHING_SEEN:
        return f"changes {say_percent(difference.visible)}"
    return "changes nothing visible" if difference.share or difference.visible else "changes nothing"


def explain_difference(difference: RecordDifference, on: bool) -> str:
    """State in sentences what an effect changes, by the eye's measure and by that of the plan."""
    level = ""
    if abs(difference.decibels) >= AUDIBLE:
        level = f", the mean level by {difference.decibels:+.1f} dB".replace("-", "−")
    return (
        f"{'Without' if on else 'With'} it, {say_percent(difference.visible)} of the picture would change by "
        f"{VISIBLE:g} dB or more{level}. The whole record, in which strong echoes count most, would change by "
        f"{say_percent(difference.share)} (rms)."
    )


def describe_tick(name: str, on: bool) -> str:
    """Name of the edit that a tick makes."""
    return f"{name} switched {'on' if on else 'off'}"
