"""What a bin of the record shows: its greatest contributor, by which path, and what hides the bed."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from insonify.explanation.names import PATH_NAMES, name_materials, name_part

if TYPE_CHECKING:
    from insonify.simulation import Simulation
    from insonify.tracers.labels import RecordLabels

BED = -1
HIDDEN = 0.5  # share of the bed's echo that is hidden where a bin counts as shadow
LEAST = 0.05  # share hidden that is worth telling


@dataclass(frozen=True)
class PixelLabel:
    """The label of one bin."""

    source: str = ""  # what the greatest echo comes from: ``pipe 1``, ``bed``; empty without an echo
    material: str = ""  # of the source; empty where it has none
    ghost: str = ""  # the path of that echo in words; empty for the direct one
    shadow: str = ""  # what hides the bed there: ``shadow of pipe 1``; empty where no target hides it
    ground_range: float | None = None  # of the echo, in metres
    incidence: float | None = None  # on the source, in degrees

    @property
    def words(self) -> list[str]:
        """The label as it is read, part by part."""
        echo = ", ".join(filter(None, (self.source, self.material)))
        parts = [f"{self.ghost} ({echo})" if self.ghost and echo else self.ghost or echo, self.shadow]
        if self.incidence is not None:
            parts.append(f"incidence {self.incidence:.0f}°")
        return [part for part in parts if part]


def label_bin(simulation: Simulation, labels: RecordLabels, side: int, range_bin: int) -> PixelLabel:
    """Read the label of one bin."""
    # lazy: loads Numba; the window opens before
    from insonify.tracers.labels import PATHS

    place = (0, side, range_bin)
    scene = simulation.scene
    shadow = _shadow(scene.targets, float(labels.shadow[place]), int(labels.shadow_id[place]))
    volume = int(labels.volume_id[place])
    if volume >= 0:
        return PixelLabel(source=name_part(scene.volumes, volume), shadow=shadow)
    target, row, path = int(labels.target_id[place]), int(labels.material[place]), int(labels.path[place])
    return PixelLabel(
        source=name_part(scene.targets, target) if target >= 0 else "bed" if target == BED else "",
        material=name_materials(scene, simulation.ground)[row] if row >= 0 else "",
        ghost=PATH_NAMES[PATHS[path]] if path > 0 else "",  # the first is the direct one
        shadow=shadow,
        ground_range=_number(labels.ground_range[place]),
        incidence=_number(labels.incidence[place]),
    )


def _shadow(targets: tuple[object, ...], share: float, index: int) -> str:
    if index < 0 or share < LEAST:
        return ""
    of = f"shadow of {name_part(targets, index)}"
    return of if share >= HIDDEN else f"{100 * share:.0f} % in the {of}"


def _number(value: float) -> float | None:
    return float(value) if math.isfinite(value) else None
