"""Failures of range bins: sums that do not cancel, areas without a bound, logarithms of zero."""

from __future__ import annotations

import math
from functools import lru_cache
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from insonify.accuracy.stability.case import Approach, StabilityCase, StabilityTheme
from insonify.accuracy.stability.drawing import RIGHT, WRONG, add_legend, add_panel, write_table
from insonify.accuracy.stability.level_scenes import make_level_scene, make_pose
from insonify.acoustics.flat_bed import flat_bed_curve
from insonify.acoustics.resolution_cell import bin_centres
from insonify.display.normalisation import LevelBed, normalise
from insonify.display.picture import choose_contrast, colour_amplitudes
from insonify.display.style import FAINT, INK
from insonify.scene import edit, load_scene
from insonify.simulation import prepare, simulate
from insonify.tracers import sweep

Curve = NDArray[np.float64]
HEIGHT, BINS, BIN = 5.0, 3000, 0.05
WALL = {"kind": "sphere", "position": [0.0, 40.0], "radius": 3.0}


def summed_in_single_precision(edges: Curve, density: Curve) -> Curve:
    """Add up in float32 the steps of a density at the edges of its pieces."""
    steps = np.zeros(BINS + 1, dtype=np.float32)
    place = np.minimum((edges / BIN).astype(np.int64), BINS)
    np.add.at(steps, place[:-1], density.astype(np.float32))
    np.add.at(steps, place[1:], -density.astype(np.float32))
    return np.cumsum(steps[:BINS], dtype=np.float32).astype(np.float64)


@lru_cache(maxsize=1)
def _long_range() -> tuple[Curve, Curve, Curve, Curve]:
    """Slant range, the exact record of a level bed, that of the single sum, and the sweep's own."""
    arrays = prepare(load_scene("breaks-sums")).arrays
    x = np.arange(0.0, BINS * BIN, 0.1)
    edges = np.hypot(x, HEIGHT)
    middle, length = 0.5 * (edges[1:] + edges[:-1]), np.diff(edges)
    energy = (HEIGHT / middle) ** 2 / math.pi * np.diff(x) / length * BIN  # Lambert, over the bins it spans
    edges[x > 135.0] = BINS * BIN  # the bed ends there
    energy[x[1:] > 135.0] = 0.0
    exact = flat_bed_curve(arrays, HEIGHT)
    single = summed_in_single_precision(edges, energy * middle**-4.0)
    ours = sweep.trace(arrays, make_pose(0.0, 0.0, HEIGHT))[0, 0].astype(np.float64)
    return bin_centres(arrays), exact, single, ours


def _worst_far(record: Curve) -> float:
    exact = _long_range()[1]
    far = slice(2200, int(134.0 / BIN))
    return float(100.0 * np.abs(record[far] / exact[far] - 1.0).max())


def _draw_sums(figure: Figure) -> None:
    r, exact, single, ours = _long_range()
    axes = add_panel(figure, x="slant range (m)", y="energy per bin")
    axes.set_yscale("log")
    some = slice(110, None, 5)
    axes.plot(r[some], np.abs(single[some]), ".", color=WRONG, markersize=2.5, label="factors inside a float32 sum")
    axes.plot(r[some], ours[some], color=RIGHT, linewidth=2.0, label="factors after an exact sum")
    axes.plot(r[some], exact[some], color=INK, linewidth=0.8, linestyle="--", label="closed form")
    add_legend(axes)


@lru_cache(maxsize=1)
def _behind_a_ball() -> tuple[Curve, Curve, slice]:
    """Level bed with a ball before it: a single sum, the sweep, and the bins that lie in shadow."""
    scene = make_level_scene({"targets": [WALL], "sonar.range": 100.0, "sonar.bins": 2000, "sonar.ping_rate": 5.0})
    arrays = prepare(scene).arrays
    d, phi = math.hypot(40.0, 7.0), math.atan2(7.0, 40.0)
    alpha = math.asin(3.0 / d)
    begins, ends = 10.0 / math.sin(phi + alpha), 10.0 / math.sin(max(phi - alpha, 1e-9))
    x = np.arange(0.0, 99.0, 0.1)
    edges = np.hypot(x, 10.0)
    middle = 0.5 * (edges[1:] + edges[:-1])
    energy = (10.0 / middle) ** 2 / math.pi * np.diff(x) / np.diff(edges)
    energy[(middle > begins) & (middle < ends)] = 0.0
    single = summed_in_single_precision(edges, energy)
    ours = sweep.trace(arrays, make_pose(0.0, 0.0, 10.0))[0, 0].astype(np.float64)
    return single, ours, slice(math.ceil(begins / BIN) + 3, min(math.floor(ends / BIN) - 3, 2000))


def _lit(record: Curve) -> float:
    """Share of the shadow's bins that are not exactly silent."""
    return float(100.0 * np.mean(record[_behind_a_ball()[2]] != 0.0))


def cell_area(r: float, height: float, width: float, length: float) -> float:
    """Area of the textbook's cell, φ r · cτ / (2 cos θ)."""
    cosine = math.sqrt(max(1.0 - (height / r) ** 2, 0.0))
    return width * r * length / cosine if cosine > 0.0 else math.inf


@lru_cache(maxsize=1)
def _first_return() -> tuple[float, float, float]:
    """Energy of the first bin with an echo of the bed: by the textbook's cell, by the sweep, and in closed form."""
    scene = make_level_scene({"sonar.beam": {"kind": "fan", "width": 1.0}})
    arrays = prepare(scene).arrays
    first = round(10.0 / arrays.bin_length)
    ours = sweep.trace(arrays, make_pose(0.05, 0.02, 10.0), planes=32)[0, 0]
    textbook = cell_area(10.0, 10.0, math.radians(1.0), arrays.bin_length) / math.pi * 10.0**-4.0
    return textbook, float(ours[first]), float(flat_bed_curve(arrays, 10.0)[first])


def _decibels_off(value: float) -> float:
    return abs(10.0 * math.log10(value / _first_return()[2]))


def _draw_nadir(figure: Figure) -> None:
    scene = make_level_scene({"sonar.beam": {"kind": "fan", "width": 1.0}, "sonar.range": 14.0, "sonar.bins": 1400})
    arrays = prepare(scene).arrays
    ours = sweep.trace(arrays, make_pose(0.05, 0.02, 10.0), planes=32)[0, 0]
    edges = np.arange(1000, 1101) * arrays.bin_length
    near = 10.0 + np.geomspace(1e-6, 1.0, 400)
    area = [cell_area(r, 10.0, math.radians(1.0), arrays.bin_length) for r in near]
    book = np.array(area) * (10.0 / near) ** 2 / math.pi * near**-4.0
    axes = add_panel(figure, x="slant range (m)", y="energy per bin (dB)")
    axes.plot(near, 10.0 * np.log10(book), color=WRONG, label="cell φ r cτ / (2 cos θ): infinite at 10 m")
    axes.step(edges, 10.0 * np.log10(ours[1000:1101]), color=RIGHT, where="post", label="energy of each bin")
    axes.axvline(10.0, color=FAINT, linewidth=0.8, linestyle=":")
    add_legend(axes)


def gained(record: Curve, bin_length: float) -> Curve:
    """Gain 30 log r at the near edges of the bins, the first of which is at zero."""
    with np.errstate(divide="ignore", invalid="ignore"):
        decibels = 10.0 * np.log10(record) + 30.0 * np.log10(np.arange(record.size) * bin_length)
    return np.asarray(decibels)


def _share_without_a_number(values: NDArray[np.floating]) -> float:
    return float(100.0 * np.mean(~np.isfinite(values)))


def _plain_gain() -> float:
    record = simulate(make_level_scene()).intensity.values[0, 0].astype(np.float64)
    return _share_without_a_number(gained(record, 0.05))


def _own_gain() -> float:
    noise = {"kind": "ambient", "level": 40.0}
    scene = make_level_scene({"receiver.tvg": "power", "receiver.source_level": 220.0, "receiver.noise": noise})
    return _share_without_a_number(simulate(scene).intensity.values)


EMPTY: tuple[dict[str, Any], ...] = (
    {"sonar.range": 5.0, "sonar.bins": 50},  # ends before the bed begins
    {"sonar.range": 5.0, "sonar.bins": 1},
    {"sonar.bins": 1},
    {"track.pings": 1, "targets": []},
)


def brightness(record: NDArray[np.floating]) -> NDArray[np.floating]:
    """Decibels below the strongest echo, as a first display has them."""
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.asarray(10.0 * np.log10(record / record.max()))


def _plain_display() -> float:
    return float(sum(_share_without_a_number(brightness(_intensity(changes))) > 0.0 for changes in EMPTY))


def _own_display() -> float:
    wrong = 0
    for changes in EMPTY:
        intensity = _intensity(changes)[:, 0]
        simulation = prepare(edit(make_level_scene(), changes))
        amplitude = normalise(intensity, LevelBed(simulation).curves(np.zeros(1, dtype=np.int64))[0])
        shown = colour_amplitudes(amplitude, levels=choose_contrast(amplitude))
        wrong += not (np.isfinite(amplitude).all() and shown.shape[:2] == amplitude.shape)
    return float(wrong)


def _intensity(changes: dict[str, Any]) -> NDArray[np.float32]:
    return np.asarray(simulate(edit(make_level_scene(), changes)).intensity.values)


def _draw_silence(figure: Figure) -> None:
    single, ours, dark = _behind_a_ball()
    shown = slice(max(dark.start - 120, 0), min(dark.start + 480, dark.stop))
    r = (np.arange(single.size)[shown] + 0.5) * BIN
    axes = add_panel(figure, x="slant range (m)", y="energy over the maximum")
    axes.set_yscale("symlog", linthresh=1e-7)
    axes.set_yticks([-1e-3, -1e-5, -1e-7, 0.0, 1e-7, 1e-5, 1e-3, 1e-1])
    for record, colour, words in ((single, WRONG, "float32 steps"), (ours, RIGHT, "integers")):
        axes.plot(r, record[shown] / record[: dark.start].max(), color=colour, linewidth=1.2, label=words)
    axes.axvspan(dark.start * BIN, float(r[-1]), color=FAINT, alpha=0.12, linewidth=0)
    add_legend(axes, "upper right")


def _draw_zero(figure: Figure) -> None:
    record = simulate(make_level_scene()).intensity.values[0, 0].astype(np.float64)
    level, r = gained(record, 0.05), np.arange(record.size) * 0.05
    lost = ~np.isfinite(level)
    axes = add_panel(figure, x="slant range (m)", y="level (dB)")
    axes.plot(r, np.where(lost, np.nan, level), color=FAINT, label="with 30 log r added")
    low = np.nanmin(level[~lost]) - 5.0
    axes.plot(r[lost], np.full(lost.sum(), low), "|", color=WRONG, markersize=7, label="no number, in decibels")
    axes.plot([0.025], [low - 6.0], "|", color=RIGHT, label="no number, in linear intensities: none")
    axes.set_ylim(low - 4.0, np.nanmax(level[~lost]) + 3.0)
    add_legend(axes)


def _draw_empty(figure: Figure) -> None:
    rows = []
    for changes in EMPTY:
        intensity = _intensity(changes)
        lost = _share_without_a_number(brightness(intensity))
        asked = ", ".join(f"{path.partition('.')[2] or path} = {value}" for path, value in changes.items())
        lit = int((intensity > 0.0).sum())
        rows.append(
            (asked, f"{lost:.0f} % without a number", f"{lit} of {intensity.size} bins with an echo, the others dark")
        )
    write_table(figure, ("scene", "brightest echo at 0 dB", "relative to a level bed"), rows)


THEME = StabilityTheme("Range bins", 4, (
    StabilityCase(
        "Range factors inside a float32 sum",
        "A float32 prefix sum includes spreading by r⁻⁴, so that far bins are smaller than the rounding errors of "
        "near ones.",
        "worst error beyond 110 m", "%",
        Approach("Sums energies times r⁻⁴ in float32.", lambda: _worst_far(_long_range()[2]), 100.0),
        Approach("Sums energies as integers and applies range factors after the sum.",
            lambda: _worst_far(_long_range()[3]), 0.5),
        _draw_sums,
        "breaks-sums",
    ),
    StabilityCase(
        "Shadows that are not silent",
        "Floating-point steps that should cancel leave a remainder, so that shadows are bright or negative.",
        "bins of a shadow that are not zero", "%",
        Approach("Sums float32 steps up and down.", lambda: _lit(_behind_a_ball()[0]), 50.0),
        Approach("Sums integers, which cancel exactly.", lambda: _lit(_behind_a_ball()[1]), 0.0),
        _draw_silence,
    ),
    StabilityCase(
        "Nadir",
        "The cell length cτ/(2 cos θ) is infinite at normal incidence.",
        "error of the first return's energy", "dB",
        Approach("Uses the textbook's cell area at the first return.", lambda: _decibels_off(_first_return()[0]), 60.0),
        Approach("Spreads each segment of the bed over the bins that it spans.",
                 lambda: _decibels_off(_first_return()[1]), 0.1),
        _draw_nadir,
    ),
    StabilityCase(
        "Range zero",
        "The first bin begins at slant range 0; neither 0 nor a silent bin has a logarithm.",
        "bins without a number", "%",
        Approach("Adds 30 log r to decibels at the near edge of each bin.", _plain_gain, 10.0),
        Approach("Keeps linear intensities and takes ranges at bin centres.", _own_gain, 0.0),
        _draw_zero,
    ),
    StabilityCase(
        "An empty record",
        "A record of one bin or ping, or one that ends before the bed begins, has no maximum to normalise by.",
        "such records shown wrongly", "of 4",
        Approach("Divides by the loudest echo and takes logarithms.", _plain_display, 2.0),
        Approach("Shows amplitudes relative to a level bed, dark where there is no bed.", _own_display, 0.0),
        _draw_empty,
    ),
))  # fmt: skip
