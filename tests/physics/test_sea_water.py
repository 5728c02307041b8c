"""Absorption and speed of sound in sea water, against published tables and through to the record."""

import math

import numpy as np
import pytest

from insonify.scene import edit, load_scene
from insonify.scene.water.absorptions import francois_garrison
from insonify.scene.water.sound_speed import EQUATIONS, mackenzie, paper, teos10
from insonify.simulation import prepare

# dB/km at pH 8, depth 0, 35 g/kg, by frequency and temperature: Francois & Garrison 1982.
TABLE = {
    100e3: {4.0: 27.536, 10.0: 33.630, 20.0: 38.059},
    400e3: {4.0: 94.257, 10.0: 96.114, 20.0: 123.625},
    900e3: {4.0: 357.095, 10.0: 299.463, 20.0: 274.234},
}
QUIET = {"seabed.relief": "flat", "targets": [], "sonar.pulse": "ideal", "track.pings": 1, "sonar.beam": "knife"}
QUIET |= {"seabed.material.diffuse": 0.2}  # at every frequency


def test_absorption_is_as_tabulated_lessened_by_pressure_and_increased_by_salt():
    for frequency, row in TABLE.items():
        assert {t: francois_garrison(frequency, t) for t in row} == pytest.approx(row, rel=1e-3), frequency
    below, above = (francois_garrison(900e3, t) for t in (20.0, 20.0 + 1e-9))
    assert above == pytest.approx(below, rel=1e-3), "pieces of pure water meet at 20 °C"
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
    """Against the integral over each bin of a level Lambert bed, 10 m below the sonar; by light without spreading."""
    scene = {"sonar.law": law, "seabed.material.specular": 0.0}
    clear, absorbing = record(scene), record({**scene, "water.absorption": 100.0})
    heard = clear > 0.0
    loss = 10.0 * np.log10(absorbing[heard] / clear[heard])
    near = np.maximum(np.arange(1000) * 0.05, 10.0)[heard]
    far = (np.arange(1000) + 1)[heard] * 0.05
    part = (np.arange(2000) + 0.5) / 2000
    if law == "sonar":
        x, end = (np.sqrt(edge**2 - 100.0) for edge in (near, far))
        r = np.hypot(x[:, None] + part * (end - x)[:, None], 10.0)
        energy = (10.0 / r) ** 2 / r**4
    else:
        r = near[:, None] + part * (far - near)[:, None]
        energy = 10.0 / r
    expected = 10.0 * np.log10((energy * 10.0 ** (-0.02 * r)).sum(axis=1) / energy.sum(axis=1))
    np.testing.assert_allclose(loss, expected, atol=1e-4)


def test_a_record_takes_the_sonars_own_depth_and_frequency():
    changes = {"water.absorption": {"kind": "francois_garrison", "temperature": 4.0}, "sonar.frequency": 900e3}
    ratio = record(changes)[900] / record({})[900]
    decibels = francois_garrison(900e3, 4.0, depth=20.0)
    assert -10.0 * math.log10(ratio) == pytest.approx(2.0 * decibels * 900.5 * 0.05 / 1e3, rel=1e-5)


def test_speeds_are_as_printed_and_agree_over_the_sea():
    for name, temperatures, depth, speeds, bound in (
        ("paper", [0.0, 10.0, 20.0], 0.0, [1449.000, 1489.800, 1521.400], 5.1e-4),
        ("mackenzie", [0.0, 10.0, 20.0], 0.0, [1448.960, 1489.803, 1521.463], 5.1e-4),
        ("teos10", [0.0, 10.0, 20.0], 0.0, [1449.025, 1489.789, 1521.480], 5.1e-4),
        ("mackenzie", [25.0], 1000.0, [1550.744], 5e-4),
        ("paper", [10.0, 20.0], 50.0, [1490.62, 1522.22], 5e-3),
    ):
        found = EQUATIONS[name](temperatures, 35.0, depth)
        np.testing.assert_allclose(found, speeds, rtol=0.0, atol=bound, err_msg=name)
    assert (np.diff(paper(np.linspace(0.0, 30.0, 61), 35.0, 0.0)) > 0.0).all()  # printed: 0.55 t², which falls
    t, s, d = (axis.ravel() for axis in np.meshgrid([2.0, 12.0, 25.0], [30.0, 35.0, 38.0], [0.0, 100.0, 1000.0]))
    assert np.abs(paper(t, s, d) - teos10(t, s, d)).max() < 0.8
    assert np.abs(mackenzie(t, s, d) - teos10(t, s, d)).max() < 0.35
