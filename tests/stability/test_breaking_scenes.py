"""Scenes named after what breaks on them: each shows its failure in numbers, in a case of the report and here."""

from __future__ import annotations

import numpy as np
import pytest

from insonify.accuracy.stability import CASES
from insonify.scene import bundled_scenes, edit, load_scene
from insonify.simulation import prepare, simulate

EVERY = [case for members in CASES.values() for case in members]


def test_every_scene_that_breaks_is_measured():
    breaking = {name for name in bundled_scenes() if name.startswith("breaks-")}
    assert breaking == {case.scene for case in EVERY if case.scene}


@pytest.mark.parametrize("case", [case for case in EVERY if case.scene], ids=lambda case: case.name)
def test_a_scene_names_the_case_that_measures_it(case):
    assert f'"{case.name}"' in " ".join(load_scene(case.scene).description.split())


def test_pings_beat_with_ripples():
    scene = edit(load_scene("breaks-beats"), {"track.pings": 256})
    wave = 50.4 / 80.0
    for speed, true in ((3.0, False), (0.3, True)):
        record = simulate(edit(scene, {"track.speed": speed})).intensity.values[0, :, 500:700].astype(np.float64)
        power = (np.abs(np.fft.rfft(record / record.mean(axis=0) - 1.0, axis=0)) ** 2).sum(axis=1)
        strongest = 256 * speed / 5.0 / (np.argmax(power[2:]) + 2)
        assert (abs(strongest / wave - 1.0) < 0.2) == true
        assert true or strongest > 4.0 * wave


def test_steps_leak_less_the_shorter_they_are():
    scene = edit(load_scene("breaks-steps"), {"track.pings": 4})
    exact = simulate(scene, method="rays", forced={"rays": "16000"}).intensity.values
    sums = {}
    for step in ("2", "0.5", "0.1"):
        record = simulate(scene, method="march", forced={"step": step}).intensity.values
        sums[step] = float(record[exact == 0.0].sum())
    assert sums["2"] > 3.0 * sums["0.5"] > 9.0 * sums["0.1"]


def test_a_place_on_the_map_changes_nothing():
    scene = edit(load_scene("breaks-terraces"), {"track.pings": 8})
    there, here = (simulate(one).intensity.values for one in (scene, edit(scene, {"world.origin": [0.0, 0.0]})))
    np.testing.assert_array_equal(there, here)


def test_next_to_no_gradient_is_none():
    scene = edit(load_scene("breaks-gradient"), {"track.pings": 4})
    weak, none = (simulate(one).intensity.values for one in (scene, edit(scene, {"water": "uniform"})))
    np.testing.assert_allclose(weak, none, rtol=1e-6, atol=0)


def test_the_bed_is_heard_to_where_the_last_ray_grazes_it():
    simulation = prepare(load_scene("breaks-grazing"))
    truth = simulation.truth(np.arange(2))
    assert np.nanmax(truth.ground_range) == pytest.approx(1095.63, abs=2.0)
