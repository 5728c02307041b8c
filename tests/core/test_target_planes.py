"""Planes across targets and of the sonar's image: sectors are kept whole, and few planes find a glint."""

from __future__ import annotations

import math
import warnings

import numpy as np
import pytest

from beds import arrays_of, gaussian_pattern, poses_of
from insonify.errors import PlanWarning
from insonify.kernels.beam.pattern import is_top_hat, shared_response
from insonify.packing.packed_scene import Model, pack
from insonify.planning.probe import trace_model
from insonify.scene import edit, load_scene
from insonify.simulation import prepare, simulate, simulate_blocks
from insonify.statistics.record_errors import compare_records
from insonify.tow.poses import make_poses
from insonify.tracers.azimuth_fan import lay_planes, lay_planes_of_images

MANY = 2048  # planes of a reference
GLINTS = {
    "large ball": (1.0, (0.0, 0.8, 10.0), "silt", 10.0),
    "small ball, 3°": (0.2, (0.1, 0.8, 100.0), "medium_sand", 3.0),
    "small ball, 10°": (0.2, (0.1, 0.8, 100.0), "medium_sand", 10.0),
}


def glinting(radius, material, bed, width, pings=1):
    ball = {"kind": "sphere", "radius": radius, "position": [0.0, 40.0, -20.0]}
    ball["material"] = dict(zip(("diffuse", "specular", "shininess"), material))
    changes = {"targets": [ball], "seabed.relief": "flat", "seabed.material": bed, "sonar.beam.width": width}
    return edit(load_scene("default"), changes | {"seabed.depth": 30.0, "track.altitude": 10.0, "track.pings": pings})


@pytest.mark.parametrize("name", GLINTS)
@pytest.mark.parametrize("pings", [1, 512])
def test_a_plan_keeps_its_promise_where_a_target_glints(name, pings):
    simulation = prepare(glinting(*GLINTS[name], pings))
    poses = simulation.poses(np.array([0]))
    right = trace_model(simulation, simulation.plan.model._replace(planes=MANY, every=1), poses)
    traced = simulation.trace_pings(poses)
    error = compare_records(simulation.arrays, poses, traced.echoes, right).beyond
    assert error < min(0.01, max(1.25 * float(simulation.errors(traced.squares.sum(axis=1)).max()), 0.003))
    assert simulation.plan.planes == 1


@pytest.mark.parametrize("name", GLINTS)
def test_more_planes_across_a_target_tend_to_what_many_planes_find(name):
    scene = glinting(*GLINTS[name])
    packed = pack(scene)
    poses = make_poses(scene, packed.ground, np.array([0]))
    right = trace_model(packed, Model(planes=MANY, targets=(0,)), poses)
    for planes, across, low, high in ((2, 4, 0.0, 0.01), (2, 16, 0.0, 0.002), (32, 0, 0.01, np.inf)):
        record = trace_model(packed, Model(planes=planes, across=across, targets=(0,)), poses)
        assert low <= compare_records(packed.arrays, poses, record, right).beyond < high


PIPE = ((-4.0, 20.0, 0.3), (6.0, 14.0, 0.3), 0.3)
BALL = ((1.0, -15.0, 0.6), 0.6)


@pytest.mark.parametrize("planes", [1, 2, 3, 10, 11])
@pytest.mark.parametrize("across", [4, 16])
def test_divided_sectors_leave_no_azimuth_out_and_none_twice(planes, across):
    half = math.radians(10.0)
    arrays = arrays_of(np.zeros((8, 8)), 4.0, periodic=True, half_width=half, solids=[PIPE, BALL])
    laid = lay_planes(arrays, poses_of([0.0, 0.5, 60.0], 0.0, 8.0), planes, across=across)
    assert (laid.last > laid.first).all()
    assert np.unique(laid.first).size == 3
    for fan in (laid.of(0), laid.of(1)):
        assert fan.angle.sum() == pytest.approx(math.pi)
        for hand in (1.0, -1.0):
            of_hand = hand * fan.azimuth >= 0.0
            order = np.argsort(fan.s_low[of_hand])
            low, high = fan.s_low[of_hand][order], fan.s_high[of_hand][order]
            np.testing.assert_allclose(np.append(low, 1.0), np.append(0.0, high), atol=1e-9)


def test_divided_sectors_of_a_pattern_are_those_of_its_planes():
    half = math.radians(2.0)
    beam = {"half_width": half, "pattern": gaussian_pattern(half)}
    arrays = arrays_of(np.zeros((8, 8)), 4.0, periodic=True, solids=[BALL], **beam)
    poses = poses_of(0.0, 0.0, 8.0)
    whole, divided = (lay_planes(arrays, poses, 2, across=across).of(0) for across in (0, 16))
    assert divided.azimuth.size > whole.azimuth.size
    assert divided.angle.sum() == pytest.approx(whole.angle.sum())
    assert (divided.s_high - divided.s_low).sum() == pytest.approx((whole.s_high - whole.s_low).sum())


def test_a_ping_does_not_depend_on_those_traced_with_it():
    scene = edit(glinting(*GLINTS["large ball"], 40), {"track.speed": 1.0})
    packed, model = pack(scene), Model(planes=4, across=8, targets=(0,))
    together = trace_model(packed, model, make_poses(scene, packed.ground, np.arange(40)))
    alone = [trace_model(packed, model, make_poses(scene, packed.ground, np.array([k]))) for k in range(40)]
    np.testing.assert_array_equal(together, np.concatenate(alone))


def test_an_estimated_error_beyond_the_tolerance_is_told():
    hard = edit(load_scene("default"), {"sonar.beam.width": 10.0, "track.pings": 2, "seabed.relief.rms": 0.3})
    with pytest.warns(PlanWarning, match=r"the estimated error of the record is .* more than the tolerance of 0.1 %"):
        simulate(hard, tolerance=0.001)
    for call in (prepare, simulate, lambda *scene, **how: next(simulate_blocks(*scene, **how))):
        with pytest.warns(PlanWarning) as told:
            call(hard, tolerance=0.001)
        assert [warning.filename for warning in told] == [__file__]
    easy = edit(hard, {"sonar.beam": "knife", "targets": []})
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        prepare(easy)


@pytest.mark.parametrize("planes", [5, 8, 16, 33])
@pytest.mark.parametrize("beam", [{"kind": "fan", "width": 1.0}, {"kind": "array", "length": 0.3, "two_way": True}])
def test_the_image_of_a_level_fish_has_the_planes_of_the_fish_and_no_pings_have_none(planes, beam):
    scene = edit(load_scene("ghosts"), {"sonar.beam": beam})
    packed = pack(scene)
    laid = lay_planes_of_images(packed.arrays, make_poses(scene, packed.ground, np.arange(4)), planes)
    assert all(np.unique(each.first).size == 1 for each in laid)
    fan, image = (each.of(0) for each in laid)
    for name in ("azimuth", "s_low", "s_high", "angle", "near_field"):
        np.testing.assert_array_equal(getattr(image, name)[: fan.azimuth.size], getattr(fan, name))
    if beam["kind"] == "fan":
        # From a greater height the same directions lead to places as much farther out, but for the grid of places.
        heard, near = image.reach[: fan.azimuth.size], fan.reach < 0.5
        np.testing.assert_allclose(heard[near], fan.reach[near], rtol=0.06)
    order = np.argsort(image.s_low)
    np.testing.assert_allclose(image.s_low[order][1:], image.s_high[order][:-1], atol=1e-12)
    assert image.s_low.min() == pytest.approx(-1.0)
    assert image.s_high.max() == pytest.approx(1.0)
    none = lay_planes_of_images(packed.arrays, make_poses(scene, packed.ground, np.arange(0)), planes)
    assert [each.fan.azimuth.size for each in none] == [0, 0]


@pytest.mark.parametrize(
    ("level", "tip", "level_other", "tip_other"),
    [(0.9, 0.0, 0.7, 0.0), (0.3, 0.002, 0.2, -0.003), (0.004, 0.0, 0.003, 0.001), (0.9, 0.02, 0.9, -0.02)],
)
def test_azimuths_shared_by_two_directions_of_a_fan(level, tip, level_other, tip_other) -> None:
    pattern = pack(edit(load_scene("ghosts"), {"track.pings": 1})).arrays.pattern
    assert is_top_hat(pattern)
    sines = np.sin((np.arange(1_000_000) + 0.5) / 1_000_000 * math.pi - math.pi / 2.0)
    covered = (abs(level * sines + tip) <= pattern.extent[0]) & (
        abs(level_other * sines + tip_other) <= pattern.extent[0]
    )
    response = pattern.integral[0, 1] / (2.0 * pattern.extent[0])
    expected = response * covered.mean() * math.pi
    found = shared_response(pattern, level, tip, 20.0, level_other, tip_other, 25.0)
    assert found == pytest.approx(expected, abs=2e-5)


def test_a_glint_summed_at_planes_two_deviations_apart_errs_by_a_part_in_seventy():
    """The lobe cosⁿ 2α about α = 0 has the deviation 1/(2√n); its sum over such planes errs by 2 exp(−π²/2) at most."""
    exponent, shifts = 4000, np.linspace(0.0, 1.0, 33)
    deviation = 0.5 / math.sqrt(exponent)
    step = 2.0 * deviation
    planes = (np.arange(-40, 41)[:, None] + shifts) * step
    sums = step * np.maximum(np.cos(2.0 * planes), 0.0) ** exponent
    angles = np.linspace(-20.0 * deviation, 20.0 * deviation, 20001)
    whole = np.trapezoid(np.cos(2.0 * angles) ** exponent, angles)
    errors = sums.sum(axis=0) / whole - 1.0
    assert np.abs(errors).max() == pytest.approx(2.0 * math.exp(-0.5 * math.pi**2), rel=0.01)
