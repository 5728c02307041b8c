"""How well known beds are learned from their records, printed: run with `pytest -m bench -s tests/bench`."""

from time import perf_counter

import numpy as np
import pytest

from insonify import learn, simulate
from known_beds import draw_bed, errors

pytestmark = pytest.mark.bench
SEEDS = range(300, 324)
BOUNDS = np.array([0.15, 0.2, 1.0])  # of β, of the rms slope as a share, of the level in dB


def test_known_beds_are_learned(say):
    found = []
    for seed in SEEDS:
        truth = draw_bed(seed)
        record, begin = simulate(truth), perf_counter()
        learned = learn(record).scene
        took = perf_counter() - begin
        found.append(errors(truth, learned))
        beta, slope, level = found[-1]
        kinds = f"speckle {truth.receiver.speckle.kind} → {learned.receiver.speckle.kind}"
        say(
            f"{seed}: β {truth.seabed.relief.beta:.2f} {beta:+.2f}, slope {slope:+.0%}, level {level:+.2f} dB; "
            f"altitude {truth.altitude:g} m, {truth.sonar.beam.words}, {kinds}, {took:.1f} s"
        )
    off = np.abs(np.array(found))
    within = off <= BOUNDS
    say(
        f"median {np.median(off, axis=0).round(3)}, greatest {off.max(axis=0).round(3)}; "
        f"within {BOUNDS}: {within.mean(axis=0).round(2)}, in all three {within.all(axis=1).mean():.2f}\n"
    )
    assert (np.median(off, axis=0) <= 0.5 * BOUNDS).all()
    assert within.mean() >= 0.9
