"""Ticks of the effects: what is shown, and the edits that a tick makes."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

from insonify.scene import Scene
from insonify_viewer.panels.parameters.effect_catalogue import EFFECTS, Changes
from insonify_viewer.panels.parameters.effect_meter import has_grain
from insonify_viewer.record.comparison.record_difference import NOTHING_SEEN, VISIBLE, RecordDifference, say_percent

GRAIN_APART = " Speckle is left out of these figures: its grain is drawn anew, which changes single bins and no shape."
AUDIBLE = 0.05  # dB, the least change of the mean level that is told


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
            return "", "This scene has had no such effect; tick it to add one with usual settings"
        if name not in differences:
            return "…", "what it changes is being measured"
        difference = differences[name]
        if difference is None:
            return "–", "what it changes cannot be measured here"
        grain = GRAIN_APART if has_grain(scene) and name != "speckle" else ""
        return say_difference(difference), explain_difference(difference, on) + grain


def say_difference(difference: RecordDifference) -> str:
    """Say how much of the picture something changes visibly: "changes 12 %"."""
    if difference.visible >= NOTHING_SEEN:
        return f"changes {say_percent(difference.visible)}"
    return "changes nothing visible" if difference.share or difference.visible else "changes nothing"


def explain_difference(difference: RecordDifference, on: bool) -> str:
    """Say in sentences what an effect changes, by the eye's measure and by that of the plan."""
    level = ""
    if abs(difference.decibels) >= AUDIBLE:
        level = f", the mean level by {difference.decibels:+.1f} dB".replace("-", "−")
    return (
        f"{'Without' if on else 'With'} it {say_percent(difference.visible)} of the picture would be fainter or louder "
        f"by {VISIBLE:g} dB or more{level}. The rms of the record, which "
        f"strong echoes rule and by which the plan measures errors, would differ by {say_percent(difference.share)}."
    )


def describe_tick(name: str, on: bool) -> str:
    """Name of the edit that a tick makes."""
    return f"{name} brought back" if on else f"{name} taken out"
