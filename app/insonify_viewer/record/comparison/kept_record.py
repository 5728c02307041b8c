"""A simulated record that is kept while the scene changes, and the fields that differ since."""

from collections.abc import Iterator
from typing import Any, NamedTuple, Self

import numpy as np

from insonify.arrays import Floats, Integers, Singles
from insonify.scene import Scene, plain
from insonify_viewer.record.record import Record, pings_held
from insonify_viewer.state.fields import name_field
from insonify_viewer.state.history import Modelling
from insonify_viewer.work.ping_request import SimulatedScene, TracedPings, find_altitude

BLOCK_TIME = 0.1  # s, predicted for a block of pings, after which it is shown
Traced = tuple[Singles, Floats]
STAMP = 0  # of all rows: a kept record does not change
UNHEARD = ("title", "description", "controls", "partner")  # fields that do not concern the record
AUTOMATIC = "automatic"


class KeptRecord:
    """The record of a scene under one modelling, traced where it is looked at."""

    def __init__(self, scene: Scene, modelling: Modelling, simulated: SimulatedScene | None = None) -> None:
        self.scene, self.modelling, self.simulated = scene, modelling, simulated
        self.record = Record(pings_held(scene), scene.sonar.bins)

    @classmethod
    def of(cls, record: Record, modelling: Modelling, answer: TracedPings) -> Self:
        """Copy the pings of a record on screen that were traced for the request of an answer."""
        simulation = answer.simulation
        kept = cls(simulation.scene, modelling, SimulatedScene(simulation, answer.level))
        kept.record.amplitude[:] = record.amplitude
        kept.record.ping[:] = np.where(record.stamp == answer.stamps.max(), record.ping, -1)
        kept.record.stamp[:] = STAMP
        kept.record.altitude[:] = record.altitude
        return kept

    def missing(self, top: int) -> Integers:
        """Pings that are on screen below a ping on top, and not traced yet; as many as take a moment."""
        missing = self.record.missing(top, STAMP)
        return missing if self.simulated is None else missing[: self.simulated.simulation.pings_within(BLOCK_TIME)]

    def trace(self, pings: Integers) -> Traced:
        """Trace pings: amplitudes relative to a level bed, (n, 2, bins), and altitudes, (n,), in metres."""
        assert self.simulated is not None
        simulation, level = self.simulated
        return level.amplitudes(pings), find_altitude(simulation, pings)


class Change(NamedTuple):
    """A field or a choice that differs, with its values in words."""

    name: str
    before: str
    after: str

    def in_words(self) -> str:
        """Write the change, as "beam width 1 → 2.5"."""
        return f"{self.name} {self.before} → {self.after}"


def list_changes(before: tuple[Scene, Modelling], after: tuple[Scene, Modelling]) -> list[Change]:
    """List what differs between two scenes and their modellings; of a part of another kind the kind alone."""
    old, new = (dict(_values(plain(scene))) for scene, _ in (before, after))
    differing = [path for path in dict.fromkeys([*old, *new]) if old.get(path) != new.get(path)]
    return [
        Change(name_field(after[0] if path in new else before[0], path), _word(old.get(path)), _word(new.get(path)))
        for path in differing
        if path not in UNHEARD and not ((path in old) is not (path in new) and _owners(path).intersection(differing))
    ] + list(_choices(before[1], after[1]))


def _choices(before: Modelling, after: Modelling) -> Iterator[Change]:
    """List what differs between two modellings."""
    if before.tolerance != after.tolerance:
        yield Change("tolerance", f"{100.0 * before.tolerance:g} %", f"{100.0 * after.tolerance:g} %")
    choices, others = dict(before.forced), dict(after.forced)
    for subject in dict.fromkeys([*choices, *others]):
        chosen, instead = choices.get(subject, AUTOMATIC), others.get(subject, AUTOMATIC)
        if chosen != instead:
            yield Change(subject, chosen, instead)


def _owners(path: str) -> set[str]:
    """Paths of the parts that hold a field."""
    steps = path.split(".")
    return {".".join(steps[:k]) for k in range(1, len(steps))}


def _values(value: Any, path: str = "") -> Iterator[tuple[str, Any]]:
    """Every value of nested ones by its dotted path; the kind of a declaration by that of the declaration."""
    if isinstance(value, dict):
        for key, child in value.items():
            yield from _values(child, path if key == "kind" else f"{path}.{key}" if path else key)
    elif isinstance(value, list) and (not value or any(isinstance(item, dict | list) for item in value)):
        for number, child in enumerate(value):
            yield from _values(child, f"{path}.{number}")
    else:
        yield path, value


def _word(value: Any) -> str:
    """Write a value; "none" where a scene has none."""
    if value is None:
        return "none"
    return f"{value:.4g}" if isinstance(value, float) else str(value)
