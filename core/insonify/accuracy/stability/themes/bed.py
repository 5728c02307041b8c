"""Failures over relief, and of generated reliefs: long steps, knots, orders of convergence, lobes, aliases, seeds."""

import math
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from insonify.accuracy.stability.case import Approach, Measured, Quantity, StabilityTheme, percent
from insonify.accuracy.stability.drawing import add_legend, common, faint, inked, ours, panel, side_by_side, table
from insonify.accuracy.stability.level_scenes import arrays_over, error_message, make_level_scene, make_pose, sweep_port
from insonify.acoustics.resolution_cell import bin_centres
from insonify.arrays import Floats, Singles
from insonify.display.style import FAINT
from insonify.kernels.common.types import Poses, SceneArrays
from insonify.scene import Scene, edit, load_scene
from insonify.simulation import prepare
from insonify.statistics.record_errors import compare_records
from insonify.statistics.record_statistics import amplitude_exponent
from insonify.terrain import relief, relief_picture
from insonify.tracers import march, ray_sheets, rays, sweep

THE_BED = StabilityTheme("The bed", 5)
HEIGHT = 5.0  # m, height of the sonar
STEP = 2.0
FINE = 20_000  # rays by which shadows are found
BORDER = 3  # bins beside the ends of a shadow, which are partly lit


@THE_BED.case(
    "Steps too long",
    "A ray that is sampled every few metres steps over narrower crests.",
    Quantity("energy in shadows over the energy of a level bed there", "%"),
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
        common(r, levels[0], "long steps", ".", markersize=1.5)(record)
        ours(r, levels[1], "segments, one horizon", linewidth=1.0)(record)
        record.set(xlim=(8.0, 50.0), ylim=(-115.0, -60.0))
        add_legend(record, "upper right")

    return Measured.by(lambda record: 100.0 * record[dark].sum() / without, long, own, draw)


def _ray_through_a_crest(across: Floats, bed: Floats, height: float) -> tuple[Floats, float, int]:
    """Deepest ray through a crest with no sample inside it: samples, slope, and number up to the bed."""
    top = int(np.argmax(np.where((across > 15.0) & (across < 25.0), bed, -np.inf)))
    places = np.arange(0.0, 45.0, STEP)
    for below in np.arange(0.6, 0.0, -0.05):
        slope = (bed[top] - below - height) / across[top]
        seen = int(np.argmin(height + slope * places > np.interp(places, across, bed))) + 1
        if places[seen - 1] > across[top] + STEP:
            break
    return places, slope, seen


def _lost_by_division(x: Floats) -> float:
    """Percentage of values lost by a running sum over the cosines of incidence on a level bed, by slopes z / x."""
    with np.errstate(invalid="ignore", divide="ignore"):
        slope = -HEIGHT / x
        return percent(~np.isfinite(np.cumsum(-slope * x / np.hypot(x, slope * x))))


@THE_BED.case(
    "A towfish over a knot",
    "The line of sight straight down has the slope 0/0, and every later value of a running sum is lost.",
    Quantity("bins or knots without a number", "%"),
    failing=Approach("Divides by ground range, starting at the towfish.", 50.0),
    right=Approach("Starts beneath the towfish without dividing by ground range.", 0.0),
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
    passing = [percent(~np.isfinite(sweep.trace(level, make_pose(0.0, y, HEIGHT)))) for y in off]
    return Measured(_lost_by_division(np.arange(0.0, 20.0, 0.1)), own, panel(
        common(off, plain, "division by ground range", "o", markersize=4),
        ours(off, passing, "walk that starts beneath the towfish", ".", markersize=4),
        x="towfish across, knots every 0.1 m (m)", y="bins without a number (%)", ylim=(-6.0, 130.0),
        legend="upper right",
    ))  # fmt: skip


def _smooth_waves(spacing: float) -> SceneArrays:
    """Smooth waves sampled at a spacing."""
    place = np.arange(0.0, 64.0 + 0.5 * spacing, spacing)
    waves = 0.15 * np.sin(2.0 * math.pi * place / 12.8)
    return arrays_over(np.add.outer(waves, waves), spacing, x0=-0.5 * 25.6, changes={"sonar.bins": 100})


def _trace_points(arrays: SceneArrays, pose: Poses, spacing: float) -> Singles:
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


@THE_BED.case(
    "A wrong order of convergence",
    "Halving the step of a second-order method should quarter its error.",
    Quantity("deviation of the observed order from 2", "%"),
    failing=Approach("Treats every sample of the bed as a point scatterer.", 20.0),
    right=Approach("Spreads the energy of each segment over the bins that it spans.", 10.0),
)
def _order() -> Measured:
    spacings, pose, finest, errors = np.array([0.8, 0.4, 0.2]), make_pose(0.0, 12.8, 8.0), _smooth_waves(0.025), []
    exact = sweep.trace(finest, pose)
    for spacing in map(float, spacings):
        arrays = _smooth_waves(spacing)
        records = _trace_points(arrays, pose, spacing), sweep.trace(arrays, pose)
        errors.append([compare_records(finest, pose, record, exact).beyond for record in records])
    points, own = np.array(errors).T

    def off_second_order(errors: Floats) -> float:
        return float(100.0 * abs(np.polyfit(np.log(spacings), np.log(errors), 1)[0] / 2.0 - 1.0))

    return Measured.by(off_second_order, points, own, panel(
        common(spacings, points, "samples as points", "s-"),
        ours(spacings, own, "segments spread over the bins that they span", "D-"),
        inked(spacings, own[0] * (spacings / spacings[0]) ** 2, "second order", "--", linewidth=0.8),
        x="spacing of samples (m)", y="error of the record", log="xy",
    ))  # fmt: skip


ROUGH_BEDS = StabilityTheme("Rough beds", 6)
ROUGH = {
    "seabed.relief": {"kind": "fractal", "beta": 1.2, "peaks": [[0.0, 0.0]], "period": 51.2, "rms": 0.16},
    "seabed.spacing": 0.1,
    "seabed.material": {"name": "fine_sand", "diffuse": 0.0559},  # with its own narrow lobe
    "sonar.range": 40.0,
    "sonar.bins": 800,
}


@ROUGH_BEDS.case(
    "A lobe narrower than a cell's twist",
    "Within one cell of a rough bed the surface turns by more than the width of a specular lobe.",
    Quantity("error of the record against exact rays", "%"),
    failing=Approach("Takes the incidence at the middle of each cell's segment.", 5.0),
    right=Approach("Divides a segment until lobe, slope and density change little within each part.", 1.0),
)
def _lobe() -> Measured:
    simulation = prepare(make_level_scene(ROUGH))
    arrays, pose = simulation.arrays, simulation.poses(np.zeros(1, dtype=np.int64))
    whole, divided = (  # share of a bin's echo that a segment may misplace
        sweep.trace(arrays._replace(limits=arrays.limits._replace(misplaced=share)), pose, planes=1)
        for share in (math.inf, 0.01)
    )
    exact = ray_sheets.trace(arrays, pose, rays=1 << 14)
    lit = exact[0, 0] > 0.01 * np.median(exact[0, 0][exact[0, 0] > 0.0])
    r, ratios = bin_centres(arrays)[lit], [record[0, 0][lit] / exact[0, 0][lit] for record in (whole, divided)]
    return Measured.by(lambda one: 100.0 * compare_records(arrays, pose, one, exact).beyond, whole, divided, panel(
        common(r, ratios[0], "one incidence a cell", ".", markersize=3),
        ours(r, ratios[1], "cells divided", ".", markersize=3),
        inked(None, 1.0, linewidth=0.6),
        x="slant range (m)", y="echo over that of exact rays", log="y", ylim=(0.1, 10.0), xlim=(10.0, 40.0),
        legend="upper right",
    ))  # fmt: skip


GENERATED_RELIEFS = StabilityTheme("Generated reliefs", 9)
CELLS = 256
SHARED = 40  # waves that grids of 128 and of 256 nodes both resolve


def _fractal(**options: Any) -> Scene:
    declared = {"kind": "fractal", "period": 25.6, "rms": 0.05} | options
    return make_level_scene({"seabed.spacing": 0.1, "seabed.relief": declared})


def _filter_noise(shape: tuple[int, int], beta: float, peak: tuple[float, float] = (0.0, 0.0)) -> Floats:
    """White noise filtered by the distance of array indices from a peak: its real part."""
    noise = np.fft.fft2(np.random.default_rng(1).normal(size=shape))
    rows, columns = np.indices(shape)
    away = np.hypot(columns - peak[0] % shape[1], rows - peak[1] % shape[0])
    return np.asarray(np.fft.ifft2(noise * np.maximum(away, 1.0) ** -beta).real)


BAD: tuple[dict[str, Any], ...] = ({"peaks": [[200.0, 0.0]]}, {"peaks": [[0.0, 128.0]]}, {"beta": 5.0}, {"beta": -1.0})


@GENERATED_RELIEFS.case(
    "Peaks and exponents out of bounds",
    "A peak at or above the Nyquist frequency aliases; an exponent below 0, or of 5 and more, gives no relief.",
    Quantity("such beds made without an error", "of 4"),
    failing=Approach("Filters by array indices without a check.", 3.0),
    right=Approach("Reports each as one sentence that names the field.", 0.0),
)
def _out_of_bounds() -> Measured:
    made, unexplained, rows = 0, 0, []
    for wrong in BAD:
        peak = wrong.get("peaks", [[0.0, 0.0]])[0]
        field = _filter_noise((64, 64), float(wrong.get("beta", 1.4)), (peak[0], peak[1]))
        made += bool(np.isfinite(field).all())
        message = error_message(lambda wrong=wrong: _fractal(**wrong))  # type: ignore[misc]
        unexplained += "\n" in message or "relief" not in message
        fields = ", ".join(f"{name} = {value}" for name, value in wrong.items())
        rows.append((fields, f"heights from {field.min():.2g} to {field.max():.2g}", message))
    return Measured(float(made), float(unexplained), table(("relief", "filtered without a check", "message"), rows))


@GENERATED_RELIEFS.case(
    "Undersampled ripples",
    "Waves too short for a coarse grid alias to longer ones.",
    Quantity("energy of aliased waves", "%"),
    failing=Approach("Takes every second sample.", 50.0),
    right=Approach("Synthesises the same relief on the coarse grid from the waves that it resolves.", 1e-9),
)
def _undersampled() -> Measured:
    keep, x = CELLS // 2, np.arange(CELLS) * 0.1
    seabed = _fractal(beta=3.0, peaks=[[90.0, 0.0]]).seabed  # more cycles per period than a grid of 128 resolves
    fine = relief(seabed, (CELLS, CELLS))
    sampled, made = fine[::2, ::2], relief(seabed, (keep, keep))
    waves = np.fft.fft2(fine, norm="forward")
    index = (np.arange(keep) + keep // 2) % keep - keep // 2

    def aliased(coarse: Floats) -> float:
        """Energy of waves that the landscape does not have, over all its energy, in per cent."""
        alias = np.abs(np.fft.fft2(coarse, norm="forward") - waves[np.ix_(index, index)]) ** 2
        alias[keep // 2], alias[:, keep // 2] = 0.0, 0.0
        return float(100.0 * alias.sum() / (np.abs(waves) ** 2).sum())

    return Measured.by(aliased, sampled, made, panel(
        faint(x, fine[10], "ripples of 28 cm, sampled every 10 cm", linewidth=0.7),
        common(x[::2], sampled[5], "every second sample: 67 cm", ".-", linewidth=1.2, markersize=3),
        ours(x[::2], made[5], "relief that a grid of 20 cm resolves", linewidth=1.6),
        x="along x (m)", y="height (m)", xlim=(0.0, 8.0), ylim=(-0.18, 0.30), legend="upper right",
    ))  # fmt: skip


def _resolved_waves(field: Floats) -> Floats:
    """Relief low-passed to the waves that both grids resolve, over its rms."""
    half = np.fft.rfft2(field, norm="forward")
    half[SHARED:-SHARED], half[:, SHARED:] = 0.0, 0.0
    wave = np.fft.irfft2(half, field.shape, norm="forward")
    return np.asarray(wave / wave.std())


def _difference(fields: list[Floats]) -> float:
    """Relative difference of the waves that both grids resolve, in per cent."""
    a, b = (np.fft.rfft2(field, norm="forward")[:SHARED, 1:SHARED] for field in fields)
    return float(100.0 * np.linalg.norm(a / np.linalg.norm(a) - b / np.linalg.norm(b)))


@GENERATED_RELIEFS.case(
    "The same seed on another grid",
    "Random numbers drawn per sample give another relief on every grid; array indices give another shape on a "
    "grid that is not square.",
    Quantity("difference between the waves that both grids resolve", "%"),
    failing=Approach("Draws noise for each grid and filters it by indices.", 100.0),
    right=Approach("Hashes each wave's coefficient from the seed and its frequency.", 1e-9),
)
def _same_seed() -> Measured:
    seabed, shapes, y = _fractal(beta=1.4).seabed, ((CELLS, CELLS), (CELLS, 128)), np.arange(CELLS) * 0.1
    plain, own = [_filter_noise(shape, 1.4) for shape in shapes], [relief(seabed, shape) for shape in shapes]

    def curves(draw: Any, fields: list[Floats]) -> list[Any]:
        square, narrow = (_resolved_waves(field)[:, 0] for field in fields)
        return [
            draw(y, square, f"{CELLS} columns", linewidth=1.0),
            draw(y, narrow, "128 columns", "--", linewidth=1.6),
        ]

    labels: dict[str, Any] = {"x": "along y (m)", "y": "height over its rms"}
    return Measured.by(_difference, plain, own, side_by_side(
        panel(*curves(common, plain), title="noise per sample", place=121, **labels),
        panel(*curves(ours, own), title="hashed waves", place=122, **labels),
    ))  # fmt: skip


@GENERATED_RELIEFS.case(
    "β measured on a picture",
    "Rounding to 256 greys adds white noise, which flattens a spectrum that falls steeply.",
    Quantity("error of the measured β"),
    failing=Approach("Fits the spectrum of a picture in 256 greys.", 0.2),
    right=Approach("Fits the spectrum of the heights themselves.", 0.02),
    scene="breaks-greys",
)
def _greys() -> Measured:
    scene, curves, slopes = load_scene("breaks-greys"), [], []
    heights, picture = relief(scene.seabed), relief_picture(scene)[::-1].astype(np.float64)
    for field, draw, words in ((heights, ours, "heights"), (picture, common, "picture in 256 greys")):
        power = np.abs(np.fft.rfft2(field / field.std(), norm="forward")) ** 2
        fy = np.fft.fftfreq(field.shape[0], 1.0 / field.shape[0])[:, None]
        radius = np.rint(np.hypot(fy, np.arange(power.shape[1]))).astype(np.int64).ravel()
        mean = np.bincount(radius, power.ravel())[1:250] / np.bincount(radius)[1:250]
        slopes.append(amplitude_exponent(field))
        curves.append(draw(np.arange(1, 250), 10.0 * np.log10(mean), f"{words}: β = {slopes[-1]:.2f}"))
    return Measured(abs(slopes[1] - 2.0), abs(slopes[0] - 2.0), panel(
        *curves, x="cycles per period", y="mean power (dB)", log="x",
    ))  # fmt: skip
