"""Levels of surface multipath in closed form against the records that hold it."""

from __future__ import annotations

import numpy as np
import pytest

from insonify.accuracy.record_errors import compare_records
from insonify.planning import fitted_laws, plan
from insonify.planning.multipath_errors import MultipathErrors
from insonify.planning.predicted_errors import PredictedErrors
from insonify.planning.scene_summary import summarise_scene
from insonify.scene import edit, load_scene
from insonify.simulation import prepare
from insonify.tracers import sweep

FLAT = edit(
    load_scene("default"),
    {
        "targets": [],
        "sonar.pulse": "ideal",
        "sonar.bins": 400,
        "sonar.range": 70.0,
        "seabed.depth": 25.0,
        "seabed.relief": "flat",
        "water": {"kind": "uniform", "surface": {"kind": "flat", "surface_echo": False}},
    },
)
WAYS = ["surface_bottom", "surface_bottom_surface", "second_bottom"]
PINGS = np.arange(0, 100, 30)


@pytest.mark.parametrize("way", WAYS)
@pytest.mark.parametrize("changes", [{}, {"sonar.law": "light"}, {"sonar.beam": "knife"}, {"track.altitude": 5.0}])
def test_a_way_is_as_loud_as_foretold(way, changes):
    scene = edit(FLAT, changes)
    foretold = MultipathErrors(scene, summarise_scene(scene), [way], 0.0)
    forced = {other: "off" for other in WAYS if other != way} | {"planes": "8", "spacing": "1"}
    with_it, without = prepare(scene, forced=forced), prepare(scene, forced=forced | {way: "off"})
    poses = with_it.poses(PINGS)
    measured = compare_records(with_it.arrays, poses, with_it.intensity(PINGS), without.intensity(PINGS)).beyond
    assert foretold.shares[way] / foretold.direct == pytest.approx(measured, rel=0.5)


def test_what_comes_too_late_is_not_heard_and_what_a_rough_bed_brings_nearer_is():
    late = edit(FLAT, {"sonar.range": 24.5})
    assert not PredictedErrors(late, summarise_scene(late)).heard
    rough = edit(late, {"seabed.relief": {"kind": "fractal", "beta": 1.5, "rms": 0.2, "period": 51.2}})
    assert PredictedErrors(rough, summarise_scene(rough)).heard == {"surface_bottom"}


def test_a_squinting_beam_hears_no_place_both_ways():
    scene = edit(FLAT, {"sonar.beam": {"kind": "fan", "width": 1.0, "squint": 15.0}})
    chosen = plan(scene)
    assert "surface_bottom" not in chosen.ways
    assert chosen.entry("surface_bottom").modelled is False


def test_what_a_single_plane_misses_beneath_images_is_foretold():
    simulation = prepare(FLAT, tolerance=1e-4, forced={"spacing": "1"})
    poses, foretold = simulation.poses(PINGS), PredictedErrors(FLAT, summarise_scene(FLAT)).ghosts.of_planes()
    right = sweep.trace(simulation.arrays, poses, planes=32)
    for planes in (1, 2):
        missed = compare_records(
            simulation.arrays, poses, sweep.trace(simulation.arrays, poses, planes=planes), right
        ).beyond
        assert missed < 1.5 * foretold[fitted_laws.COUNTS.index(planes)] + 1e-3
