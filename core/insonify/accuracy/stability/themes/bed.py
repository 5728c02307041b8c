"""Failures over relief: steps that are too long, a sonar above a knot, a wrong order of convergence."""

from __future__ import annotations

import math

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from insonify.accuracy.stability.case import Approach, Measured, StabilityTheme, percent
from insonify.accuracy.stability.drawing import add_legend, common, inked, ours, panel
from insonify.accuracy.stability.level_scenes import arrays_over, make_pose, sweep_port
from insonify.acoustics.resolution_cell import bin_centres
from insonify.display.style import FAINT
from insonify.kernels.common.types import Poses, SceneArrays
from insonify.scene import edit, load_scene
from insonify.simulation import prepare
from insonify.statistics.record_errors import compare_records
from insonify.tracers import march, rays, sweep

THEME = StabilityTheme("The bed", 5)
Record = NDArray[np.float64]
SONAR = 5.0  # m, height of the sonar
STEP = 2.0
FINE = 20_000  # rays by which shadows are found
BORDER = 3  # bins beside the ends of a shadow, which are partly lit


@THEME.case(
    "Steps too long",
    "A ray that is sampled every few metres steps over whatever is thinner.",
    "energy in shadows, over that of a level bed there",
    "%",
    failing=Approach(f"Marches in steps of {STEP:g} m.", 5.0),
    right=Approach("Walks every segment of the bed once under a running horizon.", 0.0),
    scene="breaks-steps",
)
def _steps() -> Measured:
    simulation = prepare(load_scene("breaks-steps"))
    arrays, pose = simulation.arrays, simulation.poses(np.zeros(1, dtype=np.int64))
    level = prepare(edit(simulation.scene, {"seabed.relief": "flat"})).arrays
    height, r = float(pose.z[0]), bin_centres(arrays)
    long = march.trace(arrays, pose, step=STEP, rays=4000)[0, 0].astype(np.float64)
    own, lit = sweep_port(arrays, pose), rays.trace(arrays, pose, rays=FINE)[0, 0] > 0.0
    dark = ~np.convolve(lit, np.ones(2 * BORDER + 1), mode="same").astype(bool) & (r > 2.0 * height)
    without = float(sweep.trace(level, pose)[0, 0][dark].sum())

    def draw(figure: Figure) -> None:
        across = np.linspace(0.0, 45.0, 1801)
        bed = simulation.ground.height_at(np.zeros(across.size), across)
        places, slope, seen = _ray_through_a_crest(across, bed, height)
        met = across[: int(np.argmin(height + slope * across > bed)) + 1]
        scene = panel(
            common(places[:seen], height + slope * places[:seen], style="o-", markersize=3, linewidth=0.8),
            ours(met, height + slope * met, linewidth=1.8),
            x="across (m)", y="height (m)", title=f"a step of {STEP:g} m passes a crest", place=121,
            ylim=(-1.2, height + 0.5),
        )(figure)  # fmt: skip
        scene.fill_between(across, bed, -1.5, color=FAINT, alpha=0.35, linewidth=0)
        with np.errstate(divide="ignore"):
            levels = [np.where(one > 0.0, 10.0 * np.log10(one), np.nan) for one in (long, own)]
        title = "and puts energy into the shadows"
        record = panel(x="slant range (m)", y="energy per bin (dB)", title=title, place=122)(figure)
        record.fill_between(r, -130.0, -60.0, where=dark.tolist(), color=FAINT, alpha=0.18, linewidth=0, label="shadow")
        common(r, levels[0], "long steps", ".", markersize=1.5).draw(record)
        ours(r, levels[1], "segments, one horizon", linewidth=1.0).draw(record)
        record.set(xlim=(8.0, 50.0), ylim=(-115.0, -60.0))
        add_legend(record, "upper right")

    return Measured.by(lambda record: 100.0 * record[dark].sum() / without, long, own, draw)


def _ray_through_a_crest(across: Record, bed: Record, height: float) -> tuple[Record, float, int]:
    """Deepest ray through a crest with no sample inside it: samples, slope, and number up to the bed."""
    top = int(np.argmax(np.where((across > 15.0) & (across < 25.0), bed, -np.inf)))
    places = np.arange(0.0, 45.0, STEP)
    for below in np.arange(0.6, 0.0, -0.05):
        slope = (bed[top] - below - height) / across[top]
        seen = int(np.argmin(height + slope * places > np.interp(places, across, bed))) + 1
        if places[seen - 1] > across[top] + STEP:
            break
    return places, slope, seen


def _lost_by_division(x: Record) -> float:
    """Percentage of values lost by a running sum over the cosines of incidence on a level bed, by slopes z / x."""
    with np.errstate(invalid="ignore", divide="ignore"):
        slope = -SONAR / x
        return percent(~np.isfinite(np.cumsum(-slope * x / np.hypot(x, slope * x))))


@THEME.case(
    "A fish over a knot",
    "The line of sight straight down has the slope 0/0, and every later value of a running sum is lost.",
    "bins or knots without a number",
    "%",
    failing=Approach("Divides by ground range from the fish on.", 50.0),
    right=Approach("Starts beneath the fish without dividing by ground range.", 0.0),
)
def _knot() -> Measured:
    heights = np.zeros((64, 64))
    heights[20:24, 20:24] = np.nan
    holed, turns = arrays_over(heights, 0.5), (0.0, 0.5 * math.pi, 0.25 * math.pi)
    # Over a node, over an edge and over the rim of a hole.
    poses = [make_pose(x, y, 8.0, turn) for x, y in ((15.0, 15.0), (15.25, 15.0), (9.5, 10.0)) for turn in turns]
    own = percent(~np.isfinite([sweep.trace(holed, pose) for pose in poses]))
    level = arrays_over(np.zeros((64, 64)), 0.1, x0=-3.2, y0=-3.2)
    off, x, plain = np.linspace(-0.3, 0.3, 61), np.arange(-5.0, 20.0, 0.1), []
    for place in off:
        ahead = x[x >= place - 1e-12] - round(place, 10)
        plain.append(_lost_by_division(np.where(np.abs(ahead) < 1e-9, 0.0, ahead)))
    passing = [percent(~np.isfinite(sweep.trace(level, make_pose(0.0, y, SONAR)))) for y in off]
    return Measured(_lost_by_division(np.arange(0.0, 20.0, 0.1)), own, panel(
        common(off, plain, "division by ground range", "o", markersize=4),
        ours(off, passing, "walk that starts beneath the fish", ".", markersize=4),
        x="fish across, knots every 0.1 m (m)", y="bins without a number (%)", ylim=(-6.0, 130.0),
        legend="upper right",
    ))  # fmt: skip


def _smooth(spacing: float) -> SceneArrays:
    """Smooth waves sampled at a spacing."""
    place = np.arange(0.0, 64.0 + 0.5 * spacing, spacing)
    waves = 0.15 * np.sin(2.0 * math.pi * place / 12.8)
    return arrays_over(np.add.outer(waves, waves), spacing, x0=-0.5 * 25.6, changes={"sonar.bins": 100})


def _trace_points(arrays: SceneArrays, pose: Poses, spacing: float) -> NDArray[np.float32]:
    """Record of a bed of point scatterers: one per sample, with its share of the area."""
    out = np.zeros((1, 2, arrays.bins), dtype=np.float32)
    bed, height = arrays.bed, float(pose.z[0])
    column = round((float(pose.x[0]) - bed.x0) / spacing)
    z = bed.heights[:, column].astype(np.float64)
    y = np.arange(z.size) * spacing + bed.y0 - float(pose.y[0])
    r = np.hypot(y, z - height)
    slope = np.gradient(z, spacing)
    cosine = (np.abs(y) * np.abs(slope) * np.sign(slope * y) + height - z) / r / np.sqrt(1.0 + slope**2)
    energy = np.maximum(cosine, 0.0) ** 2 / math.pi * np.sqrt(1.0 + slope**2) * spacing
    place = (r / arrays.bin_length).astype(np.int64)
    for side in range(2):
        mine = (place < arrays.bins) & ((y >= 0.0) if side == 0 else (y < 0.0))
        np.add.at(out[0, side], place[mine], energy[mine])
    return out * arrays.range_factor.astype(np.float32)


@THEME.case(
    "A wrong order of convergence",
    "A method claims second order: halving its step should quarter its error.",
    "deviation of the observed order from 2",
    "%",
    failing=Approach("Treats every sample of the bed as a point scatterer.", 20.0),
    right=Approach("Spreads the energy of each segment over the bins that it spans.", 10.0),
)
def _order() -> Measured:
    spacings, pose, finest, errors = np.array([0.8, 0.4, 0.2]), make_pose(0.0, 12.8, 8.0), _smooth(0.025), []
    exact = sweep.trace(finest, pose)
    for spacing in map(float, spacings):
        arrays = _smooth(spacing)
        records = _trace_points(arrays, pose, spacing), sweep.trace(arrays, pose)
        errors.append([compare_records(finest, pose, record, exact).beyond for record in records])
    points, own = np.array(errors).T

    def off_second_order(errors: Record) -> float:
        return float(100.0 * abs(np.polyfit(np.log(spacings), np.log(errors), 1)[0] / 2.0 - 1.0))

    return Measured.by(off_second_order, points, own, panel(
        common(spacings, points, "samples as points", "s-"),
        ours(spacings, own, "segments spread over the bins that they span", "D-"),
        inked(spacings, own[0] * (spacings / spacings[0]) ** 2, "second order", "--", linewidth=0.8),
        x="spacing of samples (m)", y="error of the record", log="xy",
    ))  # fmt: skip
