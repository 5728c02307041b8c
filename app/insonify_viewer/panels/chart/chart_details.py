"""A chart as its window shows it: one picture with points to pick, and what lies behind a point."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from insonify_viewer.quantities import span

if TYPE_CHECKING:
    from insonify.accuracy.charts.kinds.accuracy import AccuracyChart
    from insonify.accuracy.charts.measurement import AccuracyRow

DPI = 150.0


class Point(NamedTuple):
    """Where a row is drawn: shares of the picture's width from the left and of its height from the top."""

    x: float
    y: float
    row: AccuracyRow


@dataclass(frozen=True, eq=False)
class Pictured:
    """A chart drawn.

    Attributes
    ----------
    chart : AccuracyChart
        What was drawn.
    pixels : (height, width, 4) uint8
        Red, green, blue, opacity.
    points : tuple of Point
        What can be picked.
    """

    chart: AccuracyChart
    pixels: NDArray[np.uint8]
    points: tuple[Point, ...]


def picture(chart: AccuracyChart) -> Pictured:
    """Draw a chart as it is saved."""
    # lazy: the window is there before Matplotlib is
    from insonify.accuracy.charts.accuracy_figure import draw_accuracy

    figure, marks = draw_accuracy(chart)
    figure.set_dpi(DPI)
    figure.canvas.draw()
    pixels = np.array(figure.canvas.buffer_rgba())  # type: ignore[attr-defined]
    height, width = pixels.shape[:2]
    points = [
        Point(x / width, 1.0 - y / height, row)
        for line, rows in marks.items()
        for (x, y), row in zip(line.get_transform().transform(line.get_xydata()), rows)
    ]
    return Pictured(chart, pixels, tuple(points))


def nearest(points: tuple[Point, ...], x: float, y: float, shape: float, within: float) -> AccuracyRow | None:
    """Pick the row nearest to a place.

    Parameters
    ----------
    points : tuple of Point
        What can be picked.
    x, y : float
        Place, in shares of the width and the height.
    shape : float
        Height of the picture over its width.
    within : float
        Greatest distance, as a share of the width.
    """
    distances = [math.hypot(point.x - x, shape * (point.y - y)) for point in points]
    best = min(range(len(points)), key=distances.__getitem__, default=None)
    return points[best].row if best is not None and distances[best] <= within else None


@dataclass(frozen=True, eq=False)
class Judged:
    """A row's record beside its reference.

    Attributes
    ----------
    row : Row
        Of the chart.
    record, reference : (pings, 2 bins) float32
        Amplitudes over those of a level bed, from far port over nadir to far starboard, newest ping first.
    rays : int
        Per side, of the reference.
    similarity : float
        SSIM of the two as pictures.
    reach : float
        Slant range of the last bin, in metres.
    """

    row: AccuracyRow
    record: NDArray[np.float32]
    reference: NDArray[np.float32]
    rays: int
    similarity: float
    reach: float


def judge(chart: AccuracyChart, row: AccuracyRow) -> Judged:
    """Lay a row's record beside its reference."""
    # lazy: the window is there before Matplotlib is
    from insonify.accuracy.similarity import measure_similarity

    record, reference = chart.normalise_row(row)
    scene = chart.scenes[row.targets]
    reach = scene.arrays.bins * scene.arrays.bin_length
    return Judged(
        row,
        _laid(record),
        _laid(reference),
        scene.reference_of(row.method).rays,
        measure_similarity(record, reference),
        reach,
    )


def in_numbers(judged: Judged) -> str:
    """Say how good a row is and what it takes."""
    row, errors, moved = judged.row, judged.row.errors, judged.row.displacement
    parts = (
        f"{span(1e-6 * row.microseconds)} a ping (± {100.0 * row.spread:.2g} %)",
        f"rms {_percent(errors.beyond)} beyond 1.4 altitudes, {_percent(errors.all_bins)} of all bins",
        f"SSIM {judged.similarity:.3f}",
        _metres("shadow edges off by", moved.shadow_edge),
        _metres("echoes off by", moved.echo),
        f"{moved.lost} echo{'es' * (moved.lost > 1)} lost" if moved.lost else "",
        f"energy {100.0 * errors.energy_bias:+.2g} %",
        f"{_percent(errors.dark_leakage)} leaked into the dark",
    )
    return " · ".join(part for part in parts if part)


def _laid(sides: NDArray[np.float32]) -> NDArray[np.float32]:
    return np.concatenate([sides[::-1, 0, ::-1], sides[::-1, 1]], axis=1)


def _percent(share: float) -> str:
    return f"{100.0 * share:.2g} %"


def _metres(what: str, metres: float) -> str:
    return f"{what} {metres:.2g} m" if math.isfinite(metres) else ""
