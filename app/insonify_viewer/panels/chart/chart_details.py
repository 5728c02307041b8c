"""The record behind each point of a chart."""

import math
from dataclasses import dataclass

import numpy as np

from insonify.arrays import Singles
from insonify_viewer.core_types import AccuracyChart, AccuracyRow
from insonify_viewer.state.quantities import format_duration

FLOOR, CEILING = 1e-5, 10.0  # errors beyond these are drawn there


def place_of_row(row: AccuracyRow) -> tuple[float, float]:
    """Logarithms of time in µs and error, by which a row is drawn."""
    return math.log10(row.microseconds), math.log10(min(max(row.errors.beyond, FLOOR), CEILING))


@dataclass(frozen=True, eq=False)
class RowDetails:
    """The record of a row beside its reference."""

    row: AccuracyRow  # row of the chart
    # (pings, 2 bins) amplitudes over those of a level bed, from far port over nadir to far starboard, newest ping
    # first.
    record: Singles
    reference: Singles
    rays: int  # rays per side of the reference
    similarity: float  # SSIM of the two as pictures
    reach: float  # slant range of the last bin, in metres


def row_details(chart: AccuracyChart, row: AccuracyRow) -> RowDetails:
    """Trace the record of a row and its reference, and compare them."""
    # lazy: the window opens before Matplotlib is loaded
    from insonify.statistics.record_errors import measure_similarity

    record, reference = chart.normalise_row(row)
    scene = chart.scenes[row.targets]
    reach = scene.arrays.bins * scene.arrays.bin_length
    return RowDetails(
        row,
        _laid(record),
        _laid(reference),
        scene.reference_of(row.method).rays,
        measure_similarity(record, reference),
        reach,
    )


def details_in_words(details: RowDetails) -> str:
    """Write the cost and the errors of a row."""
    row, errors, moved = details.row, details.row.errors, details.row.displacement
    parts = (
        f"{format_duration(1e-6 * row.microseconds)} a ping (± {100.0 * row.spread:.2g} %)",
        f"error {_percent(errors.beyond)} beyond 1.4 altitudes, {_percent(errors.all_bins)} at all ranges (rms)",
        f"likeness {details.similarity:.3f} (SSIM, 1 is equal)",
        _metres("shadow edges off by", moved.shadow_edge),
        _metres("echoes off by", moved.echo),
        f"{moved.lost} echo{'es' * (moved.lost > 1)} lost" if moved.lost else "",
        f"energy {100.0 * errors.energy_bias:+.2g} %",
        f"{_percent(errors.dark_leakage)} of the energy lies in shadows",
    )
    return " · ".join(part for part in parts if part)


def _laid(sides: Singles) -> Singles:
    return np.concatenate([sides[::-1, 0, ::-1], sides[::-1, 1]], axis=1)


def _percent(share: float) -> str:
    return f"{100.0 * share:.2g} %"


def _metres(what: str, metres: float) -> str:
    return f"{what} {metres:.2g} m" if math.isfinite(metres) else ""
