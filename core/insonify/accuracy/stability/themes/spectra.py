"""Failures of generated reliefs: aliased waves, seeds that depend on the grid, exponents measured on pictures."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from insonify.accuracy.stability.case import Approach, Measured, StabilityTheme
from insonify.accuracy.stability.drawing import common, faint, ours, panel, side_by_side, table
from insonify.accuracy.stability.level_scenes import error_message, make_level_scene
from insonify.scene import Scene, load_scene
from insonify.statistics.spectral_exponent import amplitude_exponent
from insonify.terrain import relief, relief_picture

THEME = StabilityTheme("Generated reliefs", 9)
Field = NDArray[np.float64]
CELLS = 256
SHARED = 40  # waves that grids of 128 and of 256 nodes both resolve


def _fractal(**options: Any) -> Scene:
    declared = {"kind": "fractal", "period": 25.6, "rms": 0.05} | options
    return make_level_scene({"seabed.spacing": 0.1, "seabed.relief": declared})


def _filter_noise(shape: tuple[int, int], beta: float, peak: tuple[float, float] = (0.0, 0.0)) -> Field:
    """White noise filtered by the distance of array indices from a peak: its real part."""
    noise = np.fft.fft2(np.random.default_rng(1).normal(size=shape))
    rows, columns = np.indices(shape)
    away = np.hypot(columns - peak[0] % shape[1], rows - peak[1] % shape[0])
    return np.asarray(np.fft.ifft2(noise * np.maximum(away, 1.0) ** -beta).real)


BAD: tuple[dict[str, Any], ...] = ({"peaks": [[200.0, 0.0]]}, {"peaks": [[0.0, 128.0]]}, {"beta": 5.0}, {"beta": -1.0})


@THEME.case(
    "Peaks and exponents out of bounds",
    "A peak at or above the Nyquist frequency aliases; an exponent below 0 or from 5 on makes no relief.",
    "such beds made without an error",
    "of 4",
    failing=Approach("Filters by array indices without a check.", 3.0),
    right=Approach("Refuses each in one sentence that names the field.", 0.0),
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


@THEME.case(
    "Undersampled ripples",
    "Waves too short for a coarse grid alias to longer ones.",
    "energy of aliased waves",
    "%",
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

    def aliased(coarse: Field) -> float:
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


def _smooth(field: Field) -> Field:
    """Relief low-passed to the waves that both grids resolve, over its rms."""
    half = np.fft.rfft2(field, norm="forward")
    half[SHARED:-SHARED], half[:, SHARED:] = 0.0, 0.0
    wave = np.fft.irfft2(half, field.shape, norm="forward")
    return np.asarray(wave / wave.std())


def _difference(fields: list[Field]) -> float:
    """Relative difference of the waves that both grids resolve, in per cent."""
    a, b = (np.fft.rfft2(field, norm="forward")[:SHARED, 1:SHARED] for field in fields)
    return float(100.0 * np.linalg.norm(a / np.linalg.norm(a) - b / np.linalg.norm(b)))


@THEME.case(
    "The same seed on another grid",
    "Random numbers drawn per sample give another relief on every grid; array indices give another shape on a "
    "grid that is not square.",
    "difference between the waves that both grids resolve",
    "%",
    failing=Approach("Draws noise for each grid and filters it by indices.", 100.0),
    right=Approach("Hashes each wave's coefficient from the seed and its frequency.", 1e-9),
)
def _same_seed() -> Measured:
    seabed, shapes, y = _fractal(beta=1.4).seabed, ((CELLS, CELLS), (CELLS, 128)), np.arange(CELLS) * 0.1
    plain, own = [_filter_noise(shape, 1.4) for shape in shapes], [relief(seabed, shape) for shape in shapes]

    def curves(draw: Any, fields: list[Field]) -> list[Any]:
        square, narrow = (_smooth(field)[:, 0] for field in fields)
        return [
            draw(y, square, f"{CELLS} columns", linewidth=1.0),
            draw(y, narrow, "128 columns", "--", linewidth=1.6),
        ]

    labels: dict[str, Any] = {"x": "along y (m)", "y": "height over its rms"}
    return Measured.by(_difference, plain, own, side_by_side(
        panel(*curves(common, plain), title="noise per sample", place=121, **labels),
        panel(*curves(ours, own), title="hashed waves", place=122, **labels),
    ))  # fmt: skip


@THEME.case(
    "β measured on a picture",
    "Rounding to 256 greys adds white noise, which flattens a spectrum that falls steeply.",
    "error of the measured β",
    "",
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
