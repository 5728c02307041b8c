"""Words of an explanation: names of paths, targets and materials, and why a pixel is bright or dark."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from insonify.explanation.pixel import PixelExplanation
    from insonify.scene import Scene
    from insonify.terrain import AnyGround

# Least level in dB over a level bed at the same range, and the word for it.
TONES = ((6.0, "Very bright"), (2.0, "Bright"), (-2.0, "As bright as a level bed"), (-8.0, "Dim"), (-math.inf, "Dark"))
# Least angle of incidence in degrees, and the words for it.
ANGLES = ((75.0, ", almost grazing"), (60.0, ", at a low angle"), (30.0, ""), (0.0, ", almost head-on"))
PATH_NAMES = {
    "direct": "direct",
    "surface_bottom": "ghost by surface and bottom",
    "surface_bottom_surface": "ghost by surface, bottom and surface",
    "second_bottom": "second bottom echo",
    "surface": "echo of the sea surface",
    "crosstalk": "crosstalk from the other side",
}


def describe_brightness(explanation: PixelExplanation, amplitude: float | None) -> str:
    """Sentence on why a pixel is bright or dark, given its amplitude over that of a level bed, if known."""
    level = 20.0 * math.log10(amplitude) if amplitude else -math.inf
    tone = next(word for least, word in TONES if level >= least)
    hiders, echoes = explanation.obstructions, explanation.contributions
    if hiders and (not echoes or sum(each.share for each in hiders) >= 0.5):
        hider = hiders[0]
        if hider.faces_away:
            return f"Dark because the slope behind the crest at {hider.ground_range:.1f} m faces away from the sonar."
        name = f"a {hider.hider}" if hider.target < 0 else hider.hider
        return f"{tone} because the bed here lies in the shadow of {name}."
    if not echoes:
        return f"Dark because nothing here returns the sound ({explanation.summary})."
    first = echoes[0]
    if first.path != "direct":
        return f"{tone}: {first.words} arrives here, later than the direct one."
    what = first.material if first.source == "bed" or not first.material else f"the {first.material} of {first.source}"
    met = f"the sound meets {what or first.source} at {first.incidence:.0f}°"
    met += next(words for least, words in ANGLES if first.incidence >= least)
    causes = first.incidence >= 60.0 if level < -2.0 else level >= 2.0 and (first.target >= 0 or first.incidence < 45.0)
    return f"{tone} because {met}." if causes else f"{tone}: {met}."


def name_part(parts: tuple[object, ...], index: int) -> str:
    """Name a target or a volume by its kind and its number from 1: ``pipe 1``."""
    kind = str(getattr(parts[index], "kind", "target")).replace("_", " ")
    return f"{kind} {index + 1}"


def name_materials(scene: Scene, ground: AnyGround) -> tuple[str, ...]:
    """Names of the materials by their rows: those of the bed, then those of the targets."""
    names = (*ground.names, *(target.material.name for target in scene.targets))
    return tuple(name.replace("_", " ") for name in names)
