"""The whole way: scene in, Dataset out."""

import math
import tracemalloc
from dataclasses import replace
from types import SimpleNamespace
from unittest.mock import Mock

import numpy as np
import pytest
import xarray as xr

import insonify.simulation as module
from insonify.acoustics.flat_bed import flat_bed_curve
from insonify.compiler.build import own_build
from insonify.errors import PlanWarning
from insonify.io.record_schema import join_blocks
from insonify.parallel import count_threads
from insonify.planning import plan
from insonify.scene import SceneError, edit, load_scene, scene_from_toml
from insonify.simulation import prepare, simulate, simulate_blocks

ALIKE = {"segments": "0.003", "planes": "8", "spacing": "1"}  # records that differ in their scenes alone
COARSE = {"seabed.spacing": 0.4, "seabed.relief.period": 51.2, "seabed.relief.peaks": [[12.0, 6.0]], "sonar.bins": 200}
SMALL = edit(load_scene("default"), COARSE)


def small(pings=20, **changes):
    return edit(SMALL, {"track.pings": pings, **{path.replace("__", "."): value for path, value in changes.items()}})


def test_the_dataset_keeps_the_contract():
    scene = small(5, track__heading=35.0, track__start=[3.0, -2.0], track__speed=3.0)
    record = simulate(scene)
    assert record.intensity.dims == ("channel", "ping_time", "range_sample")
    assert record.intensity.shape == (2, 5, 200)
    assert record.intensity.dtype == np.float32
    assert record.channel.values.tolist() == ["port", "starboard"]
    along, heading = np.arange(5) * 0.3, math.radians(35.0)
    expected = {
        "slant_range": (np.arange(200) + 0.5) * 0.25,
        "travel_time": 2.0 * (np.arange(200) + 0.5) * 0.25 / 1500.0,
        "ping_time": np.arange(5) / 10.0,
        "platform_x": 3.0 + along * math.cos(heading),
        "platform_y": -2.0 + along * math.sin(heading),
        "platform_heading": np.full(5, 35.0),
        "platform_depth": np.full(5, 20.0),
    }
    for name, values in expected.items():
        np.testing.assert_allclose(record[name], values, rtol=1e-7, atol=1e-12, err_msg=name)
    assert scene_from_toml(record.attrs["scene"]) == scene
    assert record.attrs["plan"].splitlines() == plan(scene).lines()
    assert record.attrs["version"]
    assert record.attrs["build"] == own_build().text()
    assert all(record[name].attrs["units"] for name in ("slant_range", "travel_time", "platform_altitude", "intensity"))


@pytest.mark.parametrize(
    ("options", "sentence"),
    [
        *(({"block": block}, f"^block: {block} .*; give at least 1$") for block in (0, -1, 2.5)),
        *(({"threads": threads}, f"^threads: {threads} is too few; give at least 1$") for threads in (0, -2)),
        *(
            ({"pings": pings}, r"^pings: range.* successive ones of its 71$")
            for pings in (range(-1, 5), range(3, 72), range(0, 60, 2), range(9, 3))
        ),
        ({"pings": [4, 5]}, r"^pings: \[4, 5\] .*; give a range of successive ones of its 71$"),
        ({"tolerance": 0.0}, "^tolerance: 0.0 is not above 0;"),
        ({"method": "swep"}, "swep"),
        ({"forced": {"plane": "3"}}, "^model: 'plane' is not a choice"),
    ],
)
def test_wrong_pings_blocks_threads_and_choices_are_refused_before_the_first_block(options, sentence):
    with pytest.raises(SceneError, match=sentence):
        simulate_blocks(small(71), **options)


def test_echoes_alone_are_traced_by_as_many_threads_as_a_simulation_has():
    simulation = prepare(small(40), threads=1)
    counting = SimpleNamespace(trace=lambda *_, **__: count_threads())
    assert replace(simulation, tracer=counting).trace(simulation.poses(np.arange(40))) == 1


@pytest.mark.parametrize("truth", [False, True])
def test_blocks_of_any_size_make_the_same_record(monkeypatch, truth):
    turn = {"kind": "turn", "rate": 20.0, "begin": 1.0}
    motion = {"kind": "sum", "of": ["heave", "sway", "yaw", "pitch", "roll", turn]}
    scene = small(37, receiver__speckle="rayleigh", track__motion=motion)
    whole = simulate(scene, truth=truth, threads=1)
    for block in (13, 1000):
        parts = list(simulate_blocks(scene, truth=truth, block=block, threads=3))
        assert len(parts) == math.ceil(37 / block)
        xr.testing.assert_identical(join_blocks(parts), whole)
    monkeypatch.setattr(module, "BLOCK_TIME", 1e-9)  # one ping a block
    xr.testing.assert_identical(simulate(scene, truth=truth), whole)
    assert [block.sizes["ping_time"] for block in simulate_blocks(scene, truth=truth)] == 37 * [1]


@pytest.mark.usefixtures("fixed_model")
@pytest.mark.parametrize(
    ("name", "changes"),
    [
        *((name, {}) for name in ("default", "targets", "wreck", "pipe-span", "sediments", "ghosts", "thermocline")),
        ("targets", {"track.altitude": 5.0, "sonar.beam": {"kind": "array", "length": 0.3}}),
        ("targets", {"sonar.beam.squint": 20.0, "track.start": [0.0, -5.0]}),
        ("targets", {"receiver.crosstalk": -30.0}),
        ("endless", {"receiver.speckle": "rayleigh", "track.pings": 15}),
    ],
)
def test_labels_of_targets_alone_are_those_of_the_whole_and_change_no_record(name, changes):
    scene = load_scene(name)
    seldom = {"track.pings": min(scene.track.pings // 4, 100), "sonar.ping_rate": scene.sonar.ping_rate / 4.0}
    scene = edit(scene, {**seldom, "sonar.bins": 300, **changes})
    unlabelled, whole, alone = (simulate(scene, truth=truth) for truth in (False, True, "targets"))
    np.testing.assert_array_equal(whole.intensity, unlabelled.intensity)
    assert {"material", "ground_range", "incidence"}.isdisjoint(alone)
    for found in alone:
        np.testing.assert_array_equal(alone[found], whole[found], err_msg=str(found))


@pytest.mark.usefixtures("fixed_model")
def test_labels_alone_trace_no_record(monkeypatch):
    """In water with a double image pings are followed ray by ray, to be labelled and once more to be traced."""
    simulation = prepare(edit(load_scene("figure-3"), {"sonar.bins": 200}))
    monkeypatch.setattr("insonify.tracers.labels.trace", Mock(side_effect=AssertionError("a record is traced")))
    assert (simulation.truth(np.arange(2)).target_id == -1).any()
    with pytest.raises(AssertionError, match="traced"):
        next(simulation.record_blocks(truth=True, pings=range(2)))


@pytest.mark.parametrize("first", [1, 40, 70])
@pytest.mark.parametrize("name", ["rough-tow", "ghosts", "endless"])
def test_a_record_goes_on_at_any_ping(name, first):
    scene = edit(load_scene(name), {"track.pings": 71, "sonar.bins": 200, "receiver.speckle": "rayleigh"})
    rest = xr.concat(simulate_blocks(scene, pings=range(first, 71), block=13), "ping_time", combine_attrs="override")
    whole = simulate(scene).isel(ping_time=slice(first, None))
    for record in (rest, whole):  # error of all pings, which comes with the last block
        record.attrs.pop("record_error", None)
    xr.testing.assert_identical(rest, whole)


STEADY = {"track.pings": 24, "receiver.speckle": "none"}


@pytest.mark.parametrize("name", ["default", "targets", "ripples", "ghosts"])
def test_a_record_carries_the_error_that_a_dense_one_finds_in_it(name):
    simulation = prepare(edit(load_scene(name), STEADY))
    arrays, poses = simulation.arrays, simulation.poses(np.arange(24))
    traced = simulation.trace_pings(poses, of_bins=True)
    settings = simulation.settings_of(np.full(24, 400))
    dense = simulation.tracer.trace(simulation.reduced, poses, **settings).astype(np.float64)
    level = flat_bed_curve(arrays, float(poses.z[0]))
    starts = [math.ceil(reach * poses.z[0] / arrays.bin_length) for reach in (1.0, 1.4)]
    squares = [np.square(each / np.where(level > 0.0, level, 1.0)) for each in (traced.echoes - dense, dense)]
    missed, whole = (np.array([each[..., start:].sum(axis=-1) for start in starts]) for each in squares)
    found, estimated = np.sqrt(missed / whole).max(axis=0), simulation.errors(traced.squares)
    assert np.mean(found <= 1.25 * estimated) >= 0.99
    assert np.mean(estimated <= 3.0 * found) >= 0.8
    bins = simulation.bin_errors(traced)
    ratios = (np.abs(traced.echoes - dense) * simulation.reception.gain)[bins > 0.0] / bins[bins > 0.0]
    assert np.median(ratios) < 1.0
    assert np.quantile(ratios, 0.9) < 2.5


# Echoes by way of the surface are compared with a level bed in planes of their own.
@pytest.mark.parametrize(("name", "rounding"), [("default", 1e-3), ("thermocline", 1e-3), ("ghosts", 0.15)])
def test_errors_of_bins_add_up_to_that_of_the_side_and_change_no_record(name, rounding):
    scene = edit(load_scene(name), STEADY)
    bare, labelled = simulate(scene), simulate(scene, truth=True, bin_error=True)
    for variable in bare:
        xr.testing.assert_identical(labelled[variable], bare[variable])
    parts = [*simulate_blocks(scene, bin_error=True, block=5, threads=2)]
    xr.testing.assert_identical(join_blocks(parts).bin_error, labelled.bin_error)
    simulation = prepare(scene)
    poses = simulation.poses(np.arange(24))
    traced = simulation.trace_pings(poses, of_bins=True)
    start = math.ceil(1.4 * poses.z[0] / simulation.arrays.bin_length)
    level = flat_bed_curve(simulation.arrays, float(poses.z[0]))[start:]
    of_bins = traced.bin_errors[..., start:], traced.echoes[..., start:]
    missed, whole = (np.square(each / level).sum(axis=-1) for each in of_bins)
    np.testing.assert_allclose(missed / whole, np.divide(*np.moveaxis(traced.squares[..., 2, :], -1, 0)), rtol=rounding)


def test_what_no_planes_estimate_has_the_error_of_the_plan():
    knife, marched = small(4, sonar__beam="knife"), small(4)
    for scene, how in ((knife, {}), (marched, {"method": "march"})):
        expected = plan(scene, **how).error
        record = simulate(scene, **how)
        np.testing.assert_allclose(record.error, expected, rtol=1e-6)
        assert record.attrs["record_error"] == pytest.approx(expected)
    with pytest.raises(SceneError, match=r"^bin_error: the method 'march' .* use the method 'sweep'$"):
        simulate(marched, method="march", bin_error=True)
    alike = prepare(marched, plan=replace(plan(marched), entries=()))
    assert np.isnan(alike.errors(np.zeros((2, 3, 2)))).all()


def test_pings_beyond_the_tolerance_with_the_most_planes_are_told_at_the_line_of_the_caller(monkeypatch):
    scene = small(9)
    for place in ("tracers.plane_counts", "record.record_error"):
        monkeypatch.setattr(f"insonify.{place}.MOST_PLANES", 2)
    errors = np.linspace(0.02, 0.04, 9)
    monkeypatch.setattr(module.Simulation, "errors", lambda self, squares: np.resize(errors, squares.shape[-3::-1]).T)
    told = (
        r"^4 pings have .* tolerance of 3 % with 2 planes, the greatest is ping 8 with 4 %; raise the tolerance, or .*"
    )
    for run in (simulate, lambda scene: [*simulate_blocks(scene, block=9)]):
        with pytest.warns(PlanWarning, match=told) as caught:
            run(scene)
        assert [each.filename for each in caught] == [__file__]


def test_a_stream_holds_no_more_than_64_mb_however_long_it_is(monkeypatch):
    monkeypatch.setattr(module, "BLOCK_TIME", 1e9)  # blocks as large as their bytes allow, whatever else runs here

    def peak(pings):
        scene = edit(small(pings), {"sonar.beam": "knife", "targets": [], "sonar.bins": 2000})
        blocks = simulate_blocks(scene)
        next(blocks)
        tracemalloc.start()
        for block in blocks:
            assert block.sizes["ping_time"] > 64
        _, most = tracemalloc.get_traced_memory()
        tracemalloc.stop()
        return most

    short, long = peak(6000), peak(12000)
    assert long < 1.2 * short
    assert long < 64e6


VOLUMES = [{"kind": "school", "position": [4.0, 15.0, -25.0]}, {"kind": "plume", "position": [2.0, -20.0, -30.0]}]
WATER = {"receiver__noise": "ambient", "receiver__reverberation": "volume", "receiver__crosstalk": -10.0}


@pytest.mark.parametrize(
    "changes",
    [
        {"receiver__speckle": "rayleigh"},
        {"receiver__speckle": "rayleigh", "receiver__noise": "ambient", "volumes": VOLUMES},
        {"receiver__speckle": "coherent", "receiver__fluctuation": {"kind": "lognormal", "travel_time": 1e-4}, **WATER},
    ],
    ids=["speckle", "volumes", "scatterers"],
)
def test_any_ping_is_a_function_of_the_scene_and_its_number(changes):
    simulation = prepare(small(20, **changes))
    pings = np.arange(30)
    whole = simulation.intensity(pings)
    order = np.random.default_rng(0).permutation(30)
    np.testing.assert_array_equal(simulation.intensity(order), whole[order])
    np.testing.assert_array_equal(simulation.intensity(np.array([7, 7])), whole[[7, 7]])
    assert simulation.intensity(np.array([], dtype=np.int64)).shape == (0, 2, 200)
    # Beyond the track's last ping the tow goes on.
    np.testing.assert_allclose(np.diff(simulation.poses(pings).x), 0.2)
    assert whole[20:].any(axis=(1, 2)).all()
    np.testing.assert_array_equal(np.moveaxis(whole[:20], 1, 0), simulate(simulation.scene).intensity)


def test_far_along_the_tow_the_pings_are_as_exact():
    # After 640,000 pings the period of 51.2 m has come round 2500 times.
    simulation = prepare(edit(small(), {"targets": []}))
    near, far = simulation.intensity(np.array([3])), simulation.intensity(np.array([3 + 256 * 2500]))
    np.testing.assert_allclose(far, near, rtol=1e-3, atol=1e-6 * near.max())


def test_progress_runs_to_the_end(monkeypatch):
    seen = []
    monkeypatch.setattr(module.Simulation, "_block_size", lambda *_, **__: 64)
    simulate(small(2 * 64 + 3), progress=lambda done, total: seen.append((done, total)))
    assert seen == [(64, 2 * 64 + 3), (2 * 64, 2 * 64 + 3), (2 * 64 + 3, 2 * 64 + 3)]


@pytest.mark.parametrize(("method", "scatter"), [("sweep", 1e-6), ("march", 0.5), ("rays", 0.1)])
def test_every_method_makes_the_same_picture(method, scatter):
    scene = small(3, sonar__beam="knife", targets=[], sonar__pulse="ideal")
    auto, chosen = simulate(scene, tolerance=0.01), simulate(scene, method=method, tolerance=0.01)
    assert chosen.attrs["plan"].startswith(method)
    curve = auto.intensity.values[:, :, 60:].mean(axis=(0, 1))
    difference = (chosen.intensity.values - auto.intensity.values)[:, :, 60:] / curve
    assert math.sqrt((difference**2).mean()) <= scatter
    assert abs(difference.mean()) < 0.03


@pytest.mark.parametrize(("heading", "port"), [(0.0, (0, 1)), (90.0, (-1, 0)), (180.0, (0, -1)), (-90.0, (1, 0))])
def test_port_is_to_the_left(heading, port):
    ball = {"kind": "sphere", "position": [20.0 * port[0], 20.0 * port[1]], "radius": 1.0}
    scene = small(1, track__heading=heading, targets=[ball], seabed__relief="flat", track__start=[0.0, 0.0])
    with_ball, without = (simulate(of, forced=ALIKE).intensity for of in (scene, edit(scene, {"targets": []})))
    changed = (abs(with_ball - without) > 1e-3 * without.max()).any("range_sample").squeeze()
    assert changed.values.tolist() == [True, False]


def test_a_receiver_that_takes_another_speed_stretches_the_range():
    scene = small(1, seabed__relief="flat", targets=[], sonar__pulse="ideal", sonar__bins=2000)
    for speed in (1400.0, 1600.0):
        record = simulate(edit(scene, {"water.reference_speed": speed}))
        first = record.slant_range[int(np.flatnonzero(record.intensity[0, 0])[0])]
        assert float(first) == pytest.approx(10.0 * speed / 1500.0, abs=0.026)
        np.testing.assert_allclose(record.travel_time, 2.0 * record.slant_range / speed)


def test_a_target_without_bed_is_one_sentence(tmp_path):
    np.save(tmp_path / "bed.npy", np.full((20, 20), -30.0))
    away = {"kind": "sphere", "position": [500.0, 0.0], "radius": 0.5}
    scene = small(1, seabed__relief={"kind": "dem", "path": str(tmp_path / "bed.npy")}, targets=[away])
    with pytest.raises(SceneError, match=r"^targets\.0\.position: \[500\.0, 0\.0\] lies where there is no bed; "):
        prepare(scene)
