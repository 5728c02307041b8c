"""Failures of range bins, the receiver and scattering: inexact sums, unbounded areas, gain on noise."""

import math
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from insonify.accuracy.stability.case import Approach, Measured, Quantity, StabilityTheme, percent
from insonify.accuracy.stability.drawing import common, curve, faint, inked, ours, panel, table
from insonify.accuracy.stability.level_scenes import level_arrays, make_level_scene, make_pose, sweep_port
from insonify.acoustics.flat_bed import flat_bed_curve
from insonify.acoustics.resolution_cell import bin_centres
from insonify.arrays import Floats
from insonify.display.normalisation import LevelBed, normalise
from insonify.display.picture import choose_contrast, colour_amplitudes
from insonify.display.style import FAINT
from insonify.kernels.common.scattering import bistatic_strength
from insonify.kernels.common.types import SONAR
from insonify.scene import edit, load_scene
from insonify.simulation import prepare, simulate

RANGE_BINS = StabilityTheme("Range bins", 4)
BINS, BIN = 3000, 0.05


def _sum_in_single_precision(edges: Floats, density: Floats) -> Floats:
    """Add up in float32 the steps of a density at the edges of its pieces."""
    steps = np.zeros(BINS + 1, dtype=np.float32)
    place = np.minimum((edges / BIN).astype(np.int64), BINS)
    np.add.at(steps, place[:-1], density.astype(np.float32))
    np.add.at(steps, place[1:], -density.astype(np.float32))
    return np.cumsum(steps[:BINS], dtype=np.float32).astype(np.float64)


def _level_bed(height: float, reach: float) -> tuple[Floats, Floats, Floats, Floats]:
    """Pieces of a level bed: ends on the ground and in slant range, middles, and Lambert energy over their range."""
    x = np.arange(0.0, reach, 0.1)
    edges = np.hypot(x, height)
    middle = 0.5 * (edges[1:] + edges[:-1])
    return x, edges, middle, (height / middle) ** 2 / math.pi * np.diff(x) / np.diff(edges)


@RANGE_BINS.case(
    "Range factors inside a float32 sum",
    "A float32 prefix sum includes spreading by r⁻⁴, so that far bins are smaller than the rounding errors of "
    "near ones.",
    Quantity("worst error beyond 110 m", "%"),
    failing=Approach("Sums energies times r⁻⁴ in float32.", 100.0),
    right=Approach("Sums energies as integers and applies range factors after the sum.", 0.5),
    scene="breaks-sums",
)
def _factors() -> Measured:
    height = 5.0
    arrays = prepare(load_scene("breaks-sums")).arrays
    x, edges, middle, energy = _level_bed(height, BINS * BIN)
    edges[x > 135.0] = BINS * BIN  # the bed ends there
    energy[x[1:] > 135.0] = 0.0
    exact, r = flat_bed_curve(arrays, height), bin_centres(arrays)
    single = _sum_in_single_precision(edges, energy * BIN * middle**-4.0)
    own = sweep_port(arrays, make_pose(0.0, 0.0, height))
    far, some = slice(2200, int(134.0 / BIN)), slice(110, None, 5)
    return Measured.by(lambda record: 100.0 * np.abs(record[far] / exact[far] - 1.0).max(), single, own, panel(
        common(r[some], np.abs(single[some]), "factors inside a float32 sum", ".", markersize=2.5),
        ours(r[some], own[some], "factors after an exact sum", linewidth=2.0),
        inked(r[some], exact[some], "closed form", "--", linewidth=0.8),
        x="slant range (m)", y="energy per bin", log="y",
    ))  # fmt: skip


@RANGE_BINS.case(
    "Shadows that are not silent",
    "Floating-point steps that should cancel leave a remainder, so that shadows are bright or negative.",
    Quantity("bins of a shadow that are not zero", "%"),
    failing=Approach("Sums float32 steps up and down.", 50.0),
    right=Approach("Sums integers, which cancel exactly.", 0.0),
)
def _shadows() -> Measured:
    changes = {"targets": [{"kind": "sphere", "position": [0.0, 40.0], "radius": 3.0}]}
    arrays = level_arrays(changes | {"sonar.range": 100.0, "sonar.bins": 2000, "sonar.ping_rate": 5.0})
    phi, alpha = math.atan2(7.0, 40.0), math.asin(3.0 / math.hypot(40.0, 7.0))
    begins, ends = 10.0 / math.sin(phi + alpha), 10.0 / math.sin(max(phi - alpha, 1e-9))
    _, edges, middle, energy = _level_bed(10.0, 99.0)
    energy[(middle > begins) & (middle < ends)] = 0.0
    single, own = _sum_in_single_precision(edges, energy), sweep_port(arrays, make_pose(0.0, 0.0, 10.0))
    dark = slice(math.ceil(begins / BIN) + 3, min(math.floor(ends / BIN) - 3, 2000))
    shown = slice(max(dark.start - 120, 0), min(dark.start + 480, dark.stop))
    r = (np.arange(single.size)[shown] + 0.5) * BIN

    def draw(figure: Figure) -> None:
        axes = panel(
            common(r, single[shown] / single[: dark.start].max(), "float32 steps", linewidth=1.2),
            ours(r, own[shown] / own[: dark.start].max(), "integers", linewidth=1.2),
            x="slant range (m)", y="energy over the maximum", legend="upper right",
        )(figure)  # fmt: skip
        axes.set_yscale("symlog", linthresh=1e-7)
        axes.set_yticks([-1e-3, -1e-5, -1e-7, 0.0, 1e-7, 1e-5, 1e-3, 1e-1])
        axes.axvspan(dark.start * BIN, float(r[-1]), color=FAINT, alpha=0.12, linewidth=0)

    return Measured(percent(single[dark] != 0.0), percent(own[dark] != 0.0), draw)


def _cell_area(r: float, height: float, width: float, length: float) -> float:
    """Area of the textbook's cell, φ r · cτ / (2 cos θ)."""
    cosine = math.sqrt(max(1.0 - (height / r) ** 2, 0.0))
    return width * r * length / cosine if cosine > 0.0 else math.inf


@RANGE_BINS.case(
    "Nadir",
    "The cell length cτ/(2 cos θ) is infinite at normal incidence.",
    Quantity("error of the first return's energy", "dB"),
    failing=Approach("Uses the textbook's cell area at the first return.", 60.0),
    right=Approach("Spreads each segment of the bed over the bins that it spans.", 0.1),
)
def _nadir() -> Measured:
    fan, width = {"sonar.beam": {"kind": "fan", "width": 1.0}}, math.radians(1.0)
    arrays, pose = level_arrays(fan), make_pose(0.05, 0.02, 10.0)
    first = round(10.0 / arrays.bin_length)
    textbook = _cell_area(10.0, 10.0, width, arrays.bin_length) / math.pi * 10.0**-4.0
    swept, exact = float(sweep_port(arrays, pose, planes=32)[first]), float(flat_bed_curve(arrays, 10.0)[first])
    fine = level_arrays(fan | {"sonar.range": 14.0, "sonar.bins": 1400})
    own = sweep_port(fine, pose, planes=32).astype(np.float32)
    near = 10.0 + np.geomspace(1e-6, 1.0, 400)
    area = np.array([_cell_area(r, 10.0, width, fine.bin_length) for r in near])
    book = area * (10.0 / near) ** 2 / math.pi * near**-4.0
    edges = np.arange(1000, 1101) * fine.bin_length
    return Measured.by(lambda energy: abs(10.0 * math.log10(energy / exact)), textbook, swept, panel(
        common(near, 10.0 * np.log10(book), "cell φ r cτ / (2 cos θ): infinite at 10 m"),
        ours(edges, 10.0 * np.log10(own[1000:1101]), "energy of each bin", drawstyle="steps-post"),
        faint(10.0, None, style=":", linewidth=0.8),
        x="slant range (m)", y="energy per bin (dB)",
    ))  # fmt: skip


@RANGE_BINS.case(
    "Range zero",
    "The first bin begins at slant range 0; neither 0 nor a silent bin has a logarithm.",
    Quantity("bins without a number", "%"),
    failing=Approach("Adds 30 log r to decibels at the near edge of each bin.", 10.0),
    right=Approach("Keeps linear intensities and takes ranges at bin centres.", 0.0),
)
def _range_zero() -> Measured:
    record = simulate(make_level_scene()).intensity.values[0, 0].astype(np.float64)
    r = np.arange(record.size) * 0.05
    with np.errstate(divide="ignore", invalid="ignore"):
        level = 10.0 * np.log10(record) + 30.0 * np.log10(r)
    noise = {"kind": "ambient", "level": 40.0}
    changes = {"receiver.tvg": "power", "receiver.source_level": 220.0, "receiver.noise": noise}
    own, lost = simulate(make_level_scene(changes)).intensity.values, ~np.isfinite(level)
    low = np.nanmin(level[~lost]) - 5.0
    return Measured(percent(lost), percent(~np.isfinite(own)), panel(
        faint(r, np.where(lost, np.nan, level), "with 30 log r added"),
        common(r[lost], np.full(lost.sum(), low), "no number, in decibels", "|", markersize=7),
        ours([0.025], [low - 6.0], "no number, in linear intensities: none", "|"),
        x="slant range (m)", y="level (dB)", ylim=(low - 4.0, np.nanmax(level[~lost]) + 3.0),
    ))  # fmt: skip


EMPTY: tuple[dict[str, Any], ...] = (
    {"sonar.range": 5.0, "sonar.bins": 50},  # ends before the bed begins
    {"sonar.range": 5.0, "sonar.bins": 1},
    {"sonar.bins": 1},
    {"track.pings": 1, "targets": []},
)


@RANGE_BINS.case(
    "An empty record",
    "A record of one bin or ping, or one that ends before the bed begins, has no maximum to normalise by.",
    Quantity("such records shown wrongly", "of 4"),
    failing=Approach("Divides by the loudest echo and takes logarithms.", 2.0),
    right=Approach("Shows amplitudes relative to a level bed, dark where there is no bed.", 0.0),
)
def _empty() -> Measured:
    plain, wrong, rows = 0, 0, []
    for changes in EMPTY:
        scene = edit(make_level_scene(), changes)
        intensity = simulate(scene).intensity.values
        with np.errstate(divide="ignore", invalid="ignore"):
            lost = percent(~np.isfinite(10.0 * np.log10(intensity / intensity.max())))
        amplitude = normalise(intensity[:, 0], LevelBed(prepare(scene)).curves(np.zeros(1, dtype=np.int64))[0])
        shown = colour_amplitudes(amplitude, levels=choose_contrast(amplitude))
        plain += lost > 0.0
        wrong += not (np.isfinite(amplitude).all() and shown.shape[:2] == amplitude.shape)
        fields = ", ".join(f"{path.partition('.')[2] or path} = {value}" for path, value in changes.items())
        lit = f"{int((intensity > 0.0).sum())} of {intensity.size} bins with an echo, the others dark"
        rows.append((fields, f"{lost:.0f} % without a number", lit))
    heads = "scene", "brightest echo at 0 dB", "relative to a level bed"
    return Measured(float(plain), float(wrong), table(heads, rows))


RECEIVER = StabilityTheme("The receiver", 10)
ABSORPTION = 0.3  # dB/m, some 900 kHz
NOISY = {
    "sonar.range": 150.0, "sonar.bins": 1500, "sonar.ping_rate": 4.0, "track.pings": 24,
    "water.absorption": 1e3 * ABSORPTION, "receiver.noise": {"kind": "ambient", "level": -120.0},
}  # fmt: skip


@RECEIVER.case(
    "Gain over noise",
    "Time-varied gain keeps rising where only noise is left.",
    Quantity("level of the last tenth of the record above the bed's", "dB"),
    failing=Approach("Applies 40 log r + 2αr at every range.", 20.0),
    right=Approach("Keeps the gain constant from the range where even a perfect bed is below the noise.", 3.0),
)
def _gain() -> Measured:
    tvg = {"receiver.tvg": {"kind": "power", "spreading": 40.0}}
    bare, gained = (simulate(make_level_scene(NOISY | more)) for more in ({}, tvg))
    r = bare.slant_range.values
    plain, own = (one.intensity.values.astype(np.float64).mean(axis=(0, 1)) for one in (bare, gained))
    plain = plain * 10.0 ** ((40.0 * np.log10(r) + 2.0 * ABSORPTION * r) / 10.0)
    return Measured.by(lambda one: 10.0 * np.log10(one[1350:].mean() / one[100:500].max()), plain, own, panel(
        common(r, 10.0 * np.log10(plain), "gain to the end of the range", linewidth=1.0),
        ours(r, 10.0 * np.log10(own), "constant gain where noise exceeds any bed", linewidth=1.0),
        x="slant range (m)", y="level (dB)",
    ))  # fmt: skip


def _albedos(incidences: Floats, shininess: float) -> tuple[Floats, Floats]:
    """Albedo by incidence, with the lobe as computer graphics defines it and with the normalised lobe."""
    cosine = (np.arange(120) + 0.5) / 120.0
    around = (np.arange(120) + 0.5) / 120.0 * 2.0 * math.pi
    cosines, angles = (grid.ravel() for grid in np.meshgrid(cosine, around))
    solid_angle = np.full(cosines.size, 2.0 * math.pi / cosines.size)
    plain, own = [], []
    for incidence in incidences:
        mirrored = cosines * math.cos(incidence) - np.sqrt(1.0 - cosines**2) * np.cos(angles) * math.sin(incidence)
        # Lambert and Phong, k_d/π + k_s max(0, R·V)ⁿ with k_d = k_s = ½, times the cosine of the outgoing direction.
        lobe = (0.5 / math.pi + 0.5 * np.maximum(mirrored, 0.0) ** shininess) * cosines
        plain.append(float((lobe * solid_angle).sum()))
        arrives = math.cos(incidence)
        leaves = [bistatic_strength(arrives, c, m, 0.5, 0.5, shininess, SONAR) for c, m in zip(cosines, mirrored)]
        own.append(float((np.array(leaves) * solid_angle).sum() / arrives))
    return np.array(plain), np.array(own)


@RECEIVER.case(
    "A lobe without its norm",
    "Phong's lobe added to Lambert's law without a norm returns more energy than arrives.",
    Quantity("surplus over the incident energy"),
    failing=Approach("Takes k_d/π + k_s cosⁿ with k_d + k_s = 1.", 0.3),
    right=Approach("Normalises the lobe by its integral: a factor (n + 2)/2π.", 0.002),
)
def _lobe() -> Measured:
    degrees, curves, albedos = np.arange(0.0, 81.0, 10.0), [], []
    for n, style in ((1.0, "-"), (4.0, "--")):
        plain, own = _albedos(np.radians(degrees), n)
        albedos.append((plain.max(), own.max()))
        curves += [common(degrees, plain, f"lobe of computer graphics, n = {n:g}", style)]
        curves += [ours(degrees, own, f"normalised, n = {n:g}", style)]
    plain, own = np.array(albedos).T
    return Measured.by(lambda shares: max(*shares, 1.0) - 1.0, plain, own, panel(
        *curves, curve("black", None, 1.0, style=":", linewidth=0.8),
        x="incidence (°)", y="share of the energy that is scattered", ylim=(0.0, 1.7),
    ))  # fmt: skip
