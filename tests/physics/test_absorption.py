"""Absorption of sea water, against published tables and through to the record."""

from __future__ import annotations

import math

import numpy as np
import pytest

from insonify.scene import edit, load_scene
from insonify.scene.water.absorptions import francois_garrison
from insonify.simulation import prepare

# dB/km at pH 8, depth 0, 35 g/kg, by frequency and temperature: Francois & Garrison 1982.
TABLE = {
    100e3: {4.0: 27.536, 10.0: 33.630, 20.0: 38.059},
    400e3: {4.0: 94.257, 10.0: 96.114, 20.0: 123.625},
    900e3: {4.0: 357.095, 10.0: 299.463, 20.0: 274.234},
}
CASES = [(frequency, t, decibels) for frequency, row in TABLE.items() for t, decibels in row.items()]
QUIET = {"seabed.relief": "flat", "targets": [], "sonar.pulse": "ideal", "track.pings": 1, "sonar.beam": "knife"}


@pytest.mark.parametrize(("frequency", "temperature", "decibels"), CASES)
def test_against_the_table(frequency, temperature, decibels):
    assert francois_garrison(frequency, temperature) == pytest.approx(decibels, rel=1e-3)


def test_pieces_of_pure_water_meet_at_20_degrees():
    below, above = (francois_garrison(900e3, t) for t in (20.0, 20.0 + 1e-9))
    assert above == pytest.approx(below, rel=1e-3)


def test_pressure_lessens_and_salt_increases_it():
    surface = francois_garrison(100e3, 10.0)
    assert francois_garrison(100e3, 10.0, depth=1000.0) < surface
    assert francois_garrison(100e3, 10.0, salinity=38.0) > surface
    # Boric acid, the only part that knows pH, rules low frequencies.
    assert francois_garrison(1e3, 10.0, acidity=8.3) > 1.5 * francois_garrison(1e3, 10.0, acidity=7.9)
    assert 0.0 < francois_garrison(100e3, 10.0, salinity=0.0) < 0.2 * surface


def record(changes):
    return prepare(edit(load_scene("default"), {**QUIET, **changes})).intensity(np.array([0]))[0, 0].astype(float)


@pytest.mark.parametrize("law", ["sonar", "light"])
def test_a_record_loses_twice_the_way(law):
    clear, absorbing = record({"sonar.law": law}), record({"sonar.law": law, "water.absorption": 100.0})
    r = (np.arange(1000) + 0.5) * 0.05
    heard = clear > 0.0
    loss = 10.0 * np.log10(absorbing[heard] / clear[heard])
    np.testing.assert_allclose(loss, -2.0 * r[heard] * 0.1, atol=1e-4)


def test_a_record_takes_the_sonars_own_depth_and_frequency():
    changes = {"water.absorption": {"kind": "francois_garrison", "temperature": 4.0}, "sonar.frequency": 900e3}
    ratio = record(changes)[900] / record({})[900]
    decibels = francois_garrison(900e3, 4.0, depth=20.0)
    assert -10.0 * math.log10(ratio) == pytest.approx(2.0 * decibels * 900.5 * 0.05 / 1e3, rel=1e-5)
