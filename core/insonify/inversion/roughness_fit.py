"""Fit of relief, patches of material and speckle, and of an undeclared pulse and beam, to the spectra of a record.

Theory: docs/theory/inversion.md.
"""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from scipy.optimize import minimize

from insonify.arrays import Floats
from insonify.inversion.footprint import Footprint, footprint_of
from insonify.inversion.segment_spectra import EFFICIENCY, SEGMENT, AngleGroup, SegmentSpectra
from insonify.scene import Scene
from insonify.scene.edit import edit

FINEST = 8.0  # resolution cells of the shortest wave that is fitted; a bed's own grid shapes shorter ones
ALIASES = np.arange(-2, 3)  # bands that pings far apart fold into one
COARSEST = 2  # cycles per segment that a wave needs, along or across; fewer are removed with the mean plane
STARTS = (0.8, 1.4, 2.0, 2.6)  # exponents from which the fit starts
LEVELS, EXPONENTS = (-60.0, 20.0), (0.0, 4.0)
SILENT = 1e-3  # speckle over the mean power of the record, at least: fainter waves are leakage and aliases
WIDTHS = (0.2, 0.3, 0.4, 0.55, 0.75, 1.0, 1.4, 2.0)  # degrees, of beams to try
LEAST_CORRELATION = 0.01  # of neighbouring bins, below which they are independent
SHORTEST_WAVES = 0.75  # of the highest frequency along the track, above which waves are speckle alone


class PowerLawFit(NamedTuple):
    """Spectral density A f^−2β, of both signs of the frequency f in cycles a metre."""

    log_level: float  # ln A and β
    exponent: float
    log_level_error: float  # their standard errors
    exponent_error: float


class RoughnessFit(NamedTuple):
    """Relief, patches and speckle that explain the spectra of a record."""

    relief: PowerLawFit  # heights, in m⁴ (cycles a metre)^2β
    patches: PowerLawFit | None  # logarithm of the backscatter by patches of material; None if none are fitted
    speckle: float  # variance of the relative amplitude by speckle
    cost: float  # negative logarithm of the likelihood


class _GroupModel(NamedTuple):
    """Model of the spectrum of one group: Σ over power laws and aliases of A f^−2β times a transfer, plus speckle."""

    power: Floats  # (cells,) as measured
    transfers: tuple[Floats, ...]  # (aliases, cells) of each power law
    log_squared: Floats  # (aliases, cells), ln f²
    speckle: Floats  # (cells,) for unit variance of a sample
    weight: float


def fit_roughness(
    spectra: SegmentSpectra, footprint: Footprint, *, patches: bool = False, near: RoughnessFit | None = None
) -> RoughnessFit:
    """Fit a power-law relief, on request patches of material, and speckle to the spectra of a record."""
    # A slope p along the line of sight changes the amplitude by κ p, see `Footprint.respond_to_slope`; patches change
    # it by half the logarithm of their backscatter in every direction alike. Beam, pulse and bins average both. Speckle
    # is white but for the pulse. Whittle's likelihood, Σ ln S + I/S over frequencies, weighs each frequency by its
    # information (Whittle 1953).
    models = [_group_model(group, spectra, footprint, patches) for group in spectra.groups]
    laws = len(models[0].transfers)
    noise = np.array([np.log(np.mean(model.power / model.speckle)) for model in models])
    bounds = [LEVELS, EXPONENTS] * laws + [(level + np.log(SILENT), level) for level in noise]
    exponents = STARTS if near is None else (near.relief.exponent,)
    starts = [_start(models, noise, exponent) for exponent in exponents]
    fits = [minimize(_cost, start, (models,), "L-BFGS-B", jac=True, bounds=bounds) for start in starts]
    best = min(fits, key=lambda fit: fit.fun)
    errors = np.sqrt(np.diagonal(np.linalg.pinv(_information(best.x, models))))
    found = [PowerLawFit(*best.x[2 * k : 2 * k + 2], *errors[2 * k : 2 * k + 2]) for k in range(laws)]
    speckle = float(np.exp(np.median(best.x[2 * laws :])))
    return RoughnessFit(found[0], found[1] if patches else None, speckle, float(best.fun))


def _group_model(group: AngleGroup, spectra: SegmentSpectra, footprint: Footprint, patches: bool) -> _GroupModel:
    """Model of one group at the frequencies that are fitted; both signs along the track are averaged."""
    highest = 1.0 / (FINEST * footprint.cell)
    rows = np.flatnonzero(np.abs(spectra.along[: SEGMENT // 2 + 1]) <= highest)
    columns = np.flatnonzero((spectra.across > 0.0) & (spectra.across <= highest))
    fitted = (rows[:, None] >= COARSEST) | (columns >= COARSEST)
    across = spectra.across[columns]
    cosine = float(np.sqrt(1.0 - group.sine**2))
    folded = np.abs(spectra.along[rows]) + ALIASES[:, None] * (SEGMENT * spectra.along[1])
    ground = across * cosine  # cycles per metre of ground, where dr/dx = cos θ
    squared = folded[:, :, None] ** 2 + ground**2
    averaged = footprint.average_along(folded, group.slant_range)[:, :, None] * footprint.average_across(across)
    slope = (2.0 * np.pi * footprint.respond_to_slope(group.sine) * ground) ** 2
    transfers = [averaged * slope * cosine] + [averaged * np.full_like(slope, 0.25 * cosine)] * patches
    power = 0.5 * (group.power[rows] + group.power[-rows % SEGMENT])[:, columns]
    speckle = np.broadcast_to(footprint.speckle(across) * spectra.sample, power.shape)
    return _GroupModel(
        power[fitted],
        tuple(transfer[:, fitted] for transfer in transfers),
        np.log(squared[:, fitted]),
        speckle[fitted],
        EFFICIENCY * group.segments,
    )


def _densities(parameters: Floats, level: float, model: _GroupModel) -> tuple[Floats, Floats]:
    """Whole density of a group, and its derivatives by the parameters of the power laws and the speckle's level."""
    whole = np.exp(level) * model.speckle
    parts = []
    for number, transfer in enumerate(model.transfers):
        log_level, exponent = parameters[2 * number : 2 * number + 2]
        waves = np.exp(log_level - exponent * model.log_squared) * transfer
        parts += [waves.sum(axis=0), -(waves * model.log_squared).sum(axis=0)]
        whole = whole + parts[-2]
    return whole, np.array([*parts, np.exp(level) * model.speckle])


def _groups(
    parameters: Floats, models: list[_GroupModel]
) -> Iterator[tuple[_GroupModel, list[int], tuple[Floats, Floats]]]:
    """Every group's model, indices of its parameters (all power laws, its level of speckle), and densities."""
    laws = 2 * len(models[0].transfers)
    for number, model in enumerate(models):
        yield model, [*range(laws), laws + number], _densities(parameters, parameters[laws + number], model)


def _cost(parameters: Floats, models: list[_GroupModel]) -> tuple[float, Floats]:
    """Negative logarithm of Whittle's likelihood, and its gradient."""
    total, gradient = 0.0, np.zeros_like(parameters)
    for model, places, (whole, parts) in _groups(parameters, models):
        total += model.weight * float((np.log(whole) + model.power / whole).sum())
        gradient[places] += model.weight * (parts @ ((1.0 - model.power / whole) / whole))
    return total, gradient


def _information(parameters: Floats, models: list[_GroupModel]) -> Floats:
    """Fisher information: Σ over frequencies of ∂ ln S ∂ ln S, times the independent spectra that are averaged."""
    found = np.zeros((parameters.size, parameters.size))
    for model, places, (whole, parts) in _groups(parameters, models):
        found[np.ix_(places, places)] += 2.0 * model.weight * ((parts / whole) @ (parts / whole).T)
    return found


def _start(models: list[_GroupModel], noise: Floats, exponent: float) -> Floats:
    """Parameters to start from: every part as strong as the record itself."""
    model = models[0]
    parameters: list[float] = []
    for transfer in model.transfers:
        waves = np.exp(-exponent * model.log_squared) * transfer
        parameters += [float(np.log(model.power.mean() / waves.sum(axis=0).mean())), exponent]
    return np.array([*parameters, *noise])


def estimate_pulse(spectra: SegmentSpectra, bin_length: float, sound_speed: float) -> dict[str, float | str]:
    """Pulse as plain values, by the correlation of speckle in neighbouring bins."""
    # Waves along the track that are hardly longer than the distance between pings hold speckle and little bed, least of
    # all at steep angles. Two bins one bin length Δ apart share the part 1 − Δ/L of a tone with the resolution L =
    # cτ/2, and their energies, and nearly their amplitudes, correlate as the square of it.
    shortest = np.abs(spectra.along) >= SHORTEST_WAVES * np.abs(spectra.along).max()
    lines = spectra.groups[-1].power[shortest].mean(axis=0)
    both = np.concatenate([lines, lines[-2:0:-1]])  # of both signs of the frequency
    correlation = float(np.fft.ifft(both)[1].real / np.fft.ifft(both)[0].real)
    if correlation < LEAST_CORRELATION:
        return {"kind": "ideal"}
    length = bin_length / (1.0 - min(np.sqrt(correlation), 0.95))
    return {"kind": "tone", "duration": float(f"{2.0 * length / sound_speed:.2g}")}


def estimate_beam(spectra: SegmentSpectra, scene: Scene, sound_speed: float) -> float:
    """Width of a Gaussian beam in degrees that best explains how a record averages its bed along the track."""
    costs, near = [], None
    for width in WIDTHS:
        trial = edit(scene, {"sonar.beam.kind": "gaussian", "sonar.beam.width": width})
        near = fit_roughness(spectra, footprint_of(trial, sound_speed), near=near)
        costs.append(near.cost)
    return WIDTHS[int(np.argmin(costs))]
