"""Errors predicted from the spectrum of a bed, against the bed as made and against what the sweep makes of it."""

from __future__ import annotations

import math

import numpy as np
import pytest

from insonify.accuracy.record_errors import compare_records
from insonify.acoustics.straightness import RefractionEffect
from insonify.planning import fitted_laws
from insonify.planning.bed_errors import BedEcho
from insonify.planning.relief_spectrum import compute_relief_spectrum
from insonify.planning.scene_summary import summarise_scene
from insonify.scene import edit, load_scene
from insonify.simulation import prepare
from insonify.terrain import build_ground
from insonify.tracers import sweep

PLAIN = edit(load_scene("default"), {"targets": [], "sonar.pulse": "ideal", "seabed.relief": "flat"})
KINDS = {
    "fractal": {"kind": "fractal", "beta": 1.5, "rms": 0.03, "period": 51.2},
    "peaked": {"kind": "fractal", "beta": 1.6, "rms": 0.03, "period": 51.2, "peaks": [[20.0, 9.0]]},
    "power_law": {"kind": "power_law", "strength": 0.004, "exponent": 3.2, "period": 51.2},
    "von_karman": {"kind": "von_karman", "rms": 0.03, "across": 4.0, "along": 4.0, "hurst": 0.6, "period": 51.2},
    "exponential": {"kind": "autocorrelation", "rms": 0.02, "function": {"kind": "exponential"}, "period": 51.2},
    "gaussian": {"kind": "autocorrelation", "rms": 0.03, "function": {"kind": "gaussian"}, "period": 51.2},
}
PINGS = np.arange(0, 200, 20)


def echo(scene):
    return BedEcho(summarise_scene(scene), compute_relief_spectrum(scene.seabed, scene.track.heading))


def over(relief, **changes):
    return edit(PLAIN, {"seabed.relief": relief} | {path.replace("__", "."): value for path, value in changes.items()})


@pytest.mark.parametrize("kind", KINDS)
def test_the_steepness_is_that_of_the_bed_as_it_is_made(kind):
    scene = over(KINDS[kind])
    heights = build_ground(scene).heights.astype(np.float64)
    made = np.diff(heights, axis=0).std() / scene.seabed.spacing
    # Slopes of waves against those between nodes, which are a little gentler.
    assert compute_relief_spectrum(scene.seabed, 0.0).steepness == pytest.approx(made, rel=0.35)


@pytest.mark.parametrize("kind", KINDS)
def test_errors_fall_with_planes_and_rise_with_wider_cells(kind):
    of = echo(over(KINDS[kind], sonar__beam__width=2.0))
    assert (np.diff(by_planes(of, 2, 4, 8, 20, 40, 128)) < 0.0).all()
    thinned = np.array([of.of_thinning(every) for every in (1, 2, 4, 8, 16)])
    assert (thinned[0] == 0.0).all()
    assert (np.diff(thinned[:, -1]) > 0.0).all()
    assert (np.diff(thinned, axis=1) <= 0.0).all()  # more planes average more of what coarse cells make up


def test_planes_closer_than_cells_count_by_their_square():
    of = echo(over(KINDS["power_law"]))
    near, nearer = by_planes(of, 40, 80)
    assert math.log2(near / nearer) == pytest.approx(2.0, abs=0.4)


def test_a_level_bed_of_one_material_needs_one_plane():
    assert echo(PLAIN).of_planes().max() == 0.0


def test_sound_that_is_not_shifted_is_not_missed():
    of = echo(over(KINDS["fractal"]))
    errors = [of.of_shift(RefractionEffect(shift, 0.0, shift)) for shift in (0.0, 0.003, 0.01, 0.03)]
    assert errors[0] == 0.0
    assert errors == sorted(errors)
    assert of.of_shift(RefractionEffect(0.0, 0.2, 0.2)) == pytest.approx(0.1, rel=0.5)  # most of it far out


@pytest.mark.parametrize("kind", ["fractal", "power_law", "exponential"])
@pytest.mark.parametrize("beam", ["knife", {"kind": "fan", "width": 2.0}])
def test_thinned_beds_and_few_planes_miss_about_what_is_predicted(kind, beam):
    scene = over(KINDS[kind], sonar__beam=beam)
    simulation, of = prepare(scene), echo(scene)
    arrays, poses = simulation.arrays, simulation.poses(PINGS)
    planes = 1 if beam == "knife" else 64
    right = sweep.trace(arrays, poses, planes=planes)
    thinned = prepare(scene, forced={"spacing": "4", "planes": str(planes)})
    measured = compare_records(arrays, poses, thinned.intensity(PINGS), right).beyond
    assert of.of_thinning(4)[fitted_laws.COUNTS.index(planes)] == pytest.approx(measured, rel=0.5)
    if planes > 1:
        few = compare_records(arrays, poses, sweep.trace(arrays, poses, planes=4), right).beyond
        assert by_planes(of, 4)[0] == pytest.approx(few, rel=0.6)
        single = compare_records(arrays, poses, sweep.trace(arrays, poses, planes=1), right).beyond
        assert by_planes(of, 1)[0] == pytest.approx(single, rel=0.4)


def by_planes(of, *counts):
    errors = of.of_planes()
    return np.array([errors[fitted_laws.COUNTS.index(count)] for count in counts])
