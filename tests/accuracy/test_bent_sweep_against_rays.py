"""The sweep through thermoclines against rays that follow arcs, over scenes with targets and without."""

from __future__ import annotations

import numpy as np
import pytest

from insonify.scene import edit, load_scene
from insonify.simulation import prepare
from insonify.statistics.record_errors import compare_records
from insonify.tow.poses import take_poses
from insonify.tracers import rays, sweep

KNIFE = {"sonar.beam": "knife", "receiver.speckle": "none"}
RAYS = 100_000


def thermocline(above, below, top):
    """Water 10 m/s slower below so many metres over a bed at 30 m, from so many metres over it downwards."""
    return {
        "kind": "profile",
        "depth": [0.0, 30.0 - top, 30.0 - above, 40.0],
        "sound_speed": [1510.0, 1510.0, below, below],
    }


WATERS = {
    "above the bed": thermocline(above=3.0, top=6.0, below=1500.0),
    "about the sonar": thermocline(above=8.0, top=16.0, below=1500.0),
    "upside down": thermocline(above=3.0, top=6.0, below=1520.0),
}


def errors(name, changes, pings):
    """Error of each ping against many rays, and both records."""
    simulation = prepare(edit(load_scene(name), KNIFE | changes))
    arrays, poses = simulation.arrays, simulation.poses(np.array(pings))
    assert arrays.water.bent
    swept, right = sweep.trace(arrays, poses), rays.trace(arrays, poses, rays=RAYS)
    single = [slice(k, k + 1) for k in range(len(pings))]
    return [compare_records(arrays, take_poses(poses, k), swept[k], right[k]) for k in single], swept, right


@pytest.mark.parametrize("water", WATERS)
def test_scenes_with_targets_and_without(water):
    wet = {"water": WATERS[water]}
    found = [
        *errors("default", wet | {"targets": []}, [40, 210])[0],
        *errors("default", wet, [100, 150, 260, 330])[0],
        *errors("targets", wet, [60, 140, 220, 300])[0],
    ]
    beyond = [error.beyond for error in found]
    assert np.median(beyond) < 0.006
    # A broad face square to the sound puts all of its echo into a bin or two, between which a millimetre tells.
    assert max(beyond) < 0.03
    assert max(abs(error.energy_bias) for error in found) < 0.001


def test_a_mesh():
    found, _, _ = errors("wreck", {"water": WATERS["about the sonar"]}, [100, 150, 250])
    assert max(error.beyond for error in found) < 0.015


def test_shadow_edges_lie_within_a_bin():
    _, swept, right = errors(
        "targets", {"water": WATERS["above the bed"], "seabed.relief": "flat"}, np.arange(40, 340, 15)
    )
    dark, black = swept == 0.0, right == 0.0
    for shadow in (dark & ~black, black & ~dark):
        # No two neighbouring bins are dark in one and lit in the other.
        assert not (shadow[..., 1:] & shadow[..., :-1]).any()
