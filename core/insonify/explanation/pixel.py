"""Explanation of one pixel of a record: its budget, the factors in decibels that add up to its level.

The echo of the parts i of a contributor is Σ σ_i g_i b_i A_i T_i: scattering strength, gain of refraction, response of
the beam, area, and the factor of the range. Each term is a mean weighted by what remains of the sum without it, so that
the product of the means is the sum itself:

    T = Σ value / Σ echo,  σ = Σ echo / Σ g b A,  g = Σ g b A / Σ b A,  b = Σ b² A / Σ b A,  A = (Σ b A)² / Σ b² A

The area is thus the one that returns as much at the mean response of the beam, weighted by the echo.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from insonify.acoustics.bed_materials import find_material, misfit
from insonify.explanation.contributions import (
    Contribution,
    Obstruction,
    find_contributions,
    find_obstructions,
    summarise_pixel,
)
from insonify.explanation.pixel_parts import PixelParts, find_pixel_parts
from insonify.explanation.sound_paths import SonarPose
from insonify.kernels.common.types import LIGHT, Poses, SceneArrays
from insonify.receiver import Reception, Traced, record_echoes
from insonify.scene import SceneError
from insonify.simulation import Simulation
from insonify.tracers import sweep
from insonify.tracers.echo_parts import EchoParts

NEGLIGIBLE = 1e-3  # dB, of a term of the tracer that is not listed
Record = NDArray[np.float32]
Column = NDArray[np.float64]
SILENCE = -math.inf


@dataclass(frozen=True)
class Term:
    """One term of a budget."""

    name: str  # ``spreading``, ``absorption``, …
    decibels: float
    detail: str = ""  # its cause, in few words


@dataclass(frozen=True, eq=False)
class PixelExplanation:
    """Explanation of one pixel."""

    ping: int  # the pixel; port is side 0
    side: int
    bin: int
    slant_range: float  # of its centre as recorded, m
    value: float  # linear intensity in the record
    # Decibels that add up to the value: of the greatest contribution, of the others, then of the receiver.
    terms: tuple[Term, ...]
    contributions: tuple[Contribution, ...]  # by share, the greatest first
    obstructions: tuple[Obstruction, ...]  # by share, the greatest first
    # Level in dB of the mean echo without obstructions, with source level and gain; minus infinity for silence.
    unhidden: float
    sonar: SonarPose  # the sonar at that ping
    summary: str  # one sentence: the source of the echo, or why there is none
    approximations: tuple[str, ...]  # differences from the record; empty where the explanation is exact

    @property
    def level(self) -> float:
        """Level of the pixel in the record, dB."""
        return decibels(self.value)


def explain_pixel(simulation: Simulation, ping: int, side: int, pixel: int) -> PixelExplanation:
    """Explain one pixel of a simulation's record.

    Parameters
    ----------
    simulation : Simulation
        From `insonify.prepare`.
    ping : int
        Number of the ping.
    side : int
        0 port, 1 starboard.
    pixel : int
        Range bin, from 0.

    Returns
    -------
    PixelExplanation

    Raises
    ------
    SceneError
        If the record has no such pixel, or the sonar is inside a target.
    """
    if ping < 0:
        raise SceneError(f"ping: {ping} is before the first; give a number from 0")
    if side not in (0, 1):
        raise SceneError(f"side: {side} is neither port (0) nor starboard (1); give one of both")
    if not 0 <= pixel < simulation.reduced.bins:
        raise SceneError(f"bin: {pixel} is outside the record; give one from 0 to {simulation.reduced.bins - 1}")
    parts = find_pixel_parts(simulation, ping, side, pixel)
    stages = record_by_stages(simulation, ping)
    contributions, obstructions = find_contributions(parts), find_obstructions(parts)
    terms = _echo_terms(parts, contributions)
    return PixelExplanation(
        ping=ping,
        side=side,
        bin=pixel,
        slant_range=(pixel + 0.5) * simulation.scene.sonar.range / simulation.scene.sonar.bins,
        value=float(stages[-1].record[side, pixel]),
        terms=tuple(_with_receiver(terms, stages, side, pixel)),
        contributions=contributions,
        obstructions=obstructions,
        unhidden=decibels(float(parts.parts.value.sum()) * float(simulation.reception.gain[pixel])),
        sonar=parts.sonar,
        summary=summarise_pixel(parts, contributions, obstructions),
        approximations=_approximations(parts, contributions),
    )


def _echo_terms(parts: PixelParts, contributions: Sequence[Contribution]) -> list[Term]:
    """Terms of the greatest contribution and one for all others; an empty list without an echo."""
    if not contributions:
        return []
    first, light = contributions[0], parts.arrays.law == LIGHT
    normal = normal_strength(parts.arrays.reflectivity[first.row], light=light) if first.row >= 0 else 0.0
    terms = echo_terms(first.parts, normal, light=light)
    material, frequency = find_material(parts.simulation.scene, first.row), parts.simulation.scene.sonar.frequency
    if material is not None and not light:
        off = misfit(material, frequency, np.array(math.radians(90.0 - first.incidence)))
        terms = [_over_model(term, off) for term in terms]
    if len(contributions) > 1:
        terms.append(Term("other echoes", decibels(1.0 / first.share), f"{len(contributions) - 1} more contributions"))
    return terms


def _over_model(term: Term, off: Column | None) -> Term:
    """Add the level over the backscatter model to the detail of the term of incidence."""
    if term.name != "incidence" or off is None:
        return term
    return replace(term, detail=f"{term.detail}, {float(off):+.1f} dB over the backscatter model")


def decibels(ratio: float) -> float:
    """Decibels of a ratio of powers; minus infinity for 0."""
    return 10.0 * math.log10(ratio) if ratio > 0.0 else SILENCE


def normal_strength(reflectivity: Column, *, light: bool) -> float:
    """Scattering strength of a material at normal incidence."""
    diffuse, specular, shininess = (float(number) for number in reflectivity)
    return diffuse + specular if light else (diffuse + specular * (shininess + 2.0) / 2.0) / math.pi


def echo_terms(parts: EchoParts, normal: float, *, light: bool) -> list[Term]:
    """Terms of the echo of some parts in a pixel, before source level and receiver."""
    echo, spread, value = parts.echo.sum(), parts.spread.sum(), parts.value.sum()
    middle = float(np.average(0.5 * (parts.near + parts.far), weights=parts.value))
    terms = [
        Term("spreading", decibels(spread / echo), f"there and back over {middle:.2f} m"),
        Term("absorption", decibels(value / spread), f"there and back over {middle:.2f} m"),
    ]
    if not np.isfinite(parts.weight).all():
        return [*terms, Term("strength and area", decibels(echo), "by a path that is not straight: as one term")]
    return [*terms, *_local_terms(parts, normal, light)]


def _local_terms(parts: EchoParts, normal: float, light: bool) -> list[Term]:
    """Terms of beam, refraction, material, incidence and area."""
    local = parts.take((parts.echo > 0.0) & (parts.strength > 0.0) & (parts.width > 0.0) & (parts.gain > 0.0))
    echo, vertical = parts.echo.sum(), local.vertical
    response = local.weight / (local.gain * local.width)
    b_area = local.echo / (local.strength * local.gain)  # b A
    beam, by_vertical = np.average(response, weights=b_area), np.average(vertical, weights=b_area)
    gain = np.average(local.gain, weights=b_area)
    strength = echo / (b_area * local.gain).sum()
    incidence = math.degrees(math.acos(min(float(np.average(local.cosine, weights=local.value)), 1.0)))
    terms = [
        Term("beam along the track", decibels(beam / by_vertical), _off_axis(local)),
        Term(
            "beam vertically",
            decibels(by_vertical),
            f"{-math.degrees(np.average(local.launch, weights=local.echo)):.1f}° down",
        ),
        Term("material", decibels(normal), "strength at normal incidence"),
        Term("incidence", decibels(strength / normal), f"{incidence:.0f}° from the normal"),
    ]
    if gain != 1.0:
        terms.insert(2, Term("refraction", decibels(gain), "bent rays diverge or focus"))
    area = b_area.sum() / beam
    of_area = Term("share of the bin", decibels(area), f"{area:.3g} of beam and bin")
    return [*terms, of_area if light else Term("area", decibels(area), f"{area:.3g} m² in the pixel")]


def _off_axis(parts: EchoParts) -> str:
    """Direction of the echo from athwart, in words."""
    azimuth = math.degrees(np.average(parts.azimuth, weights=parts.echo))
    return "athwart" if abs(azimuth) < 0.005 else f"{abs(azimuth):.2f}° towards the {'bow' if azimuth > 0 else 'stern'}"


def _with_receiver(terms: list[Term], stages: Sequence[ReceiverStage], side: int, pixel: int) -> list[Term]:
    """Budget with the receiver's terms, the source level first."""
    levels = [decibels(float(stage.record[side, pixel])) for stage in stages]
    budget, total = list(terms), sum(term.decibels for term in terms) if terms else SILENCE
    if levels[0] > SILENCE and abs(levels[0] - total) > NEGLIGIBLE:
        change = levels[0] - total if terms else levels[0]
        budget.append(Term("tracing", change, "between the tracer and these parts"))
    elif terms and levels[0] == SILENCE:
        budget = []
    for before, after, stage in zip(levels, levels[1:], stages[1:]):
        term = _change(stage.name, before, after, stage.detail)
        if term is not None:
            budget.insert(0 if stage.name == "source level" else len(budget), term)
    return budget


def _change(name: str, before: float, after: float, detail: str) -> Term | None:
    """Term of a change of level; where there was silence before, the level itself; None where silence lasts."""
    if before == SILENCE:
        return None if after == SILENCE else Term(name, after, f"{detail}; nothing else is there")
    return Term(name, after - before, detail)


def _approximations(parts: PixelParts, contributions: Sequence[Contribution]) -> tuple[str, ...]:
    """List the differences from the record."""
    simulation, notes = parts.simulation, []
    if simulation.plan.method != "sweep":
        notes.append("parts come from the sweep's planes, the record from single rays: the term 'tracing' is the rest")
    elif parts.folded:
        notes.append("refraction folds: parts are single rays, and bed that other bed hides is not listed")
    if simulation.reception.coherent:
        notes.append("parts are mean echoes; the term 'speckle' is the interference of single scatterers")
    if any(each.path != "direct" for each in contributions):
        notes.append("an echo by way of the sea surface is placed where its plane returns most")
    return tuple(notes)


class ReceiverStage(NamedTuple):
    """The record of one ping after a stage of the receiver."""

    name: str  # empty for the echo of the pulse alone
    detail: str
    record: Record  # (2, bins) linear intensity


def record_by_stages(simulation: Simulation, ping: int) -> list[ReceiverStage]:
    """Record one ping without the receiver's stages, then with the first, the first two, and so on."""
    pings, whole = np.array([ping], dtype=np.int64), simulation.reception
    poses = simulation.poses(pings)
    kept: dict[tuple[int, bool, bool], Traced] = {}  # each trace is made once

    def trace(arrays: SceneArrays, reception: Reception) -> Traced:
        waves = bool(reception.sums_waves and reception.coherent)
        key = id(arrays.reflectivity), reception.coherent, waves
        if key not in kept:
            kept[key] = _trace_ping(simulation, arrays, poses, coherent=reception.coherent, waves=waves)
        return kept[key].copy()

    records = []
    for count in range(len(whole.stages) + 1):
        reception, arrays = replace(whole, stages=whole.stages[:count]), simulation.reduced
        traced, shapes = trace(arrays, reception), reception.divided_by_shape
        divided = None if shapes is None else trace(arrays._replace(reflectivity=shapes), reception)
        record = record_echoes(reception, traced, pings, divided, np.empty((1, 2, arrays.bins), np.float32))[0]
        last = whole.stages[count - 1] if count else None
        records.append(ReceiverStage(last.name, last.detail, record) if last else ReceiverStage("", "", record))
    return records


def _trace_ping(simulation: Simulation, arrays: SceneArrays, poses: Poses, *, coherent: bool, waves: bool) -> Traced:
    """Trace one ping, for the mean energy of the scatterers where the receiver up to a stage is not coherent."""
    tracer, settings = simulation.tracer, simulation.plan.settings
    trace: Callable[..., Traced] = (tracer.trace_waves if waves else None) or tracer.trace
    if simulation.reception.coherent and not coherent:
        trace = sweep.trace
    return simulation.tiles.map(lambda tile, some: (trace(tile, some, **settings),), arrays, poses)[0]
