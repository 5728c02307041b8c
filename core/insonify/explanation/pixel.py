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

from insonify.acoustics.bed_materials import find_material, misfit
from insonify.arrays import Floats, Integers, Singles
from insonify.explanation.pixel_parts import PixelParts, find_athwart_parts, find_pixel_parts
from insonify.explanation.sound_paths import SonarPose
from insonify.explanation.words import PATH_NAMES
from insonify.kernels.common.types import LIGHT, SceneArrays
from insonify.kernels.labels.echo_parts import BEHIND_BED, VISIBLE
from insonify.receiver import Reception, Traced, record_echoes
from insonify.scene import SceneError
from insonify.simulation import Simulation
from insonify.tracers import sweep
from insonify.tracers.echo_parts import EchoParts
from insonify.tracers.labels import PATHS
from insonify.tracers.plane_counts import TracedPings

AS_LOUD = 0.9  # of the loudest part
SHADOW = 0.5  # share of the echo that is hidden from which a pixel counts as shadow
SPREAD = 0.95  # share of the first source below which the second is named too
NEGLIGIBLE = 1e-3  # dB, of a term of the tracer that is not listed
SILENCE = -math.inf
# Least level in dB over a level bed at the same range, and the word for it.
TONES = ((6.0, "Very bright"), (2.0, "Bright"), (-2.0, "As bright as a level bed"), (-8.0, "Dim"), (-math.inf, "Dark"))
# Least angle of incidence in degrees, and the words for it.
ANGLES = ((75.0, ", almost grazing"), (60.0, ", at a low angle"), (30.0, ""), (0.0, ", almost head-on"))


@dataclass(frozen=True, eq=False)
class Contribution:
    """Source of a part of the pixel's echo."""

    source: str  # ``pipe 1``, ``bed``, ``sea surface``
    material: str  # empty where there is none
    path: str  # of `insonify.tracers.labels.PATHS`
    target: int  # index of the declared target, -1 for the bed and the sea surface
    row: int  # index among the materials of the scene, -1 without a material
    share: float  # of the mean echo in the pixel
    ground_range: float  # means weighted by the echo, m and degrees
    incidence: float
    parts: EchoParts  # of which it is made
    places: Floats  # (n, 2, 3) beginnings and ends of the parts, in local coordinates, m
    rays: tuple[Floats, ...]  # path of the sound to the loudest parts, and the way back where it differs

    @property
    def words(self) -> str:
        """Source, material and path in words."""
        what = ", ".join(filter(None, (self.source, self.material)))
        if self.path == "direct":
            return what
        return PATH_NAMES[self.path] if self.path == "surface" else f"{PATH_NAMES[self.path]} ({what})"


def find_contributions(pixel: PixelParts) -> tuple[Contribution, ...]:
    """Find the sources of the echo in a pixel, the greatest first."""
    echoing = pixel.parts.take((pixel.parts.state == VISIBLE) & (pixel.parts.value > 0.0))
    if not echoing.value.size:
        return ()
    kinds = np.column_stack([echoing.path, echoing.target, echoing.material])
    keys, which = np.unique(kinds, axis=0, return_inverse=True)
    total = float(echoing.value.sum())
    found = [_contribution(pixel, echoing.take(which.ravel() == k), total) for k in range(len(keys))]
    return tuple(sorted(found, key=lambda each: -each.share))


def _contribution(pixel: PixelParts, parts: EchoParts, total: float) -> Contribution:
    path, target, row = int(parts.path[0]), int(parts.target[0]), int(parts.material[0])
    cosine = float(np.average(parts.cosine, weights=parts.value))
    return Contribution(
        source=pixel.name(target, path),
        material=pixel.material(row),
        path=PATHS[path],
        target=target,
        row=row,
        share=float(parts.value.sum()) / total,
        ground_range=float(np.average(parts.middle[:, 0], weights=parts.value)),
        incidence=math.degrees(math.acos(min(max(cosine, -1.0), 1.0))),
        parts=parts,
        places=pixel.segments(parts),
        rays=pixel.rays(parts),
    )


@dataclass(frozen=True, eq=False)
class Obstruction:
    """Target or crest that hides a part of the bed from the pixel."""

    hider: str  # ``pipe 1``, or ``crest of the bed``
    target: int  # index of the declared target, -1 for the bed
    place: Floats  # (3,) crest of the bed, or middle of the bed that a target hides, in local coordinates, m
    ground_range: float  # of that place, m
    share: float  # of the echo that the pixel would have without obstructions
    echo: float  # mean echo that the hidden bed would add, in the units of the parts
    places: Floats  # (n, 2, 3) the hidden bed
    rays: tuple[Floats, ...]  # from the sonar to the hidden bed, through the obstruction

    @property
    def faces_away(self) -> bool:
        """Whether the hidden bed is a slope that faces away from the sonar and would return nothing anyway."""
        return not self.echo > 0.0


def find_obstructions(pixel: PixelParts) -> tuple[Obstruction, ...]:
    """Find the obstructions that hide bed from a pixel, the greatest first."""
    parts = pixel.parts
    hidden = parts.take(parts.state != VISIBLE)
    whole = float(parts.value.sum())
    hiders = np.where(hidden.state == BEHIND_BED, -1, hidden.hider)
    found = [_obstruction(pixel, hidden.take(hiders == who), int(who), whole) for who in np.unique(hiders)]
    return tuple(sorted(found, key=lambda each: -each.share))


def _obstruction(pixel: PixelParts, parts: EchoParts, who: int, whole: float) -> Obstruction:
    echo = float(parts.value.sum())
    # Of planes that are nearly as loud, the one nearest to the axis.
    is_loud = parts.value >= AS_LOUD * parts.value.max()
    loudest = int(np.argmin(np.where(is_loud, np.abs(parts.azimuth), np.inf)))
    place = parts.crest[loudest] if who < 0 else parts.middle[loudest]
    return Obstruction(
        hider=pixel.name(who) if who >= 0 else "crest of the bed",
        target=who,
        place=pixel.sonar.to_world(float(parts.azimuth[loudest]), place[None])[0],
        ground_range=float(place[0]),
        share=echo / whole if whole > 0.0 else 0.0,
        echo=echo,
        places=pixel.segments(parts),
        rays=pixel.rays(parts),
    )


def summarise_pixel(
    pixel: PixelParts, contributions: Sequence[Contribution], obstructions: Sequence[Obstruction]
) -> str:
    """Describe in one sentence what a pixel shows, or why it is dark."""
    hiding = sum(each.share for each in obstructions)
    if obstructions and (hiding >= SHADOW or not contributions):
        return _shadow(obstructions[0], bool(contributions))
    if not contributions:
        return _silence(pixel)
    first = contributions[0]
    sentence = f"{first.words} at {first.ground_range:.1f} m, incidence {first.incidence:.0f}°"
    if first.share < SPREAD:
        sentence = f"{100 * first.share:.0f} % {sentence}; then {contributions[1].words}"
    return sentence


def _shadow(greatest: Obstruction, echoing: bool) -> str:
    """Sentence that names the greatest obstruction."""
    if greatest.faces_away:
        return f"no echo: the slope behind the crest at {greatest.ground_range:.1f} m faces away from the sonar"
    mostly = "mostly in the shadow" if echoing else "in the shadow"
    if greatest.target >= 0:
        return f"{mostly} of {greatest.hider}, which hides the bed at {greatest.ground_range:.1f} m"
    return f"{mostly} of a crest of the bed at {greatest.ground_range:.1f} m"


def _silence(pixel: PixelParts) -> str:
    """Sentence that explains a pixel without an echo where nothing is hidden."""
    if pixel.folded:
        return "no echo: no ray lands there"
    _, parts = find_athwart_parts(pixel.arrays, pixel.pose, pixel.side, 1)
    first = math.inf if parts is None else float(parts.near[parts.state == VISIBLE].min(initial=math.inf))
    if (pixel.window.first + pixel.window.weights.shape[1]) * pixel.arrays.bin_length <= first:
        return f"water column: the first echo comes from {first:.1f} m" if math.isfinite(first) else "no bed in range"
    if pixel.parts.value.size == 0:
        return "no echo: no bed there"
    return "no echo: outside the beam" if not np.any(pixel.parts.weight > 0.0) else "no echo: the slope faces away"


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
    error: float = math.nan  # estimated error of the side of the ping, as a share of its record; NaN if not known
    bin_error: float = math.nan  # of the pixel, as a share of its mean echo; NaN if not known or without an echo

    @property
    def level(self) -> float:
        """Level of the pixel in the record, dB."""
        return decibels(self.value)

    def describe_brightness(self, amplitude: float | None) -> str:
        """Sentence on why a pixel is bright or dark, given its amplitude relative to a level bed, if known."""
        level = 20.0 * math.log10(amplitude) if amplitude else -math.inf
        tone = next(word for least, word in TONES if level >= least)
        hiders, echoes = self.obstructions, self.contributions
        if hiders and (not echoes or sum(each.share for each in hiders) >= 0.5):
            hider = hiders[0]
            if hider.faces_away:
                return (
                    f"Dark because the slope behind the crest at {hider.ground_range:.1f} m faces away from the sonar."
                )
            name = f"a {hider.hider}" if hider.target < 0 else hider.hider
            return f"{tone} because the bed here lies in the shadow of {name}."
        if not echoes:
            return f"Dark because nothing here returns the sound ({self.summary})."
        first = echoes[0]
        if first.path != "direct":
            return f"{tone}: {first.words} arrives here, later than the direct one."
        what = (
            first.material if first.source == "bed" or not first.material else f"the {first.material} of {first.source}"
        )
        met = f"the sound meets {what or first.source} at {first.incidence:.0f}°"
        met += next(words for least, words in ANGLES if first.incidence >= least)
        causes = (
            first.incidence >= 60.0 if level < -2.0 else level >= 2.0 and (first.target >= 0 or first.incidence < 45.0)
        )
        return f"{tone} because {met}." if causes else f"{tone}: {met}."


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
        raise SceneError(f"ping: {ping} is negative; give a number from 0")
    if side not in (0, 1):
        raise SceneError(f"side: {side} is not known; give 0 (port) or 1 (starboard)")
    if not 0 <= pixel < simulation.reduced.bins:
        raise SceneError(f"bin: {pixel} is outside the record; give one from 0 to {simulation.reduced.bins - 1}")
    parts = find_pixel_parts(simulation, ping, side, pixel)
    poses = simulation.poses(np.array([ping], dtype=np.int64))
    traced = simulation.trace_pings(poses, of_bins=simulation.estimates_errors)
    stages = record_by_stages(simulation, ping, int(traced.planes[0]))
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
        error=float(simulation.errors(traced.squares)[0, side]),
        bin_error=float(_relative_errors(simulation, traced)[0, side, pixel])
        if simulation.estimates_errors
        else math.nan,
    )


def find_bin_errors(simulation: Simulation, pings: Integers) -> Singles:
    """Estimated errors of the bins of pings as shares of their mean echoes, (n, 2, bins); NaN where not known."""
    traced = simulation.trace_pings(simulation.poses(pings), of_bins=simulation.estimates_errors)
    return _relative_errors(simulation, traced)


def _relative_errors(simulation: Simulation, traced: TracedPings) -> Singles:
    relative = np.full(traced.echoes.shape, np.nan, np.float32)
    if not simulation.estimates_errors:
        return relative
    echoes = traced.echoes * simulation.reception.gain
    return np.divide(simulation.bin_errors(traced), echoes, out=relative, where=echoes > 0.0)


def _echo_terms(parts: PixelParts, contributions: Sequence[Contribution]) -> list[Term]:
    """Terms of the greatest contribution and one for all others; an empty list without an echo."""
    if not contributions:
        return []
    first, light = contributions[0], parts.arrays.law == LIGHT
    diffuse, specular, shininess = parts.arrays.reflectivity[first.row].tolist() if first.row >= 0 else (0.0, 0.0, 0.0)
    normal = diffuse + specular if light else (diffuse + specular * (shininess + 2.0) / 2.0) / math.pi
    terms = echo_terms(first.parts, normal, light=light)
    material, frequency = find_material(parts.simulation.scene, first.row), parts.simulation.scene.sonar.frequency
    if material is not None and not light:
        off = misfit(material, frequency, np.array(math.radians(90.0 - first.incidence)))
        if off is not None:
            over = f"{float(off):+.1f} dB over the backscatter model"
            terms = [replace(one, detail=f"{one.detail}, {over}") if one.name == "incidence" else one for one in terms]
    if len(contributions) > 1:
        terms.append(Term("other echoes", decibels(1.0 / first.share), f"{len(contributions) - 1} more contributions"))
    return terms


def decibels(ratio: float) -> float:
    """Decibels of a ratio of powers; minus infinity for 0."""
    return 10.0 * math.log10(ratio) if ratio > 0.0 else SILENCE


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
    azimuth = math.degrees(np.average(local.azimuth, weights=local.echo))
    way = "athwart" if abs(azimuth) < 0.005 else f"{abs(azimuth):.2f}° towards the {'bow' if azimuth > 0 else 'stern'}"
    terms = [
        Term("beam along the track", decibels(beam / by_vertical), way),
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


def _with_receiver(terms: list[Term], stages: Sequence[ReceiverStage], side: int, pixel: int) -> list[Term]:
    """Budget with the receiver's terms, the source level first."""
    levels = [decibels(float(stage.record[side, pixel])) for stage in stages]
    budget, total = list(terms), sum(term.decibels for term in terms) if terms else SILENCE
    if levels[0] > SILENCE and abs(levels[0] - total) > NEGLIGIBLE:
        change = levels[0] - total if terms else levels[0]
        budget.append(Term("tracing", change, "difference between the record and the sum of these parts"))
    elif terms and levels[0] == SILENCE:
        budget = []
    for before, after, stage in zip(levels, levels[1:], stages[1:]):
        if before > SILENCE:
            term = Term(stage.name, after - before, stage.detail)
        elif after > SILENCE:
            term = Term(stage.name, after, f"{stage.detail}; nothing else is there")
        else:
            continue
        budget.insert(0 if stage.name == "source level" else len(budget), term)
    return budget


def _approximations(parts: PixelParts, contributions: Sequence[Contribution]) -> tuple[str, ...]:
    """List the differences from the record."""
    simulation, notes = parts.simulation, []
    if simulation.plan.method != "sweep":
        notes.append("parts come from the sweep, the record from single rays; the term 'tracing' is the difference")
    elif parts.folded:
        notes.append("several rays reach one place: the parts are single rays, and bed hidden by bed is not listed")
    if simulation.reception.coherent:
        notes.append("parts are mean echoes; the term 'speckle' is the interference of single scatterers")
    if any(each.path != "direct" for each in contributions):
        notes.append("an echo by way of the sea surface is listed at its strongest place")
    return tuple(notes)


class ReceiverStage(NamedTuple):
    """The record of one ping after a stage of the receiver."""

    name: str  # empty for the echo of the pulse alone
    detail: str
    record: Singles  # (2, bins) linear intensity


def record_by_stages(simulation: Simulation, ping: int, planes: int) -> list[ReceiverStage]:
    """Record one ping, by its planes, without the receiver's stages, then with the first, the first two, and so on."""
    pings, whole = np.array([ping], dtype=np.int64), simulation.reception
    poses = simulation.poses(pings)
    kept: dict[tuple[int, bool, bool], Traced] = {}  # each trace is made once

    def trace(arrays: SceneArrays, reception: Reception) -> Traced:
        waves = bool(reception.sums_waves and reception.coherent)
        key = id(arrays.reflectivity), reception.coherent, waves
        if key not in kept:
            # The mean energy of the scatterers where the receiver up to a stage is not coherent.
            tracer, settings = simulation.tracer, simulation.settings_of(np.array([planes]))
            call: Callable[..., Traced] = (tracer.trace_waves if waves else None) or tracer.trace
            if whole.coherent and not reception.coherent:
                call = sweep.trace
            kept[key] = simulation.tiles.map(lambda tile, some: (call(tile, some, **settings),), arrays, poses)[0]
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
