"""Failures over relief, and of generated reliefs: long steps, knots, orders of convergence, lobes, aliases, seeds."""

import math
from typing import Any

import numpy as np

from insonify.accuracy.stability.case import Measured, StabilityTheme, percent
from insonify.accuracy.stability.drawing import plot, table
from insonify.accuracy.stability.level_scenes import (
    arrays_over,
    error_message,
    first_ping,
    make_level_scene,
    make_pose,
    sweep_port,
)
from insonify.acoustics.resolution_cell import bin_centres
from insonify.arrays import Floats, Singles
from insonify.kernels.common.types import Poses, SceneArrays
from insonify.scene import Scene, edit, load_scene
from insonify.simulation import prepare
from insonify.statistics.record_errors import compare_records
from insonify.statistics.record_statistics import amplitude_exponent
from insonify.terrain import relief, relief_picture
from insonify.tracers import march, ray_sheets, rays, sweep

THE_BED = StabilityTheme("The bed", 5)
HEIGHT = 5.0  # m, height of the sonar


@THE_BED.case("Steps too long", "A ray that is sampled every few metres steps over narrower crests.",
    "energy in shadows over the energy of a level bed there", "%", "Marches in steps of 2 m.", 5.0,
    "Walks every segment of the bed once under a running horizon.", 0.0, scene="breaks-steps")  # fmt: skip
def _steps() -> Measured:
    scene = load_scene("breaks-steps")
    arrays, pose = first_ping(scene)
    level, r = prepare(edit(scene, {"seabed.relief": "flat"})).arrays, bin_centres(arrays)
    long = march.trace(arrays, pose, step=2.0, rays=4000)[0, 0].astype(np.float64)
    own, lit = sweep_port(arrays, pose), rays.trace(arrays, pose, rays=20_000)[0, 0] > 0.0
    # Three bins beside the ends of a shadow are partly lit.
    dark = ~np.convolve(lit, np.ones(7), mode="same").astype(bool) & (r > 2.0 * float(pose.z[0]))
    without = float(sweep.trace(level, pose)[0, 0][dark].sum())
    picture = plot("slant range (m)", "energy per bin in shadows", r[dark], long[dark], own[dark], style=".")
    return Measured.by(lambda record: 100.0 * record[dark].sum() / without, long, own, picture)


def _lost_by_division(x: Floats) -> float:
    """Percentage of values lost by a running sum over the cosines of incidence on a level bed, by slopes z / x."""
    with np.errstate(invalid="ignore", divide="ignore"):
        slope = -HEIGHT / x
        return percent(~np.isfinite(np.cumsum(-slope * x / np.hypot(x, slope * x))))


@THE_BED.case("A towfish over a knot",
    "The line of sight straight down has the slope 0/0, and every later value of a running sum is lost.",
    "bins or knots without a number", "%", "Divides by ground range, starting at the towfish.", 50.0,
    "Starts beneath the towfish without dividing by ground range.", 0.0)  # fmt: skip
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
    picture = plot("towfish across, knots every 0.1 m (m)", "bins without a number (%)", off, plain, passing, style=".")
    return Measured(_lost_by_division(np.arange(0.0, 20.0, 0.1)), own, picture)


def _smooth_waves(spacing: float) -> SceneArrays:
    """Smooth waves sampled at a spacing."""
    waves = 0.15 * np.sin(2.0 * math.pi * np.arange(0.0, 64.0 + 0.5 * spacing, spacing) / 12.8)
    return arrays_over(np.add.outer(waves, waves), spacing, {"sonar.bins": 100}, x0=-0.5 * 25.6)


def _trace_points(arrays: SceneArrays, pose: Poses, spacing: float) -> Singles:
    """Record of a bed of point scatterers: one per sample, with its share of the area."""
    out = np.zeros((1, 2, arrays.bins), dtype=np.float32)
    bed, height = arrays.bed, float(pose.z[0])
    z = bed.heights[:, round((float(pose.x[0]) - bed.x0) / spacing)].astype(np.float64)
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


@THE_BED.case("A wrong order of convergence", "Halving the step of a second-order method should quarter its error.",
    "deviation of the observed order from 2", "%", "Treats every sample of the bed as a point scatterer.", 20.0,
    "Spreads the energy of each segment over the bins that it spans.", 10.0)  # fmt: skip
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

    second = own[0] * (spacings / spacings[0]) ** 2
    picture = plot("spacing of samples (m)", "error of the record", spacings, points, own, second, log="xy")
    return Measured.by(off_second_order, points, own, picture)


ROUGH_BEDS = StabilityTheme("Rough beds", 6)
ROUGH = {
    "seabed.relief": {"kind": "fractal", "beta": 1.2, "peaks": [[0.0, 0.0]], "period": 51.2, "rms": 0.16},
    "seabed.spacing": 0.1,
    "seabed.material": {"name": "fine_sand", "diffuse": 0.0559},  # with its own narrow lobe
    "sonar.range": 40.0,
    "sonar.bins": 800,
}


@ROUGH_BEDS.case("A lobe narrower than a cell's twist",
    "Within one cell of a rough bed the surface turns by more than the width of a specular lobe.",
    "error of the record against exact rays", "%", "Takes the incidence at the middle of each cell's segment.", 5.0,
    "Divides a segment until lobe, slope and density change little within each part.", 1.0)  # fmt: skip
def _lobe() -> Measured:
    arrays, pose = first_ping(make_level_scene(ROUGH))
    whole, divided = (  # share of a bin's echo that a segment may misplace
        sweep.trace(arrays._replace(limits=arrays.limits._replace(misplaced=share)), pose, planes=1)
        for share in (math.inf, 0.01)
    )
    exact = ray_sheets.trace(arrays, pose, rays=1 << 14)
    lit = exact[0, 0] > 0.01 * np.median(exact[0, 0][exact[0, 0] > 0.0])
    ratios = [record[0, 0][lit] / exact[0, 0][lit] for record in (whole, divided)]
    picture = plot("slant range (m)", "echo over that of exact rays", bin_centres(arrays)[lit], *ratios, 1.0, log="y",
                   style=".", ylim=(0.1, 10.0), xlim=(10.0, 40.0))  # fmt: skip
    return Measured.by(lambda one: 100.0 * compare_records(arrays, pose, one, exact).beyond, whole, divided, picture)


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


@GENERATED_RELIEFS.case("Peaks and exponents out of bounds",
    "A peak at or above the Nyquist frequency aliases; an exponent below 0, or of 5 and more, gives no relief.",
    "such beds made without an error", "of 4", "Filters by array indices without a check.", 3.0,
    "Reports each as one sentence that names the field.", 0.0)  # fmt: skip
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
    return Measured(float(made), float(unexplained), table(rows))


@GENERATED_RELIEFS.case("Undersampled ripples", "Waves too short for a coarse grid alias to longer ones.",
    "energy of aliased waves", "%", "Takes every second sample.", 50.0,
    "Synthesises the same relief on the coarse grid from the waves that it resolves.", 1e-9)  # fmt: skip
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

    curves = sampled[5], made[5], (x, fine[10])
    picture = plot("along x (m)", "height (m)", x[::2], *curves, xlim=(0.0, 8.0), ylim=(-0.18, 0.30))
    return Measured.by(aliased, sampled, made, picture)


def _resolved_waves(field: Floats) -> Floats:
    """Waves that both grids resolve, over their norm."""
    waves = np.fft.rfft2(field, norm="forward")[:SHARED, 1:SHARED]
    return np.asarray(waves / np.linalg.norm(waves))


@GENERATED_RELIEFS.case("The same seed on another grid",
    "Random numbers drawn per sample give another relief on every grid; array indices give another shape on a "
    "grid that is not square.",
    "difference between the waves that both grids resolve", "%",
    "Draws noise for each grid and filters it by indices.", 100.0,
    "Hashes each wave's coefficient from the seed and its frequency.", 1e-9)  # fmt: skip
def _same_seed() -> Measured:
    seabed, shapes = _fractal(beta=1.4).seabed, ((CELLS, CELLS), (CELLS, 128))
    plain = [_resolved_waves(_filter_noise(shape, 1.4)) for shape in shapes]
    own = [_resolved_waves(relief(seabed, shape)) for shape in shapes]
    apart = [np.abs(square - narrow)[0] for square, narrow in (plain, own)]
    picture = plot("cycles per period", "difference between grids, over the norm", np.arange(1, SHARED), *apart)
    return Measured.by(lambda fields: 100.0 * np.linalg.norm(fields[0] - fields[1]), plain, own, picture)


@GENERATED_RELIEFS.case(
    "β measured on a picture", "Rounding to 256 greys adds white noise, which flattens a spectrum that falls steeply.",
    "error of the measured β", "", "Fits the spectrum of a picture in 256 greys.", 0.2,
    "Fits the spectrum of the heights themselves.", 0.02, scene="breaks-greys")  # fmt: skip
def _greys() -> Measured:
    scene, spectra = load_scene("breaks-greys"), []
    fields = relief_picture(scene)[::-1].astype(np.float64), relief(scene.seabed)
    for field in fields:
        power = np.abs(np.fft.rfft2(field / field.std(), norm="forward")) ** 2
        fy = np.fft.fftfreq(field.shape[0], 1.0 / field.shape[0])[:, None]
        radius = np.rint(np.hypot(fy, np.arange(power.shape[1]))).astype(np.int64).ravel()
        spectra.append(np.bincount(radius, power.ravel())[1:250] / np.bincount(radius)[1:250])
    picture = plot("cycles per period", "mean power", np.arange(1, 250), *spectra, log="xy")
    return Measured.by(lambda field: abs(amplitude_exponent(field) - 2.0), *fields, picture)
