"""Failures over relief: steps that are too long, a sonar above a knot, a wrong order of convergence."""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from insonify.accuracy.stability.case import Approach, StabilityCase, StabilityTheme
from insonify.accuracy.stability.drawing import RIGHT, WRONG, add_legend, add_panel
from insonify.accuracy.stability.level_scenes import make_level_scene, make_pose, prepare_over_heights
from insonify.acoustics.resolution_cell import bin_centres
from insonify.display.style import FAINT, INK
from insonify.kernels.common.types import Poses, SceneArrays
from insonify.scene import edit, load_scene
from insonify.simulation import Simulation, prepare
from insonify.statistics.record_errors import compare_records
from insonify.tracers import march, rays, sweep

Record = NDArray[np.float64]
FISH = 5.0  # m, height of the fish
STEP = 2.0
FINE = 20_000  # rays that tell where the shadows are
BORDER = 3  # bins next to a shadow's ends, of which a part is lit


@lru_cache(maxsize=1)
def _crests() -> Simulation:
    return prepare(load_scene("breaks-steps"))


@lru_cache(maxsize=1)
def _behind_crests() -> tuple[Record, Record, NDArray[np.bool_], float]:
    """Trace by long steps and by the sweep; tell where exact rays hear nothing, and what a level bed returns there."""
    arrays, fish = _crests().arrays, _crests().poses(np.zeros(1, dtype=np.int64))
    bare = prepare(edit(_crests().scene, {"seabed.relief": "flat"})).arrays
    long, ours = march.trace(arrays, fish, step=STEP, rays=4000)[0, 0], sweep.trace(arrays, fish)[0, 0]
    lit = rays.trace(arrays, fish, rays=FINE)[0, 0] > 0.0
    dark = ~np.convolve(lit, np.ones(2 * BORDER + 1), mode="same").astype(bool)
    dark &= bin_centres(arrays) > 2.0 * float(fish.z[0])
    without = float(sweep.trace(bare, fish)[0, 0][dark].sum())
    return long.astype(np.float64), ours.astype(np.float64), dark, without


def _leaked(record: Record) -> float:
    *_, dark, without = _behind_crests()
    return float(100.0 * record[dark].sum() / without)


def _draw_leak(figure: Figure) -> None:
    long, ours, dark, _ = _behind_crests()
    scene = add_panel(figure, 121, x="across (m)", y="height (m)", title=f"a step of {STEP:g} m passes a crest")
    across = np.linspace(0.0, 45.0, 1801)
    bed = _crests().ground.height_at(np.zeros(across.size), across)
    height = float(_crests().poses(np.zeros(1, dtype=np.int64)).z[0])
    top = int(np.argmax(np.where((across > 15.0) & (across < 25.0), bed, -np.inf)))
    scene.fill_between(across, bed, -1.5, color=FAINT, alpha=0.35, linewidth=0)
    looks = np.arange(0.0, 45.0, STEP)
    for below in np.arange(0.6, 0.0, -0.05):  # the deepest way through the crest on which no look falls into it
        slope = (bed[top] - below - height) / across[top]
        seen = looks[: int(np.argmin(height + slope * looks > np.interp(looks, across, bed))) + 1]
        if seen[-1] > across[top] + STEP:
            break
    scene.plot(seen, height + slope * seen, "o-", color=WRONG, markersize=3, linewidth=0.8)
    met = across[: int(np.argmin(height + slope * across > bed)) + 1]
    scene.plot(met, height + slope * met, color=RIGHT, linewidth=1.8)
    scene.set_ylim(-1.2, height + 0.5)
    record = add_panel(
        figure, 122, x="slant range (m)", y="energy per bin (dB)", title="and puts energy into the shadows"
    )
    r = bin_centres(_crests().arrays)
    with np.errstate(divide="ignore"):
        levels = [np.where(values > 0.0, 10.0 * np.log10(values), np.nan) for values in (long, ours)]
    record.fill_between(r, -130.0, -60.0, where=dark.tolist(), color=FAINT, alpha=0.18, linewidth=0, label="shadow")
    record.plot(r, levels[0], ".", color=WRONG, markersize=1.5, label="long steps")
    record.plot(r, levels[1], color=RIGHT, linewidth=1.0, label="segments, one horizon")
    record.set(xlim=(8.0, 50.0), ylim=(-115.0, -60.0))
    add_legend(record, "upper right")


def incidences(x: NDArray[np.float64], z: NDArray[np.float64], height: float) -> NDArray[np.float64]:
    """Cosines of incidence on a level bed, by the slope of each line of sight: x / x is lost straight down."""
    with np.errstate(invalid="ignore", divide="ignore"):
        slope = (z - height) / x
        return np.asarray(-slope * x / np.hypot(x, slope * x))


def _plain_knot() -> float:
    x = np.arange(0.0, 20.0, 0.1)
    return float(100.0 * np.mean(~np.isfinite(np.cumsum(incidences(x, np.zeros(x.size), FISH)))))


def _own_knot() -> float:
    """Percentage of bins without a number, with the fish over a node, over an edge and over a hole's rim."""
    heights = np.zeros((64, 64))
    heights[20:24, 20:24] = np.nan
    arrays = prepare_over_heights(make_level_scene(), heights, 0.5).arrays
    record = [sweep.trace(arrays, make_pose(x, y, 8.0, turn)) for x, y in ((15.0, 15.0), (15.25, 15.0), (9.5, 10.0))
              for turn in (0.0, 0.5 * math.pi, 0.25 * math.pi)]  # fmt: skip
    return float(100.0 * np.mean(~np.isfinite(record)))


@lru_cache(maxsize=1)
def _cells() -> tuple[Record, Record, Record]:
    """Spacings of ever finer samples of one smooth bed, and the errors of points and of the sweep on them."""
    spacings = np.array([0.8, 0.4, 0.2])
    fish = make_pose(0.0, 12.8, 8.0)
    finest = _smooth(0.025)
    right = sweep.trace(finest, fish)
    points, ours = [], []
    for spacing in spacings:
        arrays = _smooth(float(spacing))
        points.append(compare_records(finest, fish, _as_points(arrays, fish, float(spacing)), right).beyond)
        ours.append(compare_records(finest, fish, sweep.trace(arrays, fish), right).beyond)
    return spacings, np.array(points), np.array(ours)


def _smooth(spacing: float) -> SceneArrays:
    place = np.arange(0.0, 64.0 + 0.5 * spacing, spacing)
    waves = 0.15 * np.sin(2.0 * math.pi * place / 12.8)
    heights = np.add.outer(waves, waves)
    return prepare_over_heights(make_level_scene({"sonar.bins": 100}), heights, spacing, x0=-0.5 * 25.6).arrays


def _as_points(arrays: SceneArrays, fish: Poses, spacing: float) -> NDArray[np.float32]:
    """Let every sample of the bed echo as a point, with its own share of the area."""
    out = np.zeros((1, 2, arrays.bins), dtype=np.float32)
    bed, height = arrays.bed, float(fish.z[0])
    column = round((float(fish.x[0]) - bed.x0) / spacing)
    z = bed.heights[:, column].astype(np.float64)
    y = np.arange(z.size) * spacing + bed.y0 - float(fish.y[0])
    r = np.hypot(y, z - height)
    slope = np.gradient(z, spacing)
    cosine = (np.abs(y) * np.abs(slope) * np.sign(slope * y) + height - z) / r / np.sqrt(1.0 + slope**2)
    energy = np.maximum(cosine, 0.0) ** 2 / math.pi * np.sqrt(1.0 + slope**2) * spacing
    place = (r / arrays.bin_length).astype(np.int64)
    for side in range(2):
        mine = (place < arrays.bins) & ((y >= 0.0) if side == 0 else (y < 0.0))
        np.add.at(out[0, side], place[mine], energy[mine])
    return out * arrays.range_factor.astype(np.float32)


def _order_off(errors: Record, order: float) -> float:
    """By how many percent the order at which errors fall is off that of the method."""
    return float(100.0 * abs(np.polyfit(np.log(_cells()[0]), np.log(errors), 1)[0] / order - 1.0))


def _draw_orders(figure: Figure) -> None:
    spacings, points, ours = _cells()
    axes = add_panel(figure, x="spacing of samples (m)", y="error of the record")
    axes.set(xscale="log", yscale="log")
    axes.plot(spacings, points, "s-", color=WRONG, label="samples as points")
    axes.plot(spacings, ours, "D-", color=RIGHT, label="segments spread over the bins that they span")
    axes.plot(spacings, ours[0] * (spacings / spacings[0]) ** 2, "--", color=INK, linewidth=0.8, label="second order")
    add_legend(axes)


def _draw_knot(figure: Figure) -> None:
    """Bins lost as a fish passes over knots, of a walk that forms slopes over ground range and of the sweep."""
    off = np.linspace(-0.3, 0.3, 61)
    x = np.arange(-5.0, 20.0, 0.1)
    plain = []
    for place in off:
        ahead = x[x >= place - 1e-12] - round(place, 10)
        ahead = np.where(np.abs(ahead) < 1e-9, 0.0, ahead)
        plain.append(100.0 * np.mean(~np.isfinite(np.cumsum(incidences(ahead, np.zeros(ahead.size), FISH)))))
    arrays = prepare_over_heights(make_level_scene(), np.zeros((64, 64)), 0.1, x0=-3.2, y0=-3.2).arrays
    own = [100.0 * np.mean(~np.isfinite(sweep.trace(arrays, make_pose(0.0, y, FISH)))) for y in off]
    axes = add_panel(figure, x="fish across, knots every 0.1 m (m)", y="bins without a number (%)")
    axes.plot(off, plain, "o", color=WRONG, markersize=4, label="division by ground range")
    axes.plot(off, own, ".", color=RIGHT, markersize=4, label="walk that starts beneath the fish")
    axes.set_ylim(-6.0, 130.0)
    add_legend(axes, "upper right")


THEME = StabilityTheme("The bed", 5, (
    StabilityCase(
        "Steps too long",
        "A ray that is sampled every few metres steps over whatever is thinner.",
        "energy in shadows, over that of a level bed there", "%",
        Approach(f"Marches in steps of {STEP:g} m.", lambda: _leaked(_behind_crests()[0]), 5.0),
        Approach("Walks every segment of the bed once under a running horizon.",
                 lambda: _leaked(_behind_crests()[1]), 0.0),
        _draw_leak,
        "breaks-steps",
    ),
    StabilityCase(
        "A fish over a knot",
        "The line of sight straight down has the slope 0/0, and every later value of a running sum is lost.",
        "bins or knots without a number", "%",
        Approach("Divides by ground range from the fish on.", _plain_knot, 50.0),
        Approach("Starts beneath the fish without dividing by ground range.", _own_knot, 0.0),
        _draw_knot,
    ),
    StabilityCase(
        "A wrong order of convergence",
        "A method claims second order: halving its step should quarter its error.",
        "deviation of the observed order from 2", "%",
        Approach("Treats every sample of the bed as a point scatterer.", lambda: _order_off(_cells()[1], 2.0), 20.0),
        Approach("Spreads the energy of each segment over the bins that it spans.",
                 lambda: _order_off(_cells()[2], 2.0), 10.0),
        _draw_orders,
    ),
))  # fmt: skip
