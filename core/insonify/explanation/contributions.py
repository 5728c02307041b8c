"""Sources of the echo in one pixel, obstructions that hide bed there, and a sentence about both."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from insonify.explanation.names import PATH_NAMES
from insonify.explanation.pixel_parts import PixelParts, whole_window
from insonify.kernels.labels.bed_stretches import BEHIND_BED, VISIBLE
from insonify.tracers.azimuth_fan import lay_planes_of_images
from insonify.tracers.echo_parts import EchoParts, find_direct_parts, take_central_plane
from insonify.tracers.labels import PATHS

Points = NDArray[np.float64]
SHADOW = 0.5  # share of the echo that is hidden from which a pixel counts as shadow
SPREAD = 0.95  # share of the first source below which the second is named too


@dataclass(frozen=True, eq=False)
class Contribution:
    """Source of a part of the pixel's echo."""

    source: str  # ``pipe 1``, ``bed``, ``sea surface``
    material: str  # empty where there is none
    path: str  # of `insonify.tracers.labels.PATHS`
    target: int  # index of the declared target, -1 for the bed and the sea surface
    row: int  # index among the materials of the scene, -1 without a material
    share: float  # of the mean echo in the pixel
    ground_range: float  # means weighted by the echo, m and degrees
    incidence: float
    parts: EchoParts  # of which it is made
    places: Points  # (n, 2, 3) beginnings and ends of the parts, in local coordinates, m
    rays: tuple[Points, ...]  # path of the sound to the loudest parts, and the way back where it differs

    @property
    def words(self) -> str:
        """Source, material and path in words."""
        what = ", ".join(filter(None, (self.source, self.material)))
        if self.path == "direct":
            return what
        return PATH_NAMES[self.path] if self.path == "surface" else f"{PATH_NAMES[self.path]} ({what})"


def find_contributions(pixel: PixelParts) -> tuple[Contribution, ...]:
    """Find the sources of the echo in a pixel, the greatest first."""
    echoing = pixel.parts.take((pixel.parts.state == VISIBLE) & (pixel.parts.value > 0.0))
    if not echoing.value.size:
        return ()
    kinds = np.column_stack([echoing.path, echoing.target, echoing.material])
    keys, which = np.unique(kinds, axis=0, return_inverse=True)
    total = float(echoing.value.sum())
    found = [_contribution(pixel, echoing.take(which.ravel() == k), total) for k in range(len(keys))]
    return tuple(sorted(found, key=lambda each: -each.share))


def _contribution(pixel: PixelParts, parts: EchoParts, total: float) -> Contribution:
    path, target, row = int(parts.path[0]), int(parts.target[0]), int(parts.material[0])
    cosine = float(np.average(parts.cosine, weights=parts.value))
    return Contribution(
        source=pixel.name(target, path),
        material=pixel.material(row),
        path=PATHS[path],
        target=target,
        row=row,
        share=float(parts.value.sum()) / total,
        ground_range=float(np.average(parts.middle[:, 0], weights=parts.value)),
        incidence=math.degrees(math.acos(min(max(cosine, -1.0), 1.0))),
        parts=parts,
        places=pixel.segments(parts),
        rays=pixel.rays(parts),
    )


@dataclass(frozen=True, eq=False)
class Obstruction:
    """Target or crest that hides a part of the bed from the pixel."""

    hider: str  # ``pipe 1``, or ``crest of the bed``
    target: int  # index of the declared target, -1 for the bed
    place: Points  # (3,) crest of the bed, or middle of the bed that a target hides, in local coordinates, m
    ground_range: float  # of that place, m
    share: float  # of the echo that the pixel would have without obstructions
    echo: float  # mean echo that the hidden bed would add, in the units of the parts
    places: Points  # (n, 2, 3) the hidden bed
    rays: tuple[Points, ...]  # from the sonar to the hidden bed, through the obstruction

    @property
    def faces_away(self) -> bool:
        """Whether the hidden bed is a slope that faces away from the sonar and would return nothing anyway."""
        return not self.echo > 0.0


def find_obstructions(pixel: PixelParts) -> tuple[Obstruction, ...]:
    """Find the obstructions that hide bed from a pixel, the greatest first."""
    parts = pixel.parts
    hidden = parts.take(parts.state != VISIBLE)
    whole = float(parts.value.sum())
    hiders = np.where(hidden.state == BEHIND_BED, -1, hidden.hider)
    found = [_obstruction(pixel, hidden.take(hiders == who), int(who), whole) for who in np.unique(hiders)]
    return tuple(sorted(found, key=lambda each: -each.share))


def _obstruction(pixel: PixelParts, parts: EchoParts, who: int, whole: float) -> Obstruction:
    echo = float(parts.value.sum())
    loudest = int(np.argmax(parts.value))
    place = parts.crest[loudest] if who < 0 else parts.middle[loudest]
    return Obstruction(
        hider=pixel.name(who) if who >= 0 else "crest of the bed",
        target=who,
        place=pixel.sonar.to_world(float(parts.azimuth[loudest]), place[None])[0],
        ground_range=float(place[0]),
        share=echo / whole if whole > 0.0 else 0.0,
        echo=echo,
        places=pixel.segments(parts),
        rays=pixel.rays(parts),
    )


def summarise_pixel(
    pixel: PixelParts, contributions: Sequence[Contribution], obstructions: Sequence[Obstruction]
) -> str:
    """Describe in one sentence what a pixel shows, or why it is dark."""
    hiding = sum(each.share for each in obstructions)
    if obstructions and (hiding >= SHADOW or not contributions):
        return _shadow(obstructions[0], bool(contributions))
    if not contributions:
        return _silence(pixel)
    first = contributions[0]
    sentence = f"{first.words} at {first.ground_range:.1f} m, incidence {first.incidence:.0f}°"
    if first.share < SPREAD:
        sentence = f"{100 * first.share:.0f} % {sentence}; then {contributions[1].words}"
    return sentence


def _shadow(greatest: Obstruction, echoing: bool) -> str:
    """Sentence that names the greatest obstruction."""
    if greatest.faces_away:
        return f"no echo: the slope behind the crest at {greatest.ground_range:.1f} m faces away from the sonar"
    mostly = "mostly in the shadow" if echoing else "in the shadow"
    if greatest.target >= 0:
        return f"{mostly} of {greatest.hider}, which hides the bed at {greatest.ground_range:.1f} m"
    return f"{mostly} of a crest of the bed at {greatest.ground_range:.1f} m"


def _silence(pixel: PixelParts) -> str:
    """Sentence that explains a pixel without an echo where nothing is hidden."""
    if pixel.folded:
        return "no echo: no ray lands there"
    echoing = athwart_parts(pixel)
    first = float(echoing.near.min(initial=math.inf))
    if pixel.window.far <= first:
        return f"water column: the first echo comes from {first:.1f} m" if math.isfinite(first) else "no bed in range"
    if pixel.parts.value.size == 0:
        return "no echo: no bed there"
    return "no echo: outside the beam" if not np.any(pixel.parts.weight > 0.0) else "no echo: the slope faces away"


def athwart_parts(pixel: PixelParts) -> EchoParts:
    """Parts that echo in any bin, in the plane along the axis of the beam."""
    fans = lay_planes_of_images(pixel.arrays, pixel.pose, 1)
    if not fans:
        return pixel.parts.take(np.zeros(0, np.int64))
    fan = take_central_plane(pixel.arrays, fans[0][1])
    window = whole_window(pixel.arrays)
    parts = find_direct_parts(pixel.arrays, pixel.pose, pixel.side, window, fan)
    return parts.take(parts.state == VISIBLE)
