"""Receiver chain: pulse, speckle, reverberation, crosstalk, fluctuation, source level, noise, gain, recorder, in order.

Theory: docs/theory/speckle.md.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from insonify.parallel import in_parallel
from insonify.receiver.reception import Reception, Traced, spread_echoes
from insonify.receiver.waves import Waves, no_waves, split_waves, steady_waves

Record = NDArray[np.float32]
TOGETHER = 64  # pings received at a time, so that intermediate arrays stay in the processor cache


def record_echoes(
    reception: Reception,
    traced: Traced,
    pings: NDArray[np.int64],
    divided: Traced | None = None,
    out: Record | None = None,
) -> Record:
    """Turn traced echoes into a record; ``divided`` is the trace with ``reception.divided_by_shape``, if it has one."""
    record = _place_of(traced, reception.gain.size) if out is None else out

    def block(first: int, last: int) -> None:
        for low in range(first, last, TOGETHER):
            part = slice(low, min(low + TOGETHER, last))
            echoes = traced[part]
            received = receive(reception, echoes, pings[part], None if divided is None else divided[part])
            if received is not echoes or record is not traced:
                record[part] = received

    in_parallel(block, pings.size)
    return record


def _place_of(traced: Traced, bins: int) -> Record:
    """Record that may take the place of traced echoes: their own array if it holds intensities, else a new one."""
    if np.iscomplexobj(traced):
        return np.empty((*traced.shape[:2], bins), np.float32)
    return np.asarray(traced, np.float32)


def receive(reception: Reception, traced: Traced, pings: NDArray[np.int64], divided: Traced | None = None) -> Record:
    """Turn traced echoes into a record."""
    received = _sum_of_waves if reception.sums_waves else _echoes_alone
    record = received(reception, traced, pings, divided)
    if reception.amplifies:
        record = record * reception.gain.astype(np.float32)
    return record if reception.recording is None else reception.recording.record(record, pings)


def _echoes_alone(reception: Reception, traced: Traced, pings: NDArray[np.int64], divided: Traced | None) -> Record:
    """Record of echoes that meet no other waves; without speckle, mean energies of all but the noise add."""
    record = np.asarray(traced, np.float32) if reception.coherent else spread_echoes(reception.taps, traced)
    if not reception.speckled and reception.water_echoes:
        record = record + _water_echoes(reception, pings)
    record = _delayed(reception, record, pings)
    if reception.speckle is not None:
        record = record * reception.speckle.factors(pings, _inverse_shape(reception, record, divided, pings))
    if reception.crosstalk > 0.0:
        record = record + np.float32(reception.crosstalk) * record[:, ::-1]
    if reception.fluctuation is not None:
        record = record * reception.fluctuation.gains(pings)
    if reception.source != 1.0:
        record = record * np.float32(reception.source)
    if reception.disturbances is not None and not reception.speckled:
        for energy, _ in reception.disturbances.waves(pings):
            record = record + energy
    return record


def _sum_of_waves(reception: Reception, traced: Traced, pings: NDArray[np.int64], divided: Traced | None) -> Record:
    """Energy of the sum of all waves that are received, averaged over the looks."""
    record = np.zeros((pings.size, 2, reception.gain.size), np.float32)
    echo_waves = _echo_waves(reception, traced, pings, divided)
    reverberation, noise = _background(reception, pings)
    for look in range(reception.looks):
        waves = echo_waves(look)
        if reception.speckled and reception.crosstalk > 0.0:
            if reverberation is not None:
                reception.reverberation_field.add_to(waves, reverberation, pings, look)
            waves.leak(reception.crosstalk)
        if reception.disturbances is not None and reception.speckled:
            for energy, turns in reception.disturbances.waves(pings):
                waves.add(energy, turns)
        if noise is not None:
            reception.noise_field.add_to(waves, noise, pings, look)
        waves.detect_into(record, 1.0 / reception.looks)
    return record


def _echo_waves(
    reception: Reception, traced: Traced, pings: NDArray[np.int64], divided: Traced | None
) -> Callable[[int], Waves]:
    """Waves of the echoes by the number of the look, at the level of the source."""
    if not reception.speckled:
        steady = steady_waves(_echoes_alone(reception, traced, pings, divided))
        return lambda look: steady
    level = _level(reception, pings)
    if reception.speckle is None:
        waves = split_waves(traced * np.sqrt(level))
        if reception.fluctuation is not None:
            waves = reception.fluctuation.shift_waves(waves, pings, reception.samples)
        return lambda look: waves
    speckle, record = reception.speckle, _delayed(reception, spread_echoes(reception.taps, traced), pings)
    mean = level * speckle.textured(record, pings, _inverse_shape(reception, record, divided, pings))

    def speckled(look: int) -> Waves:
        waves = no_waves(pings.size, mean.shape[2])
        speckle.field.add_to(waves, mean, pings, look)
        return waves

    return speckled


def _background(reception: Reception, pings: NDArray[np.int64]) -> tuple[Record | None, Record | None]:
    """Mean energies of the waves that add before and after crosstalk, (n or 1, 1 or 2, samples), or None.

    Without crosstalk the water's waves and the noise, both Gaussian and new in every ping, are drawn as one.
    """
    water = _water_energy(reception, pings)
    noise = np.full((1, 1, reception.gain.size), reception.noise, np.float32) if reception.noise > 0.0 else None
    if water is not None and reception.crosstalk == 0.0:
        noise, water = water + np.float32(reception.noise), None
    return _sampled(water, reception.samples), _sampled(noise, reception.samples)


def _water_energy(reception: Reception, pings: NDArray[np.int64]) -> Record | None:
    """Mean energy of what echoes in the water, speckled, (n, 1 or 2, bins); None where nothing does."""
    if not reception.speckled or not reception.water_echoes:
        return None
    return _level(reception, pings) * _delayed(reception, _water_echoes(reception, pings), pings)


def _water_echoes(reception: Reception, pings: NDArray[np.int64]) -> Record:
    """Mean echoes of water, surface, schools and plumes after the pulse, (n, 1 or 2, bins)."""
    echoes = np.tile(reception.reverberation.astype(np.float32), (pings.size, 1, 1))
    if reception.volumes is None:
        return echoes
    return echoes + spread_echoes(reception.taps, reception.volumes.energy(pings))


def _sampled(energy: Record | None, samples: int) -> Record | None:
    """Energies of bins, repeated for each of their samples."""
    return energy if energy is None or samples == 1 else np.repeat(energy, samples, axis=2)


def _level(reception: Reception, pings: NDArray[np.int64]) -> Record:
    """Factor of intensity by which source level and fluctuation raise every ping, (n or 1, 1, 1)."""
    source = np.full((1, 1, 1), reception.source, np.float32)
    return source if reception.fluctuation is None else source * reception.fluctuation.gains(pings)


def _inverse_shape(
    reception: Reception, record: Record, divided: Traced | None, pings: NDArray[np.int64]
) -> Record | None:
    """Mean of 1/ν over the echoes of a bin, weighted by their energy; None where the receiver's own ν holds."""
    if divided is None:
        return None
    weighted = _delayed(reception, spread_echoes(reception.taps, divided), pings)
    return np.divide(weighted, record, out=np.zeros_like(record), where=record > 0.0)


def _delayed(reception: Reception, record: Record, pings: NDArray[np.int64]) -> Record:
    """Record with its pings delayed as they fluctuate."""
    return record if reception.fluctuation is None else reception.fluctuation.shifted(record, pings)
