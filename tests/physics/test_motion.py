"""What motion does to a record: the first return follows the altitude, yaw drags echoes along the track."""

import math

import numpy as np
import pytest

from insonify.display.normalisation import LevelBed, normalise
from insonify.scene import edit, load_scene
from insonify.simulation import prepare, simulate
from insonify.terrain import build_ground
from insonify.tow.poses import make_poses

BARE = {"seabed.relief": "flat", "targets": [], "sonar.pulse": "ideal"}
LEVEL = edit(load_scene("default"), BARE | {"sonar.bins": 500, "track.start": [0.0, 0.0]})
HEAVING = edit(LEVEL, {"track.motion": {"kind": "heave", "amplitude": 1.5, "period": 7.0}, "track.pings": 60})
BIN = 0.1


@pytest.mark.parametrize("method", ["sweep", "rays"])
def test_the_first_return_follows_the_altitude(method):
    record = simulate(HEAVING, method=method, tolerance=0.3)
    altitude = record.platform_altitude.values
    np.testing.assert_allclose(altitude, 10.0 + 1.5 * np.sin(2.0 * np.pi * np.arange(60) / 70.0))
    first = (record.intensity.values > 0.0).argmax(axis=2)
    np.testing.assert_allclose(first, np.broadcast_to(altitude / BIN, first.shape), atol=1.0)


def test_a_picture_of_a_level_bed_stays_even_whatever_the_altitude():
    simulation = prepare(HEAVING)
    pings = np.arange(60)
    shown = normalise(simulation.intensity(pings), LevelBed(simulation).curves(pings))
    beyond = shown[:, :, round(1.4 * 11.5 / BIN) :]
    material = math.sqrt(simulation.ground.reflectivities[0].diffuse)
    np.testing.assert_allclose(beyond.mean(axis=(1, 2)), beyond.mean(), rtol=0.01)
    assert beyond[:, :, -100:].mean() == pytest.approx(material, rel=0.02)


# A motion that takes a day to come round is still: 5 degrees to port, and the bow up by 10.
YAW = {"track.motion": {"kind": "yaw", "amplitude": 5.0, "period": 1e5, "phase": 90.0}}
PITCH = {"track.motion": {"kind": "pitch", "amplitude": 10.0, "period": 1e5, "phase": 90.0}}
SQUINTS = {squint: {"sonar.beam": {"kind": "gaussian", "width": 1.0, "squint": squint}} for squint in (-5.0, 8.0)}


@pytest.mark.parametrize(
    ("changes", "across", "shift", "method"),
    [
        *[({}, across, 0.0, method) for across in (25.0, -25.0) for method in ("sweep", "rays")],
        *[(YAW, across, across * math.tan(math.radians(5.0)), "sweep") for across in (25.0, -25.0)],
        # The plane of the beam meets the bed so far ahead of a fish 10 m above it.
        *[(PITCH, 20.0, -9.7 * math.tan(math.radians(10.0)), method) for method in ("sweep", "rays")],
        *[
            (beam, across, -math.hypot(across, 10.0) * math.tan(math.radians(squint)), "sweep")
            for across in (25.0, -25.0)
            for squint, beam in SQUINTS.items()
        ],
    ],
)
def test_an_echo_is_heard_where_the_beam_points(changes, across, shift, method):
    ball = {"kind": "sphere", "position": [10.0, across], "radius": 0.3}
    scene = edit(LEVEL, {"targets": [ball], "track.pings": 40, "track.speed": 1.0, "track.start": [8.0 + shift, 0.0]})
    both = edit(scene, changes), edit(scene, changes | {"targets": []})
    # By the same planes, so that the bed's part of the echo is the same.
    alike = {"planes": "8", "spacing": "1"} if method == "sweep" else {}
    echo, bare = (simulate(one, method=method, tolerance=0.2, forced=alike).intensity.values for one in both)
    energy = np.maximum(echo - bare, 0.0)[0 if across > 0.0 else 1].sum(axis=1)
    assert np.average(np.arange(40), weights=energy) * 0.1 == pytest.approx(2.0, abs=0.05)


def test_sway_moves_the_bed_sideways_and_nothing_else():
    scene = edit(load_scene("default"), {"track.pings": 1, "track.heading": 90.0})
    swayed = edit(scene, {"track.motion": {"kind": "sway", "amplitude": 2.0, "phase": 90.0}})
    start = scene.track.start
    shifted = edit(scene, {"track.start": [start[0] - 2.0, start[1]]})
    np.testing.assert_allclose(simulate(swayed).intensity, simulate(shifted).intensity, rtol=1e-4)


def test_a_surge_spaces_pings_unevenly():
    # x = v t + a sin(2π t / T): the spacing swings between (v ± 2π a / T) / rate.
    surge = {"kind": "surge", "amplitude": 0.5, "period": 8.0}
    scene = edit(load_scene("default"), {"track.motion": surge, "track.pings": 800})
    poses = make_poses(scene, build_ground(scene), np.arange(800))
    spacing = np.diff(poses.x)
    swing = 2.0 * math.pi * 0.5 / 8.0 / scene.sonar.ping_rate
    even = scene.track.speed / scene.sonar.ping_rate
    assert spacing.max() == pytest.approx(even + swing, rel=1e-3)
    assert spacing.min() == pytest.approx(even - swing, rel=1e-3)
    assert not poses.y.any()
