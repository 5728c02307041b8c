"""Pings on which a plan measures errors."""

import numpy as np
import pytest

from insonify.packing.packed_scene import pack
from insonify.planning.probe import add_loud_pings
from insonify.planning.probe_pings import SPREAD, choose_probe_pings
from insonify.scene import edit, load_scene
from insonify.terrain import build_ground
from insonify.tow.poses import make_poses

DEFAULT = load_scene("default")
BARE = edit(DEFAULT, {"targets": []})


def chosen(scene, targets=()):
    return choose_probe_pings(scene, build_ground(scene), targets)


@pytest.mark.parametrize("pings", [1, 3, 8, 9, 512, 100_000])
def test_pings_are_spread_over_the_track(pings):
    found = chosen(edit(BARE, {"track.pings": pings})).all
    assert found.size == np.unique(found).size == min(pings, SPREAD)
    assert (found == chosen(edit(BARE, {"track.pings": pings, "seed": 9})).all).all()
    edges = np.arange(found.size + 1) * pings // found.size
    assert ((edges[:-1] <= found) & (found < edges[1:])).all()


def test_no_period_falls_in_step_with_them():
    # The mean of the phases as vectors: 1 for pings in step with the period, 0 for phases all around the circle.
    found = chosen(edit(BARE, {"track.pings": 64 * 13})).all
    for period in range(2, 105):
        assert abs(np.exp(2j * np.pi * (found % period) / period).mean()) < 0.8, period


def test_the_greatest_excursions_of_the_fish_are_among_them():
    rolling = edit(BARE, {"track.pings": 5000, "track.motion": {"kind": "roll", "amplitude": 5.0, "period": 9.0}})
    many = chosen(rolling)
    roll = make_poses(rolling, build_ground(rolling), many.spread).roll
    assert np.degrees(np.abs(roll).max()) > 4.9


@pytest.mark.parametrize("squint", [0.0, 8.0])
def test_a_target_that_one_ping_in_a_thousand_meets_is_crossed(squint):
    ball = {"kind": "sphere", "position": [1234.0, 30.0], "radius": 0.3}
    scene = edit(BARE, {"targets": [ball], "track.pings": 20_000, "sonar.beam.squint": squint})
    found = chosen(scene, (0,)).across
    step = scene.track.speed / scene.sonar.ping_rate
    start = scene.track.start[0]
    ahead = 1234.0 - (start + found * step) - np.tan(np.radians(squint)) * (30.0 - scene.track.start[1])
    assert 1 <= found.size <= 3
    assert (np.abs(ahead) <= 0.3 + step).all()


def test_many_targets_are_crossed_by_few_pings_and_the_nearest_first():
    balls = [{"kind": "sphere", "position": [3.0 * k, 10.0 + k]} for k in range(30)]
    found = chosen(edit(BARE, {"targets": balls}), tuple(range(30))).across
    assert 6 <= found.size <= 12


@pytest.mark.parametrize("share", [0.0, 0.5, -0.25])
def test_of_a_wide_beam_a_target_lies_on_the_axis_and_on_one_of_two_and_of_four_planes(share):
    ball = {"kind": "sphere", "position": [200.0, 80.0], "radius": 0.3}
    scene = edit(BARE, {"targets": [ball], "track.pings": 4000})
    half_width = np.radians(6.0)
    found = choose_probe_pings(scene, build_ground(scene), (0,), half_width).across
    step, away = scene.track.speed / scene.sonar.ping_rate, 80.0 - scene.track.start[1]
    azimuths = np.arctan((200.0 - scene.track.start[0] - found * step) / away) / half_width
    assert np.abs(np.abs(azimuths) - abs(share)).min() < 0.06


def test_pings_are_spread_where_a_measured_bed_is_heard(tmp_path):
    # The bed ends after a tenth of the track.
    heights = np.full((40, 60), -20.0)
    np.save(tmp_path / "bed.npy", heights)
    spec = {"seabed.relief": {"kind": "dem", "path": str(tmp_path / "bed.npy")}, "seabed.spacing": 0.5}
    scene = edit(BARE, {**spec, "track.start": [0.0, 5.0], "track.heading": 0.0, "track.pings": 6000})
    found = chosen(scene).spread
    ahead = found * scene.track.speed / scene.sonar.ping_rate
    assert found.size == SPREAD
    assert (ahead <= 30.0).all()


def test_a_face_that_glints_into_few_pings_is_among_them(tmp_path):
    # A bank square to the sound that comes 45° down, over 6 m of a track of 200 m, of a material with a narrow lobe.
    heights = np.full((201, 401), -20.0)
    away, along = 0.5 * np.arange(201)[:, None], 0.5 * np.arange(401)[None, :]
    bank = np.clip(away - 70.0, 0.0, 3.0) * ((along > 120.0) & (along < 126.0))
    np.save(tmp_path / "bank.npy", heights + bank)
    spec = {
        "seabed.relief": {"kind": "dem", "path": str(tmp_path / "bank.npy")},
        "seabed.spacing": 0.5,
        "seabed.material": {"name": "rock", "diffuse": 0.1, "specular": 0.9, "shininess": 400.0},
        "track": {"start": [-100.0, 0.0], "pings": 1000, "speed": 2.0, "altitude": 20.0},
        "sonar": {"range": 50.0, "bins": 500, "ping_rate": 10.0, "beam": {"kind": "knife"}},
    }
    packed = pack(edit(BARE, spec))
    plain = chosen(packed.scene)
    found = add_loud_pings(packed, plain).spread
    added = packed.scene.track.start[0] + np.setdiff1d(found, plain.spread) * 0.2
    assert 1 <= added.size <= 2
    assert ((added > 18.0) & (added < 28.0)).all()


def test_a_level_bed_has_no_loud_pings():
    packed = pack(edit(BARE, {"seabed.relief": "flat"}))
    assert (add_loud_pings(packed, chosen(packed.scene)).all == chosen(packed.scene).all).all()
