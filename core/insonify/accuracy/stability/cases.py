"""All cases, theme by theme."""

from __future__ import annotations

from insonify.accuracy.stability.case import StabilityCase
from insonify.accuracy.stability.themes import (
    arithmetic,
    beams,
    bed,
    bins,
    knots,
    rays,
    receiver,
    spectra,
    targets,
    water,
)

CASES: dict[str, tuple[StabilityCase, ...]] = {
    "Layered water": water.CASES,
    "Knots of a profile": knots.CASES,
    "Bent rays": rays.CASES,
    "Time bins": bins.CASES,
    "The bed": bed.CASES,
    "Targets": targets.CASES,
    "Beams": beams.CASES,
    "Made reliefs": spectra.CASES,
    "The receiver": receiver.CASES,
    "Arithmetic": arithmetic.CASES,
}
