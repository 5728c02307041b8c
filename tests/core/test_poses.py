"""Where the fish is: closed forms, files, and no dependence on what else is asked for."""

import math

import numpy as np
import pytest
import xarray as xr
from hypothesis import given, settings
from hypothesis import strategies as st

from insonify.io.records import write_record
from insonify.planning import plan
from insonify.scene import SceneError, edit, load_scene
from insonify.simulation import prepare, simulate, simulate_blocks
from insonify.terrain import build_ground
from insonify.tow.line import tow_line_at
from insonify.tow.poses import KNOTS, bed_beneath, interpolate_bed_beneath, make_poses

LINE = {"track.start": [3.0, -2.0], "track.heading": 30.0}
LEVEL = edit(load_scene("default"), LINE | {"seabed.relief": "flat", "targets": [], "sonar.bins": 200})
SLOPE = 0.05


def poses(motion, pings, **changes):
    scene = edit(LEVEL, {"track.motion": motion, **{f"track.{name}": value for name, value in changes.items()}})
    return make_poses(scene, build_ground(scene), np.asarray(pings, dtype=np.int64))


def sum_of(*motions):
    return {"kind": "sum", "of": list(motions)}


def csv(folder, text):
    (folder / "tow.csv").write_text(text)
    return {"kind": "recorded", "path": str(folder / "tow.csv")}


def test_without_motion_it_is_a_line_bit_for_bit():
    pings = np.arange(1000)
    along = pings * (LEVEL.track.speed / LEVEL.sonar.ping_rate)
    still = sum_of({"kind": "heave", "amplitude": 0.0}, {"kind": "turn", "rate": 0.0})
    for motion, changes in (("straight", {}), (still, {}), ("straight", {"terrain_following": True})):
        found = poses(motion, pings, **changes)
        np.testing.assert_array_equal(found.x, 3.0 + math.cos(math.radians(30.0)) * along)
        np.testing.assert_array_equal(found.y, -2.0 + math.cos(math.radians(-60.0)) * along)
        np.testing.assert_array_equal(found.z, 10.0)
        np.testing.assert_array_equal(found.heading, math.radians(30.0))
        assert not found.pitch.any()
        assert not found.roll.any()


@pytest.mark.parametrize("rate", [6.0, -6.0])
def test_a_turn_is_an_arc_of_a_circle(rate):
    # Two metres a second at 6 degrees a second: a radius of 60 / pi metres; half a turn takes 30 s.
    radius, turn = 60.0 / math.pi, {"kind": "turn", "rate": rate, "begin": 5.0, "duration": 30.0}
    found = poses(turn, np.arange(600), heading=0.0, start=[0.0, 0.0])
    side = math.copysign(radius, rate)
    arc = slice(50, 351)
    np.testing.assert_allclose(np.hypot(found.x[arc] - 10.0, found.y[arc] - side), radius, rtol=1e-12)
    np.testing.assert_allclose(np.degrees(found.heading[arc]), rate * (np.arange(50, 351) / 10.0 - 5.0), atol=1e-9)
    # Then back the way it came, two radii aside.
    np.testing.assert_allclose(found.y[350:], 2.0 * side, rtol=1e-12)
    np.testing.assert_allclose(np.diff(found.x[350:]), -0.2, rtol=1e-9)
    # Speed is that of the track everywhere, but for the chord of a step.
    np.testing.assert_allclose(np.hypot(np.diff(found.x), np.diff(found.y)), 0.2, rtol=1e-5)


def test_turns_that_overlap_add_up_and_a_circle_stays_one_after_a_hundred_million_pings():
    turn = {"kind": "turn", "duration": 20.0}
    turns = turn | {"rate": 4.0, "begin": 5.0}, turn | {"rate": -4.0, "begin": 15.0}
    found = poses(sum_of(*turns), np.arange(450))
    headings = np.degrees(found.heading)
    np.testing.assert_allclose(headings[150:250], 70.0, rtol=1e-12)
    np.testing.assert_allclose(headings[350:], 30.0, rtol=1e-12)
    assert np.abs(np.diff(np.hypot(np.diff(found.x), np.diff(found.y)))).max() < 1e-4
    turn = {"kind": "turn", "rate": 3.6, "begin": 0.0, "duration": 1e8}
    near, far = poses(turn, np.arange(1000)), poses(turn, np.arange(1000) + 10**8)
    np.testing.assert_allclose(far.x, near.x, atol=1e-6)
    np.testing.assert_allclose(far.y, near.y, atol=1e-6)


@pytest.mark.parametrize(
    ("kind", "quarter"),
    [
        ("surge", {"x": math.sqrt(0.75) * 3.0, "y": 0.5 * 3.0}),
        ("sway", {"x": -0.5 * 3.0, "y": math.sqrt(0.75) * 3.0}),
        ("heave", {"z": 3.0}),
        ("yaw", {"heading": math.radians(3.0)}),
        ("pitch", {"pitch": math.radians(3.0)}),
        ("roll", {"roll": math.radians(3.0)}),
    ],
)
def test_a_swing_moves_one_thing_and_comes_back(kind, quarter):
    swing = {"kind": kind, "amplitude": 3.0, "period": 8.0}
    pings = np.arange(0, 4000, 20)  # a quarter of a period apart
    still, found = poses("straight", pings), poses(swing, pings)
    shape = np.tile([0.0, 1.0, 0.0, -1.0], 50)
    for name, before in still._asdict().items():
        np.testing.assert_allclose(getattr(found, name) - before, quarter.get(name, 0.0) * shape, atol=1e-12)
    ahead = poses(swing | {"phase": 90.0}, pings - 20)
    np.testing.assert_allclose(getattr(ahead, next(iter(quarter))), getattr(found, next(iter(quarter))), atol=5.0)
    np.testing.assert_allclose(ahead.z, found.z, atol=1e-12)
    np.testing.assert_allclose(ahead.heading, found.heading, atol=1e-12)


def test_a_sum_is_the_sum_and_the_line_is_without_the_motion():
    parts = [
        {"kind": "heave", "amplitude": 0.4, "period": 7.0},
        {"kind": "heave", "amplitude": 0.2, "period": 3.0, "phase": 40.0},
        {"kind": "yaw", "amplitude": 3.0},
    ]
    pings = np.arange(300)
    together = poses(sum_of(*parts), pings)
    alone = [poses(part, pings) for part in parts]
    np.testing.assert_allclose(together.z - 10.0, sum(one.z - 10.0 for one in alone), atol=1e-12)
    np.testing.assert_array_equal(together.heading, alone[2].heading)
    turn = {"kind": "turn", "begin": 1.0}
    lines = (tow_line_at(edit(LEVEL, {"track.motion": kind}), pings) for kind in (sum_of("sway", "yaw", turn), turn))
    for one, other in zip(*lines):
        np.testing.assert_array_equal(one, other)


@settings(max_examples=30, deadline=None)
@given(
    st.lists(st.integers(0, 10**8), min_size=1, max_size=70),
    st.floats(-20.0, 20.0),
    st.floats(0.0, 30.0),
    st.floats(0.1, 60.0),
    st.booleans(),
)
def test_a_ping_depends_on_its_number_alone(numbers, rate, begin, period, following):
    turn, heave = {"kind": "turn", "rate": rate, "begin": begin}, {"kind": "heave", "period": period}
    motion = sum_of(turn, heave, "sway", "yaw", "pitch", "roll")
    scene = edit(load_scene("default"), {"track.motion": motion, "track.terrain_following": following})
    ground = build_ground(scene)
    whole = make_poses(scene, ground, np.array(numbers))
    for ping in numbers[:: max(len(numbers) // 5, 1)]:
        alone = make_poses(scene, ground, np.array([ping]))
        for together, one in zip(whole, alone):
            assert together[numbers.index(ping)] == one[0]


TOW = "time, x, y, depth, heading, pitch, roll\n100,0,0,20,350,0,0\n102,4,0,22,10,2,-4\n104,8,2,22,10,2,-4\n"
# Text of a tow, pings, and the poses at them; angles in degrees.
RECORDED = {
    "interpolated": (
        TOW,
        [0, 5, 10, 20, 30],
        {
            "x": [0.0, 1.0, 2.0, 4.0, 6.0],
            "y": [0.0, 0.0, 0.0, 0.0, 1.0],
            "z": [10.0, 9.5, 9.0, 8.0, 8.0],
            "heading": [350.0, 355.0, 360.0, 370.0, 370.0],  # the short way round from 350 to 10 degrees
            "pitch": [0.0, 0.5, 1.0, 2.0, 2.0],
            "roll": [0.0, -1.0, -2.0, -4.0, -4.0],
        },
    ),
    "along the last heading after its end": (
        "time,x,y\n0,0,0\n1,3,0\n2,3,3\n",
        [20, 30, 50],
        {"x": [3.0] * 3, "y": [3.0, 5.0, 9.0], "heading": [90.0] * 3},
    ),
    # A turn of 20° through north by the compass, which counts clockwise.
    "compass": ("time,compass\n0,350\n2,10\n", [0, 10, 20], {"heading": [-260.0, -270.0, -280.0]}),
    "column without a number": (
        "ping_time,platform_roll,platform_pitch,remark\n0,0,nan,7\n10,10,nan,8\n",
        [50],
        {"roll": [5.0], "pitch": [0.0]},
    ),
}


@pytest.mark.parametrize("case", RECORDED)
def test_a_recorded_tow_is_interpolated(tmp_path, case):
    text, pings, expected = RECORDED[case]
    found = poses(csv(tmp_path, text), pings)
    for name, values in expected.items():
        column = getattr(found, name)
        np.testing.assert_allclose(column if name in "xyz" else np.degrees(column), values, atol=1e-12, err_msg=name)


def test_what_a_file_leaves_out_is_as_without_it_and_its_altitude_counts_from_the_bed_beneath(tmp_path):
    pings, recorded = np.arange(40), csv(tmp_path, "time,roll\n0,0\n10,10\n")
    motions = "straight", "heave", recorded, sum_of(recorded, "heave")
    plain, heaving, found, both = (poses(motion, pings) for motion in motions)
    np.testing.assert_allclose(np.degrees(found.roll), pings / 10.0)
    for one, other in (found.x, plain.x), (found.z, plain.z), (both.roll, found.roll), (both.z, heaving.z):
        np.testing.assert_array_equal(one, other)
    scene = edit(load_scene("default"), {"track.motion": csv(tmp_path, "time,altitude\n0,10\n10,12\n"), "targets": []})
    ground, pings = build_ground(scene), np.arange(80)
    found = make_poses(scene, ground, pings)
    np.testing.assert_allclose(found.z - ground.height_at(found.x, found.y), 10.0 + pings / 50.0, atol=1e-9)


def test_a_record_tows_another(tmp_path):
    turn = {"kind": "turn", "rate": 20.0, "begin": 1.0, "duration": 2.0}
    motion = sum_of("heave", "sway", "yaw", "pitch", "roll", turn)
    scene = edit(LEVEL, {"track.motion": motion, "track.pings": 60, "sonar.bins": 20})
    write_record(tmp_path / "first.nc", simulate_blocks(scene))
    again = edit(scene, {"track.motion": {"kind": "recorded", "path": str(tmp_path / "first.nc")}})
    first, second = simulate(scene), simulate(again)
    for name in ("x", "y", "depth", "altitude", "heading", "pitch", "roll"):
        np.testing.assert_allclose(second[f"platform_{name}"], first[f"platform_{name}"], atol=1e-9)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("time,x,y\n0,0,0\n2,1,1\n1,2,2\n", "goes back in time at row 3"),
        ("time,x,y\n0,0,0\n0,1,1\n", "goes back in time at row 2"),
        ("time,heave\n0,0\n1,1\n", "has no column of position or attitude"),
        ("x,y\n0,0\n1,1\n", "has no column time"),
        ("time,x\n0,0\n1,1\n", "only one of x and y"),
        ("time,heading,compass\n0,0,90\n1,0,90\n", "has both heading and compass"),
        ("time,roll\n0,0\n1,nan\n", "no number for roll in row 2"),
        ("time,roll\n0,0\n", "holds 1 row"),
        ("time,roll\n", "holds 0 rows"),
        ("", "has no column time"),
        ("time,roll\n0,port\n1,2\n", "cannot be read"),
        ("time,roll\n0,1\n1\n", "no number for roll in row 2"),
        ("time,x,y\n0,0,0\n1,1e300,0\n", "has x 1e\\+300 m in row 2"),
        ("time,pitch\n0,-900\n1,0\n", "has pitch -900 ° in row 1"),
        *((name, "") for name in ("gone.csv", "tow.txt", "broken.nc", "uneven.nc")),
    ],
)
def test_a_bad_file_is_one_sentence(tmp_path, text, words):
    xr.Dataset({"time": ("t", [0.0, 1.0]), "depth": ("z", [1.0, 2.0, 3.0])}).to_netcdf(tmp_path / "uneven.nc")
    (tmp_path / "tow.txt").write_text("time,x,y\n")
    (tmp_path / "broken.nc").write_text("not a record")
    motion = csv(tmp_path, text) if words else {"kind": "recorded", "path": str(tmp_path / text)}
    with pytest.raises(SceneError, match=rf"^track\.motion\.path: [^\n]*{words}[^\n]*; [^\n]+$"):
        poses(motion, [0])


def test_two_cannot_have_a_say_in_one_thing(tmp_path):
    places = csv(tmp_path, "time,x,y,depth\n0,0,0,20\n1,1,1,20\n")
    for motion, changes, word in (
        (sum_of(places, places), {}, "repeats"),
        (sum_of(places, "turn"), {}, "a turn has no effect"),
        (places, {"terrain_following": True}, r"terrain_following: has no effect"),
    ):
        with pytest.raises(SceneError, match=word):
            poses(motion, [0], **changes)


def dem(folder, heights, **changes):
    np.save(folder / "bed.npy", heights)
    relief = {"kind": "dem", "path": str(folder / "bed.npy")}
    changes = {f"track.{name}": value for name, value in changes.items()}
    scene = edit(LEVEL, {"seabed.relief": relief, "seabed.spacing": 0.5, "track.terrain_following": True, **changes})
    return scene, build_ground(scene)


def test_a_following_fish_keeps_its_altitude_up_a_slope_takes_a_step_smoothly_and_passes_over_a_hole(tmp_path):
    slope = np.broadcast_to(-40.0 + SLOPE * 0.5 * np.arange(401), (401, 401)).copy()
    scene, ground = dem(tmp_path, slope, heading=0.0, start=[-60.0, 0.0])
    found = make_poses(scene, ground, np.arange(600))
    np.testing.assert_allclose(found.z - ground.height_at(found.x, found.y), 10.0, atol=1e-4)
    assert found.z[-1] - found.z[0] == pytest.approx(SLOPE * 0.2 * 599, abs=1e-3)
    # The bed of pictures depends on the ping alone.
    some = np.array([690, 3, 250, 251])
    whole = interpolate_bed_beneath(scene, ground, np.arange(700))
    np.testing.assert_array_equal(whole[some], interpolate_bed_beneath(scene, ground, some))
    heights = np.full((401, 401), -40.0)
    heights[:, 200:] = -36.0  # a scarp of 4 m at x = 0
    heights[:, 300:340] = np.nan  # 20 m without a bed, from x = 50 on
    scene, ground = dem(tmp_path, heights, heading=0.0, start=[-60.0, 0.0])
    found = make_poses(scene, ground, np.arange(700))
    # A raised cosine of two altitudes is steepest in its middle: 4 m / 10 m.
    assert np.abs(np.diff(found.z)).max() <= 1.05 * 0.2 * 4.0 / 10.0
    beneath = bed_beneath(scene, ground, np.arange(700))
    np.testing.assert_allclose(beneath[found.x > 11.0] - beneath[-1], 0.0, atol=1e-4)
    assert np.isfinite(found.z).all()


@pytest.mark.parametrize("speed", [0.01, 2.0, 50.0])
def test_the_bed_of_pictures_is_that_beneath_at_knots_and_near_it_between(tmp_path, speed):
    heights = -30.0 + 2.0 * np.random.default_rng(3).standard_normal((401, 401)).cumsum(axis=1) / 20.0
    scene, ground = dem(tmp_path, heights, heading=0.0, start=[-60.0, 0.0], speed=speed)
    apart = 10.0 * scene.sonar.ping_rate / speed / KNOTS  # pings from a knot to the next at an altitude of 10 m
    pings = np.unique(np.rint(apart * np.arange(1, 60)).astype(np.int64))
    found, right = interpolate_bed_beneath(scene, ground, pings), bed_beneath(scene, ground, pings)
    np.testing.assert_allclose(found, right, atol=0.02 * np.ptp(right))
    exact = np.isclose(pings / apart, np.rint(pings / apart), rtol=0.0, atol=1e-9)
    np.testing.assert_allclose(found[exact], right[exact], rtol=1e-12)


def test_a_sonar_below_the_bed_is_refused_with_the_ping():
    rough = {"kind": "fractal", "beta": 1.2, "period": 25.6, "rms": 0.3}
    shallow = edit(LEVEL, {"seabed.relief": rough, "track.altitude": 0.1, "track.pings": 40, "sonar.range": 20.0})
    ground, pings = build_ground(shallow), np.arange(40)
    placed = make_poses(shallow, ground, pings)
    inside = np.flatnonzero(placed.z < ground.height_at(placed.x, placed.y))
    assert 0 < inside.size < 40
    with pytest.raises(SceneError, match=rf"^track.altitude: at ping {inside[0]} the sonar is .* m below the bed; "):
        simulate(shallow)
    assert prepare(shallow).intensity(np.setdiff1d(pings, inside)[:3]).sum() > 0.0
    with pytest.raises(SceneError, match=rf"at ping {inside[-1]} "):
        prepare(shallow).intensity(inside[-1:])
    # A track wholly below the bed is refused when it is planned.
    start = [float(placed.x[inside[0]]), float(placed.y[inside[0]])]
    with pytest.raises(SceneError, match=r"^track.altitude: at ping 0 the sonar is .* m below the bed; "):
        plan(edit(shallow, {"track.pings": 1, "track.start": start}))
