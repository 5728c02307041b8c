"""Failures over relief: steps that are too long, a fish over a knot, orders that are not what they are said to be."""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from insonify.accuracy import compare
from insonify.kernels.types import Poses, Problem
from insonify.sound.cell import bin_centres
from insonify.stability.case import Case, Way
from insonify.stability.drawing import FAINT, INK, RIGHT, WRONG, named, panel
from insonify.stability.scenery import level_scene, over, pose
from insonify.tracers import march, sweep

Record = NDArray[np.float64]
CREST, RIDGE, TOP, FISH = 20.0, 3.0, 0.5, 5.0  # m: where a ridge stands, how high and wide it is, how high the fish
STEP = 2.0
SHADOW = (23.0, 36.0)  # m across, behind the ridge


def ridge(across: NDArray[np.float64]) -> NDArray[np.float64]:
    """Height of a narrow ridge."""
    return RIDGE * np.maximum(1.0 - np.abs(across - CREST) / TOP, 0.0)


@lru_cache(maxsize=1)
def _behind_the_ridge() -> tuple[NDArray[np.float64], Record, Record, float]:
    """Slant range, records by long steps and by the sweep, and what a bed without the ridge returns from its shadow."""
    across = np.arange(-1.0, 50.0, 0.1)
    heights = np.tile(ridge(across)[:, None], (1, 21))
    problem = over(level_scene(), heights, 0.1, x0=-1.0, y0=-1.0).problem
    bare = over(level_scene(), 0.0 * heights, 0.1, x0=-1.0, y0=-1.0).problem
    fish = pose(0.0, 0.0, FISH)
    long, ours = march.trace(problem, fish, step=STEP, rays=4000)[0, 0], sweep.trace(problem, fish)[0, 0]
    r = bin_centres(problem)
    without = float(sweep.trace(bare, fish)[0, 0][_dark(r)].sum())
    return r, long.astype(np.float64), ours.astype(np.float64), without


def _dark(r: NDArray[np.float64]) -> NDArray[np.bool_]:
    return (r > math.hypot(SHADOW[0], FISH)) & (r < math.hypot(SHADOW[1], FISH))


def _leaked(record: Record) -> float:
    r, *_, without = _behind_the_ridge()
    return float(100.0 * record[_dark(r)].sum() / without)


def _draw_leak(figure: Figure) -> None:
    r, long, ours, _ = _behind_the_ridge()
    scene = panel(figure, 121, x="across (m)", y="height (m)", title=f"a step of {STEP:g} m passes the crest")
    across = np.linspace(0.0, 40.0, 800)
    scene.fill_between(across, ridge(across), -0.5, color=FAINT, alpha=0.35, linewidth=0)
    reach = np.arange(0.0, 45.0, STEP)
    fall = FISH / 29.0
    scene.plot(reach[reach < 29.1], FISH - fall * reach[reach < 29.1], "o-", color=WRONG, markersize=3, linewidth=0.8)
    scene.plot([0.0, CREST - 0.2], [FISH, FISH - fall * (CREST - 0.2)], color=RIGHT, linewidth=1.6)
    scene.set_ylim(-0.5, 6.0)
    record = panel(figure, 122, x="slant range (m)", y="energy per bin (dB)", title="and lights the shadow")
    for values, colour, words in ((long, WRONG, "long steps"), (ours, RIGHT, "segments, one horizon")):
        with np.errstate(divide="ignore"):
            level = 10.0 * np.log10(values)
        level[~np.isfinite(level)] = np.nan
        record.plot(r[200:], level[200:], color=colour, linewidth=1.0, label=words)
    named(record)


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
    problem = over(level_scene(), heights, 0.5).problem
    record = [sweep.trace(problem, pose(x, y, 8.0, turn)) for x, y in ((15.0, 15.0), (15.25, 15.0), (9.5, 10.0))
              for turn in (0.0, 0.5 * math.pi, 0.25 * math.pi)]  # fmt: skip
    return float(100.0 * np.mean(~np.isfinite(record)))


@lru_cache(maxsize=1)
def _cells() -> tuple[Record, Record, Record]:
    """Spacings of ever finer samples of one smooth bed, and the errors of points and of the sweep on them."""
    spacings = np.array([0.8, 0.4, 0.2])
    fish = pose(0.0, 12.8, 8.0)
    finest = _smooth(0.025)
    right = sweep.trace(finest, fish)
    points, ours = [], []
    for spacing in spacings:
        problem = _smooth(float(spacing))
        points.append(compare(finest, fish, _as_points(problem, fish, float(spacing)), right).beyond)
        ours.append(compare(finest, fish, sweep.trace(problem, fish), right).beyond)
    return spacings, np.array(points), np.array(ours)


def _smooth(spacing: float) -> Problem:
    place = np.arange(0.0, 64.0 + 0.5 * spacing, spacing)
    waves = 0.15 * np.sin(2.0 * math.pi * place / 12.8)
    heights = np.add.outer(waves, waves)
    return over(level_scene({"sonar.bins": 100}), heights, spacing, x0=-0.5 * 25.6).problem


def _as_points(problem: Problem, fish: Poses, spacing: float) -> NDArray[np.float32]:
    """Let every sample of the bed echo as a point, with its own share of the area."""
    out = np.zeros((1, 2, problem.bins), dtype=np.float32)
    bed, height = problem.bed, float(fish.z[0])
    column = round((float(fish.x[0]) - bed.x0) / spacing)
    z = bed.heights[:, column].astype(np.float64)
    y = np.arange(z.size) * spacing + bed.y0 - float(fish.y[0])
    r = np.hypot(y, z - height)
    slope = np.gradient(z, spacing)
    cosine = (np.abs(y) * np.abs(slope) * np.sign(slope * y) + height - z) / r / np.sqrt(1.0 + slope**2)
    energy = np.maximum(cosine, 0.0) ** 2 / math.pi * np.sqrt(1.0 + slope**2) * spacing
    place = (r / problem.bin_length).astype(np.int64)
    for side in range(2):
        mine = (place < problem.bins) & ((y >= 0.0) if side == 0 else (y < 0.0))
        np.add.at(out[0, side], place[mine], energy[mine])
    return out * problem.range_factor.astype(np.float32)


def _order_off(errors: Record, order: float) -> float:
    """By how many percent the order at which errors fall is off that of the method."""
    return float(100.0 * abs(np.polyfit(np.log(_cells()[0]), np.log(errors), 1)[0] / order - 1.0))


def _draw_orders(figure: Figure) -> None:
    spacings, points, ours = _cells()
    axes = panel(figure, x="spacing of samples (m)", y="error of the record")
    axes.set(xscale="log", yscale="log")
    axes.plot(spacings, points, "s-", color=WRONG, label="samples as points")
    axes.plot(spacings, ours, "D-", color=RIGHT, label="pieces spread over the bins they span")
    axes.plot(spacings, ours[0] * (spacings / spacings[0]) ** 2, "--", color=INK, linewidth=0.8, label="second order")
    named(axes)


CASES = (
    Case(
        "Steps too long",
        "A ray that is looked at every few metres steps across whatever is thinner.",
        "energy from a shadow, over that of the bare bed", "%",
        Way(f"Marches in steps of {STEP:g} m.", lambda: _leaked(_behind_the_ridge()[1]), 5.0),
        Way("Walks every piece of the bed once, under one horizon.", lambda: _leaked(_behind_the_ridge()[2]), 0.0),
        _draw_leak,
    ),
    Case(
        "A fish over a knot",
        "The line of sight straight down has no slope: 0/0, and whatever is added up after it is lost.",
        "bins or knots without a number", "%",
        Way("Forms slopes over ground range from the fish on.", _plain_knot, 50.0),
        Way("Begins the walk beneath the fish without dividing by its range.", _own_knot, 0.0),
    ),
    Case(
        "An order that is none",
        "A method is said to be of second order, and halving its step should quarter its error.",
        "observed order, off the second", "%",
        Way("Lets every sample of the bed echo as a point.", lambda: _order_off(_cells()[1], 2.0), 20.0),
        Way("Spreads each piece's energy over the bins it spans.", lambda: _order_off(_cells()[2], 2.0), 10.0),
        _draw_orders,
    ),
)  # fmt: skip
