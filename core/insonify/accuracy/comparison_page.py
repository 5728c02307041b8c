"""Page of two records side by side, with their statistics."""

from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from insonify.display.display_options import DisplayOptions
from insonify.display.page import caption_record
from insonify.display.picture import choose_contrast, colour_amplitudes
from insonify.display.sheet import gather_record_sheet
from insonify.display.style import BLUE, FAINT, INK, ORANGE, label_axes, make_figure, style_axes
from insonify.io.atomic import replacing
from insonify.statistics.record_statistics import AmplitudeSpectrum, RecordStatistics, measure_statistics

HUES = (BLUE, ORANGE)
WIDE, DPI = 12.5, 130  # inches
BORDER, GAP, GRAPHS = 0.6, 0.7, 2.4  # inches; the last is the height of the graphs
TALLEST = 9.0  # inches, of the pictures
GREATEST_POWER = 1e200  # of a logarithmic axis; its ticks overflow beyond


def write_comparison(
    path: str | Path, records: tuple[xr.Dataset, xr.Dataset]
) -> tuple[RecordStatistics, RecordStatistics]:
    """Measure the statistics of two records and write them side by side as PNG."""
    measured = measure_statistics(records[0]), measure_statistics(records[1])
    figure = draw_comparison(records, measured)
    with replacing(path) as beside:
        figure.savefig(beside, dpi=DPI)
    return measured


def draw_comparison(
    records: tuple[xr.Dataset, xr.Dataset], measured: tuple[RecordStatistics, RecordStatistics]
) -> Figure:
    """Draw two records on one page: pictures with one scale and palette, graphs of their statistics below."""
    look = DisplayOptions(palette="grey")
    sheets = [gather_record_sheet(record, look) for record in records]
    levels = choose_contrast(np.concatenate([sheet.amplitude.ravel() for sheet in sheets]))
    column = (WIDE - 2.0 * BORDER - GAP) / 2.0
    tall = min(max(column * (sheet.along or 1.0) / (2.0 * sheet.reach) for sheet in sheets), TALLEST)
    height = tall + GRAPHS + 2.5
    figure = make_figure(WIDE, height)
    for number, (record, sheet, found) in enumerate(zip(records, sheets, measured)):
        left, base = BORDER + number * (column + GAP), GRAPHS + 1.55
        axes = figure.add_axes((left / WIDE, base / height, column / WIDE, tall / height))
        pixels = colour_amplitudes(sheet.amplitude, look, levels)
        axes.imshow(pixels, extent=(-sheet.reach, sheet.reach, 0.0, sheet.along or 1.0), aspect="equal")
        axes.set_anchor("N")
        label_axes(axes, "slant range (m)", "along track (m)", size=9)
        axes.xaxis.set_major_formatter(lambda x, _: f"{abs(x):g}")
        style_axes(axes, 8, framed=True, width=0.6)
        caption, (middle, deep, slopes) = caption_record(record, sheet.along, DisplayOptions()), found.lines()
        title = caption.title if len(caption.title) <= 60 else f"{caption.title[:59]}…"
        for words, up, size, weight, colour in (
            (title, 0.66, 13.0, "bold", HUES[number]),
            (caption.line, 0.43, 8.5, "normal", FAINT),
            (f"{middle}  ·  {deep}", 0.24, 8.5, "normal", INK),
            (slopes, 0.08, 8.5, "normal", INK),
        ):
            place = left / WIDE, (base + tall + up) / height
            figure.text(*place, words, fontsize=size, fontweight=weight, color=colour, parse_math=False)
    _graphs(figure, height, measured)
    return figure


def _graphs(figure: Figure, height: float, measured: tuple[RecordStatistics, RecordStatistics]) -> None:
    """Draw the histograms of amplitude and variation, and the two spectra."""
    wide = (WIDE - 2.0 * BORDER - 3.0 * GAP) / 4.0
    amplitudes, variations, along, across = (
        figure.add_axes(((BORDER + n * (wide + GAP)) / WIDE, 0.6 / height, wide / WIDE, GRAPHS / height))
        for n in range(4)
    )
    _named(amplitudes, "Even patches: amplitudes", "amplitude over its mean")
    _named(variations, "Even patches: variation", "variation of amplitude")
    _named(along, "Spectrum along track (m)", "cycles per metre")
    _named(across, "Spectrum across (m)", "cycles per metre of slant range")
    a, v = np.linspace(0.0, 3.5, 71), np.linspace(0.0, 1.0, 51)
    for found, hue in zip(measured, HUES):
        amplitudes.stairs(*np.histogram(found.amplitude, a, density=True), color=hue, linewidth=1.4)
        variations.stairs(*np.histogram(found.variation, v, density=True), color=hue, linewidth=1.4)
        _curve(along, found.along, hue)
        _curve(across, found.across, hue)
    # Fully developed speckle: the envelope is Rayleigh distributed about its mean.
    faint: dict[str, Any] = {"color": FAINT, "linewidth": 0.9, "linestyle": "--", "label": "speckle"}
    amplitudes.plot(a, 0.5 * np.pi * a * np.exp(-0.25 * np.pi * a**2), **faint)
    variations.axvline(np.sqrt(4.0 / np.pi - 1.0), **faint)
    for axes in (amplitudes, variations):
        axes.legend(frameon=False, fontsize=8, labelcolor=FAINT)
        axes.set_ylim(bottom=0.0)
        axes.margins(x=0.0)


def _named(axes: Any, title: str, label: str) -> None:
    axes.set_title(title, fontsize=9.5, color=INK, loc="left")
    label_axes(axes, label, size=9)
    style_axes(axes, 8, framed=True, width=0.6)


def _curve(axes: Any, spectrum: AmplitudeSpectrum, hue: str) -> None:
    shown = (np.where((part > 1.0 / GREATEST_POWER) & (part < GREATEST_POWER), part, np.nan) for part in spectrum)
    axes.loglog(*shown, color=hue, linewidth=1.4)
    axes.grid(True, which="both", color=FAINT, alpha=0.15, linewidth=0.6)
