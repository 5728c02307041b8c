"""What returns the echo in one pixel: materials of the bed and targets, each by its path."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from insonify.explanation.names import PATH_NAMES
from insonify.explanation.pixel_parts import PixelParts
from insonify.tracers.echo_parts import HEARD, EchoParts
from insonify.tracers.labels import PATHS

Points = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Contribution:
    """What returns a part of the pixel's echo."""

    source: str  # ``pipe 1``, ``bed``, ``sea surface``
    material: str  # empty where there is none
    path: str  # of `insonify.tracers.labels.PATHS`
    target: int  # index of the declared target, -1 for what is none
    row: int  # of the material among those of the scene, -1 where there is none
    share: float  # of the mean echo in the pixel
    ground_range: float  # means weighted by the echo, m and degrees
    incidence: float
    parts: EchoParts  # of which it is made
    places: Points  # (n, 2, 3) where the sound goes: beginnings and ends of the parts, in local coordinates, m
    rays: tuple[Points, ...]  # the way of the sound to the loudest of them, and back where that is another one

    @property
    def words(self) -> str:
        """Source, material and path as they are read."""
        what = ", ".join(filter(None, (self.source, self.material)))
        if self.path == "direct":
            return what
        return PATH_NAMES[self.path] if self.path == "surface" else f"{PATH_NAMES[self.path]} ({what})"


def find_contributions(pixel: PixelParts) -> tuple[Contribution, ...]:
    """Find what returns the echo in a pixel."""
    heard = pixel.parts.take((pixel.parts.state == HEARD) & (pixel.parts.value > 0.0))
    if not heard.value.size:
        return ()
    keys, which = np.unique(np.column_stack([heard.path, heard.target, heard.material]), axis=0, return_inverse=True)
    total = float(heard.value.sum())
    found = [_contribution(pixel, heard.take(which.ravel() == k), total) for k in range(len(keys))]
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
