"""Surface multipath and crosstalk in records: labels, what the plan says of them, what is refused."""

import numpy as np
import pytest

from beds import arrays_of, poses_of, rough
from insonify.planning import plan
from insonify.scene import SceneError, edit, load_scene
from insonify.scene.water.surfaces import WAYS
from insonify.simulation import prepare, simulate
from insonify.tracers import sweep
from insonify.tracers.labels import PATHS, trace_labels
from sea_surfaces import bright_ball, under_sea

GHOSTS = edit(
    load_scene("ghosts"),
    {"track.start": [30.0, 0.0], "track.pings": 3, "receiver.speckle": "none", "receiver.tvg": "none"},
)
FLAT = np.zeros((4, 4))
ALIKE = {"planes": "8", "spacing": "1"}  # records that differ in their scenes alone


def test_truth_tells_by_which_way_the_strongest_sound_came():
    arrays = bright_ball(arrays_of(FLAT, 0.5, periodic=True, bins=600, bin_length=0.1), (0.0, 20.0, 0.0), 0.3)
    sea = under_sea(arrays, 18.0, *WAYS)
    poses = poses_of(0.0, 0.0, 12.0)
    truth, record = trace_labels(sea, poses), sweep.trace(sea, poses)
    assert ((truth.path[0] >= 0) == (record[0] > 0.0)).all()
    # Straight, by images at 24 m and 48 m above the bed, and the surface 6 m above the sonar.
    ranges = {"direct": 23.1, "surface_bottom": 27.0, "surface_bottom_surface": 31.0, "second_bottom": 37.5}
    for path, r in ranges.items():
        near = slice(int((r - 0.6) * 10), int((r + 0.6) * 10))
        heard = truth.target_id[0, 0, near] == 0
        assert heard.any()
        assert set(truth.path[0, 0, near][heard]) == {PATHS.index(path)}
        assert truth.ground_range[0, 0, near][heard] == pytest.approx(20.0, abs=0.4)
    line = (0, 1, 60)
    assert truth.path[line] == PATHS.index("surface")
    assert (truth.target_id[line], truth.material[line]) == (-2, -1)
    assert not (truth.path[0, 1] == PATHS.index("direct")).any()


def test_every_heard_bin_has_a_way_and_no_other():
    arrays = arrays_of(rough(64, 64, 0.2), 0.5, periodic=True, bins=500, bin_length=0.1, half_width=0.02)
    for wind in (0.0, 5.0):
        sea = under_sea(arrays, 13.0, *WAYS, wind_speed=wind)
        poses = poses_of([0.1, 2.7], 0.2, 7.0, 0.4)
        truth, record = trace_labels(sea, poses, planes=4), sweep.trace(sea, poses, planes=4)
        np.testing.assert_array_equal(truth.path >= 0, record > 0.0)
        assert set(np.unique(truth.path)) <= set(range(-1, len(WAYS) + 1))


def test_a_shadow_stays_one_when_a_ghost_lies_in_it():
    alike = {"planes": "8", "segments": "whole", "spacing": "1"}
    with_ghosts = simulate(GHOSTS, truth=True, forced=alike)
    without = simulate(edit(GHOSTS, {"water.surface": "none"}), truth=True, forced=alike)
    np.testing.assert_array_equal(with_ghosts.shadow, without.shadow)
    assert without.shadow.any()
    assert (with_ghosts.path.values[with_ghosts.shadow.values == 1.0] > 0).any()
    meanings = with_ghosts.path.flag_meanings.split()
    assert meanings == ["none", *PATHS]


def test_each_side_hears_the_other_at_a_level():
    alone = simulate(GHOSTS, truth=True)
    both = simulate(edit(GHOSTS, {"receiver.crosstalk": -10.0}), truth=True)
    expected = alone.intensity.values + 0.1 * alone.intensity.values[::-1]
    np.testing.assert_allclose(both.intensity.values, expected, rtol=1e-5)
    across = both.path.values == PATHS.index("crosstalk")
    assert across.any()
    np.testing.assert_array_equal(both.target_id.values[across], alone.target_id.values[::-1][across])
    np.testing.assert_array_equal(both.path.values[~across], alone.path.values[~across])
    np.testing.assert_array_equal(both.shadow.values, alone.shadow.values)
    np.testing.assert_array_equal(both.shadow_id.values, alone.shadow_id.values)
    # What is silent by itself is nothing but crosstalk.
    ideal = edit(GHOSTS, {"sonar.pulse": "ideal", "water.surface": "none"})
    silent = simulate(ideal).intensity.values == 0.0
    found = simulate(edit(ideal, {"receiver.crosstalk": -60.0}), truth=True)
    fills = silent & ~silent[::-1]
    assert fills.any()
    assert (found.path.values[fills] == PATHS.index("crosstalk")).all()


def test_a_plan_says_what_is_made_of_the_sea_and_refuses_what_knows_nothing_of_ghosts():
    assert any(line.startswith("flat sea, surface-bottom: ") for line in plan(GHOSTS).lines())
    blown = plan(edit(GHOSTS, {"water.surface": {"kind": "rough", "wind_speed": 5.0}}))
    assert any("waves of 0.13 m rms and slopes of 6.7° rms" in line for line in blown.lines())
    silent = plan(edit(GHOSTS, {"water.surface": {"kind": "flat"} | dict.fromkeys(WAYS, False)}))
    assert not any("sea" in line for line in silent.lines())
    with pytest.raises(SceneError, match=r"water\.surface: 'flat' adds multipath, which 'coherent' speckle"):
        prepare(edit(GHOSTS, {"receiver.speckle": "coherent"}))
    bent = edit(GHOSTS, {"water": {"kind": "profile", "surface": "flat", "depth": [0, 9], "sound_speed": [1520, 1500]}})
    with pytest.raises(SceneError, match=r"water\.surface: multipath \('flat'\) follows straight paths"):
        plan(bent)


def test_the_second_bottom_is_as_loud_as_the_bed_mirrors():
    """Its energy is R0² of the bed's own material."""
    records = []
    for reflection in (0.2, 0.4):
        ways = {"kind": "flat"} | dict.fromkeys(WAYS, False) | {"second_bottom": True}
        scene = edit(GHOSTS, {"water.surface": ways, "seabed.material.reflection": reflection, "targets": []})
        base = simulate(edit(scene, {"water.surface": "none"}), forced=ALIKE).intensity.values
        records.append(simulate(scene, forced=ALIKE).intensity.values.astype(float) - base)
    assert records[1].sum() / records[0].sum() == pytest.approx(4.0, rel=1e-3)
