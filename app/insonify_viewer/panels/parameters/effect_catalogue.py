"""The effects that can be taken out of a scene: beam, pulse, bending, ghosts, speckle, noise, TVG."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from insonify.acoustics.water import speed_at_sonar
from insonify.scene import Scene, plain
from insonify.scene.edit import part_at
from insonify.scene.water import WaterKind

Changes = dict[str, Any]


@dataclass(frozen=True)
class Effect:
    """A part of the scene with a kind that stands for its absence."""

    name: str  # texts to show
    meaning: str
    path: str  # dotted path of the part
    off: str  # kind without the effect, and the kind that a scene gets that never had it
    on: str

    def is_on(self, scene: Scene) -> bool:
        """Whether a scene has the effect."""
        return bool(part_at(scene, self.path).kind != self.off)

    def settings(self, scene: Scene) -> Changes:
        """Plain values of the part."""
        values: Any = plain(scene)
        for step in self.path.split("."):
            values = values[step]
        return dict(values)

    def take_out(self, scene: Scene) -> Changes:
        """Edit that takes the effect out of a scene."""
        del scene
        return {self.path: self.off}

    def bring_back(self, scene: Scene, settings: Changes | None) -> Changes:
        """Edit that brings the effect back into a scene, with earlier settings if there are any."""
        del scene
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
    Effect("beam", "the width of the horizontal beam; without it a knife edge", "sonar.beam", "knife", "fan"),
    Effect("pulse", "the length of the pulse; without it shorter than a bin", "sonar.pulse", "ideal", "tone"),
    Bending("bending", "rays bent where the sound speed varies; without it straight", "water", "uniform", "profile"),
    Effect("ghosts", "multipath by the sea surface", "water.surface", "none", "flat"),
    Effect("speckle", "interference of scatterers within a cell", "receiver.speckle", "none", "rayleigh"),
    Effect("noise", "noise received besides the echoes", "receiver.noise", "none", "ambient"),
    Effect("TVG", "time-varied gain; a record is shown relative to a level bed under the same gain", "receiver.tvg",
           "none", "power"),
)  # fmt: skip
