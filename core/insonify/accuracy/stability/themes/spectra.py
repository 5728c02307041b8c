"""Failures of generated reliefs: aliased waves, seeds that depend on the grid, exponents measured on pictures."""

from __future__ import annotations

from functools import lru_cache
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from insonify.accuracy.stability.case import Approach, StabilityCase, StabilityTheme
from insonify.accuracy.stability.drawing import RIGHT, WRONG, add_legend, add_panel, write_table
from insonify.accuracy.stability.level_scenes import make_level_scene
from insonify.display.style import FAINT
from insonify.scene import Scene, SceneError, load_scene
from insonify.terrain import relief, relief_picture
from insonify.terrain.spectral_exponent import amplitude_exponent

Field = NDArray[np.float64]
CELLS = 256


def _fractal(**options: Any) -> Scene:
    declared = {"kind": "fractal", "period": 25.6, "rms": 0.05} | options
    return make_level_scene({"seabed.spacing": 0.1, "seabed.relief": declared})


def filtered_noise(shape: tuple[int, int], beta: float, peak: tuple[float, float]) -> Field:
    """Filter white noise by the distance of array indices from a peak, and take the real part."""
    noise = np.fft.fft2(np.random.default_rng(1).normal(size=shape))
    rows, columns = np.indices(shape)
    away = np.hypot(columns - peak[0] % shape[1], rows - peak[1] % shape[0])
    return np.asarray(np.fft.ifft2(noise * np.maximum(away, 1.0) ** -beta).real)


BAD: tuple[dict[str, Any], ...] = ({"peaks": [[200.0, 0.0]]}, {"peaks": [[0.0, 128.0]]}, {"beta": 5.0}, {"beta": -1.0})


def _taken_by_noise() -> float:
    made = 0
    for wrong in BAD:
        peak = wrong.get("peaks", [[0.0, 0.0]])[0]
        field = filtered_noise((64, 64), float(wrong.get("beta", 1.4)), (peak[0], peak[1]))
        made += bool(np.isfinite(field).all())
    return float(made)


def _refusal(wrong: dict[str, Any]) -> str:
    """Error message for a relief; empty if it is accepted."""
    try:
        _fractal(**wrong)
    except SceneError as error:
        return str(error)
    return ""


def _taken_by_scenes() -> float:
    return float(sum("\n" in said or "relief" not in said for said in map(_refusal, BAD)))


RIPPLES = 90.0  # cycles per period, more than a grid of 128 holds


@lru_cache(maxsize=1)
def _ripples() -> tuple[Field, Field, Field]:
    """Ripples on a fine grid, on a coarse one by taking every second sample, and as the same landscape made there."""
    seabed = _fractal(beta=3.0, peaks=[[RIPPLES, 0.0]]).seabed
    fine = relief(seabed, (CELLS, CELLS))
    return fine, fine[::2, ::2], relief(seabed, (CELLS // 2, CELLS // 2))


def _ghost_waves(coarse: Field) -> float:
    """Energy of waves that the landscape does not have, over all its energy."""
    fine = _ripples()[0]
    keep = CELLS // 2
    true = np.fft.fft2(fine, norm="forward")
    index = (np.arange(keep) + keep // 2) % keep - keep // 2
    held = true[np.ix_(index, index)]
    ghost = np.abs(np.fft.fft2(coarse, norm="forward") - held) ** 2
    ghost[keep // 2], ghost[:, keep // 2] = 0.0, 0.0
    return float(100.0 * ghost.sum() / (np.abs(true) ** 2).sum())


def _draw_beats(figure: Figure) -> None:
    fine, sampled, made = _ripples()
    axes = add_panel(figure, x="along x (m)", y="height (m)")
    x = np.arange(CELLS) * 0.1
    axes.plot(x, fine[10], color=FAINT, linewidth=0.7, label="ripples of 28 cm, sampled every 10 cm")
    axes.plot(x[::2], sampled[5], ".-", color=WRONG, linewidth=1.2, markersize=3, label="every second sample: 67 cm")
    axes.plot(x[::2], made[5], color=RIGHT, linewidth=1.6, label="relief that a grid of 20 cm resolves")
    axes.set(xlim=(0.0, 8.0), ylim=(-0.18, 0.30))
    add_legend(axes, "upper right")


def _common_waves(field: Field) -> Field:
    half = np.fft.rfft2(field, norm="forward")
    return np.concatenate([np.abs(half[:40, 1:40]).ravel(), np.angle(half[:40, 1:40]).ravel()])


def _unlike(one: Field, other: Field) -> float:
    """Relative difference of the waves that both grids resolve."""
    a, b = (np.fft.rfft2(field, norm="forward")[:40, 1:40] for field in (one, other))
    a, b = a / np.linalg.norm(a), b / np.linalg.norm(b)
    return float(100.0 * np.linalg.norm(a - b))


def _plain_grids() -> float:
    return _unlike(filtered_noise((CELLS, CELLS), 1.4, (0.0, 0.0)), filtered_noise((CELLS, 128), 1.4, (0.0, 0.0)))


def _own_grids() -> float:
    seabed = _fractal(beta=1.4).seabed
    return _unlike(relief(seabed, (CELLS, CELLS)), relief(seabed, (CELLS, 128)))


@lru_cache(maxsize=1)
def _smooth_bed() -> tuple[Field, Field]:
    """Heights of β = 2, and their picture in 256 greys."""
    scene = load_scene("breaks-greys")
    return relief(scene.seabed), relief_picture(scene)[::-1].astype(np.float64)


def _exponent_off(which: int) -> float:
    return abs(amplitude_exponent(_smooth_bed()[which]) - 2.0)


def _draw_exponents(figure: Figure) -> None:
    axes = add_panel(figure, x="cycles per period", y="mean power (dB)")
    axes.set_xscale("log")
    for field, colour, words in zip(_smooth_bed(), (RIGHT, WRONG), ("heights", "picture in 256 greys")):
        power = np.abs(np.fft.rfft2(field / field.std(), norm="forward")) ** 2
        fy = np.fft.fftfreq(field.shape[0], 1.0 / field.shape[0])[:, None]
        radius = np.rint(np.hypot(fy, np.arange(power.shape[1]))).astype(np.int64).ravel()
        mean = np.bincount(radius, power.ravel())[1:250] / np.bincount(radius)[1:250]
        slope = amplitude_exponent(field)
        axes.plot(np.arange(1, 250), 10.0 * np.log10(mean), color=colour, label=f"{words}: β = {slope:.2f}")
    add_legend(axes)


def _draw_bad(figure: Figure) -> None:
    rows = []
    for wrong in BAD:
        peak = wrong.get("peaks", [[0.0, 0.0]])[0]
        field = filtered_noise((64, 64), float(wrong.get("beta", 1.4)), (peak[0], peak[1]))
        asked = ", ".join(f"{name} = {value}" for name, value in wrong.items())
        rows.append((asked, f"heights from {field.min():.2g} to {field.max():.2g}", _refusal(wrong)))
    write_table(figure, ("relief", "filtered without a check", "message"), rows)


def _draw_grids(figure: Figure) -> None:
    seabed = _fractal(beta=1.4).seabed
    shapes = (CELLS, CELLS), (CELLS, 128)
    plain = [filtered_noise(shape, 1.4, (0.0, 0.0)) for shape in shapes]
    own = [relief(seabed, shape) for shape in shapes]
    for place, fields, colour, words in (
        (121, plain, WRONG, "noise per sample"),
        (122, own, RIGHT, "hashed waves"),
    ):
        axes = add_panel(figure, place, x="along y (m)", y="height over its rms", title=words)
        for field, style, width in zip(fields, ("-", "--"), (1.0, 1.6)):
            axes.plot(np.arange(CELLS) * 0.1, smoothed(field)[:, 0], style, color=colour, linewidth=width,
                      label=f"{field.shape[1]} columns")  # fmt: skip
        add_legend(axes)


def smoothed(field: Field) -> Field:
    """Relief low-passed to the waves that both grids resolve, over its rms."""
    half = np.fft.rfft2(field, norm="forward")
    half[40:-40], half[:, 40:] = 0.0, 0.0
    wave = np.fft.irfft2(half, field.shape, norm="forward")
    return np.asarray(wave / wave.std())


THEME = StabilityTheme("Generated reliefs", 9, (
    StabilityCase(
        "Peaks and exponents out of bounds",
        "A peak at or above the Nyquist frequency aliases; an exponent below 0 or from 5 on makes no relief.",
        "such beds made without an error", "of 4",
        Approach("Filters by array indices without a check.", _taken_by_noise, 3.0),
        Approach("Refuses each in one sentence that names the field.", _taken_by_scenes, 0.0),
        _draw_bad,
    ),
    StabilityCase(
        "Undersampled ripples",
        "Waves too short for a coarse grid alias to longer ones.",
        "energy of aliased waves", "%",
        Approach("Takes every second sample.", lambda: _ghost_waves(_ripples()[1]), 50.0),
        Approach("Synthesises the same relief on the coarse grid from the waves that it resolves.",
                 lambda: _ghost_waves(_ripples()[2]),
            1e-9),
        _draw_beats,
    ),
    StabilityCase(
        "The same seed on another grid",
        "Random numbers drawn per sample give another relief on every grid; array indices give another shape on a "
        "grid that is not square.",
        "difference between the waves that both grids resolve", "%",
        Approach("Draws noise for each grid and filters it by indices.", _plain_grids, 100.0),
        Approach("Hashes each wave's coefficient from the seed and its frequency.", _own_grids, 1e-9),
        _draw_grids,
    ),
    StabilityCase(
        "β measured on a picture",
        "Rounding to 256 greys adds white noise, which flattens a spectrum that falls steeply.",
        "error of the measured β", "",
        Approach("Fits the spectrum of a picture in 256 greys.", lambda: _exponent_off(1), 0.2),
        Approach("Fits the spectrum of the heights themselves.", lambda: _exponent_off(0), 0.02),
        _draw_exponents,
        "breaks-greys",
    ),
))  # fmt: skip
