"""All cases, theme by theme."""

from __future__ import annotations

from insonify.accuracy.stability import beams, bed, bins, knots, numbers, rays, receiver, spectra, targets, water
from insonify.accuracy.stability.case import Case

CASES: dict[str, tuple[Case, ...]] = {
    "Layered water": water.CASES,
    "Knots of a profile": knots.CASES,
    "Bent rays": rays.CASES,
    "Time bins": bins.CASES,
    "The bed": bed.CASES,
    "Targets": targets.CASES,
    "Beams": beams.CASES,
    "Made reliefs": spectra.CASES,
    "The receiver": receiver.CASES,
    "Arithmetic": numbers.CASES,
}
