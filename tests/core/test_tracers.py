"""Each tracer traces pings by themselves, and a tracer of somebody else's is planned, traced and received."""

import itertools
import math
import re
from functools import partial
from pathlib import Path

import numpy as np
import pytest

import insonify
from beds import arrays_of, poses_of, rough
from insonify.cli import main
from insonify.kernels.common.types import LIGHT, SONAR
from insonify.packing.packed_scene import Model
from insonify.scene import SceneError, edit, load_scene
from insonify.scene.water.surfaces import WAYS
from insonify.simulation import prepare
from insonify.tow.poses import take_poses
from insonify.tracers import base, march, ray_sheets, rays, sweep
from insonify.tracers.base import find_tracer, list_methods
from insonify.tracers.labels import trace_labels
from insonify.tracers.scatterers import ScattererTracer
from sea_surfaces import under_sea
from water import water_about

SCENE = edit(load_scene("default"), {"sonar.bins": 100, "sonar.beam": "knife", "track.pings": 4})
SPECKLED = {"receiver.speckle": {"kind": "coherent", "density": 1.0}, "sonar.beam": {"kind": "fan", "width": 2.0}}
COHERENT = edit(SCENE, SPECKLED)
EXTEND = (Path(__file__).parents[2] / "docs" / "architecture" / "extend.md").read_text()


def test_the_methods_are_listed_by_rank_and_an_unknown_tracer_is_refused():
    assert list_methods() == ("auto", "sweep", "march", "rays")
    for name in ("magic", "auto"):  # the latter is a wish, not a tracer
        with pytest.raises(SceneError, match=rf"^method: '{name}' is not known; choose one of auto, sweep, march, ra"):
            find_tracer(name)


@pytest.mark.parametrize("name", [*list_methods()[1:], "scatterers"])
def test_every_tracer_traces_pings_by_themselves(name):
    simulation = prepare(COHERENT if name == "scatterers" else SCENE)
    tracer = simulation.tracer if name == "scatterers" else find_tracer(name)
    poses = simulation.poses(np.arange(3))
    record = tracer.trace(simulation.reduced, poses)
    assert record.shape == (3, 2, 100)
    assert record.dtype == np.float32
    assert record.any()
    alone = tracer.trace(simulation.reduced, simulation.poses(np.array([1])), threads=1)
    np.testing.assert_array_equal(alone[0], record[1])


def test_coherent_speckle_is_traced_scatterer_by_scatterer():
    arrays = prepare(COHERENT).arrays
    sweep = find_tracer("sweep")
    assert isinstance(sweep.prepare(COHERENT, arrays), ScattererTracer)
    assert sweep.prepare(SCENE, arrays) is sweep
    assert sweep.bins_beyond == 0


@pytest.mark.parametrize("name", list_methods()[1:])
def test_finer_models_are_more_work(name):
    arrays = prepare(SCENE).arrays
    tracer, coarse = find_tracer(name), Model(name, planes=4, rays=4000, step=0.1)
    finer = {"planes": 8, "rays": 8000, "step": 0.05}[tracer.fineness[0]]
    fine = coarse._replace(**{tracer.fineness[0]: finer})
    assert 0.0 < tracer.work(SCENE, arrays, coarse) < tracer.work(SCENE, arrays, fine)
    assert set(tracer.settings(fine)) <= {"planes", "rays", "step"}


@pytest.fixture(scope="module")
def strips():
    """The tracer that the documentation shows."""
    section = re.search(r"## A tracer\n.*?(?=\n## )", EXTEND, flags=re.DOTALL).group(0)
    declaration = re.search(r"```python\n(.*?)```", section, flags=re.DOTALL).group(1)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(base, "_DECLARED", dict(base._DECLARED))
        exec(declaration, {})
        yield find_tracer("strips")


def test_a_tracer_of_somebody_elses_is_a_method_that_is_planned_by_its_ladder_and_simulated(strips, tmp_path):
    assert list_methods()[1:] == ("sweep", "march", "rays", "strips")
    assert find_tracer("strips") is strips
    coarse, fine = (insonify.plan(SCENE, tolerance, method="strips") for tolerance in (0.5, 0.1))
    assert coarse.method == fine.method == "strips"
    assert coarse.model.fineness < fine.model.fineness
    entry = fine.entry("fineness")
    assert entry.choice == f"{fine.model.fineness} strips per side"
    assert entry.error < 0.1 < coarse.entry("fineness").error < 0.5
    assert insonify.plan(SCENE, method="strips", forced={"fineness": "64"}).settings == {"strips": 64}
    assert insonify.plan(SCENE).method == "sweep"  # chosen by those alone that ask for it
    record = insonify.simulate(SCENE, method="strips", truth=True)
    assert np.isfinite(record.intensity).all()
    assert record.intensity.values.any()
    level = edit(SCENE, {"targets": [], "seabed.relief": "flat"})
    swept, found = (insonify.simulate(level, method=method).intensity.values for method in ("auto", "strips"))
    np.testing.assert_allclose(found[..., 60:], swept[..., 60:], rtol=0.05)
    words = ["render", "default", "--method", "strips", "--set", "track.pings=2", "-o", str(tmp_path / "record.png")]
    assert main(words) == 0


@pytest.mark.parametrize(
    ("changes", "sentence"),
    [
        ({"sonar.bounces": 2}, r"^sonar\.bounces: 'strips' does not follow bounces, here 2; .* use rays$"),
        (SPECKLED, r"^receiver\.speckle: 'coherent' is part of the sweep, not of the method"),
        ({"water.surface": "flat"}, r"^water\.surface: strips have no multipath; take the surface 'none'$"),
    ],
)
def test_what_it_cannot_do_is_refused(strips, changes, sentence):
    with pytest.raises(SceneError, match=sentence):
        insonify.plan(edit(SCENE, changes), method="strips")


FAN = math.radians(1.25)
BALL = ((3.0, 12.0, 0.6), 0.5)
TRACES = {
    "sweep": sweep.trace,
    "march": partial(march.trace, rays=100, step=0.2),
    "rays": partial(rays.trace, rays=300),
    "sheets": partial(ray_sheets.trace, sheets=4, rays=100),
}
FINE = {"sweep": sweep.trace, "rays": partial(rays.trace, rays=5000)}
THERMOCLINE = [-50.0, 2.0, 6.0, 50.0], [1490.0, 1490.0, 1500.0, 1500.0]
WATERS = {
    "even": lambda arrays: arrays,
    "thermocline": lambda arrays: arrays._replace(water=water_about(8.0, *THERMOCLINE)),
    "sea": lambda arrays: under_sea(arrays, 14.0, *WAYS, wind_speed=4.0),
}
# Rays in sheets are traced without a sea.
CASES = [case for case in itertools.product(TRACES, WATERS) if case != ("sheets", "sea")]


@pytest.mark.parametrize(("name", "water"), CASES)
def test_threads_blocks_and_order_leave_every_bit(name, water):
    options = {"periodic": True, "solids": [BALL], "half_width": FAN, "bins": 300, "bin_length": 0.1}
    arrays = WATERS[water](arrays_of(rough(64, 64, 0.2), 0.5, **options))
    trace, along = TRACES[name], np.arange(90) * 0.3
    poses = poses_of(along, 0.0, 8.0 + 0.9 * np.sin(along))
    one = trace(arrays, poses, threads=1)
    np.testing.assert_array_equal(one, trace(arrays, poses, threads=3))
    np.testing.assert_array_equal(one[::-1], trace(arrays, take_poses(poses, slice(None, None, -1)), threads=2))
    parts = [trace(arrays, take_poses(poses, slice(k, k + 7))) for k in range(0, 90, 7)]
    np.testing.assert_array_equal(one, np.concatenate(parts))


# Of rays 1 in 1000 on the border of a bin may fall to either side of it.
@pytest.mark.parametrize(("name", "rtol", "atol", "least"), [("sweep", 2e-4, 1e-5, 1.0), ("rays", 1e-5, 0.0, 0.999)])
@pytest.mark.parametrize("half_width", [0.0, FAN])
@pytest.mark.parametrize("law", [LIGHT, SONAR])
def test_mirrored_bed_swaps_the_channels(name, rtol, atol, least, half_width, law):
    heights = rough(64, 64, 0.2)
    mirrored = np.roll(heights[::-1], 1, axis=0)  # y → −y on a period
    one, other = (
        FINE[name](arrays_of(z, 0.5, periodic=True, half_width=half_width, law=law), poses_of([0.0, 0.7, 1.4], y, 8.0))
        for z, y in ((heights, 0.3), (mirrored, -0.3))
    )
    assert np.isclose(one, other[:, ::-1], rtol=rtol, atol=atol * one.max()).mean() >= least


@pytest.mark.parametrize(("name", "rtol", "atol", "least"), [("sweep", 2e-3, 2e-5, 1.0), ("rays", 1e-4, 0.0, 0.999)])
@pytest.mark.parametrize("half_width", [0.0, FAN])
def test_turned_by_a_quarter_the_record_is_the_same(name, rtol, atol, least, half_width):
    heights = rough(64, 64, 0.2)
    turned = np.roll(np.rot90(heights, -1), 1, axis=1)  # (x, y) → (−y, x) on a period
    one, other = (
        FINE[name](arrays_of(z, 0.5, periodic=True, half_width=half_width, solids=[ball]), poses_of(x, y, 8.0, heading))
        for z, ball, x, y, heading in (
            (heights, ((2.5, 9.0, 0.5), 0.6), 2.2, 1.3, 0.4),
            (turned, ((-9.0, 2.5, 0.5), 0.6), -1.3, 2.2, 0.4 + math.pi / 2.0),
        )
    )
    assert np.isclose(one, other, rtol=rtol, atol=atol * one.max()).mean() >= least


@pytest.mark.parametrize("half_width", [0.0, FAN])
@pytest.mark.parametrize("name", TRACES)
def test_out_of_range_a_sonar_hears_nothing(name, half_width):
    arrays = arrays_of(np.zeros((4, 4)), periodic=True, bins=10, half_width=half_width)  # half a metre
    z = [6.0] if name == "march" else [6.0, -1.0]  # which marches up to a bed above it too
    assert not TRACES[name](arrays, poses_of(0.0, 0.0, z)).any()
    assert TRACES[name](arrays, poses_of([], 0.0, 1.0)).shape == (0, 2, 10)


@pytest.mark.parametrize("trace", [*TRACES.values(), trace_labels], ids=[*TRACES, "labels"])
def test_a_sonar_inside_a_body_is_one_sentence(trace):
    arrays = arrays_of(np.zeros((4, 4)), periodic=True, solids=[((0.0, 50.0, 1.0), 0.5), ((0.0, 0.0, 10.0), 1.0)])
    sentence = r"^targets\.1\.position: the sonar runs into it; move the target or raise the track$"
    with pytest.raises(SceneError, match=sentence):
        trace(arrays, poses_of(np.arange(-40.0, 40.0), 0.0, 10.0))
    trace(arrays, poses_of(np.arange(-2.0, 2.0), 0.0, 11.01))  # just outside it is none


@pytest.mark.parametrize(
    ("trace", "wrong"),
    [(rays.trace, {"rays": 0}), *((march.trace, {"step": step}) for step in (0.0, -1.0, math.nan, math.inf))],
)
def test_a_fineness_that_is_none_is_refused(trace, wrong):
    with pytest.raises(SceneError, match=next(iter(wrong))):
        trace(arrays_of(np.zeros((4, 4))), poses_of(0.0, 0.0, 5.0), **wrong)
