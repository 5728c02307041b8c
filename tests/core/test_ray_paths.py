import math

import numpy as np
import pytest
from pydantic import TypeAdapter

import insonify
from insonify.scene import SceneError
from insonify.scene.water import AnyWater


def water(**fields):
    return TypeAdapter(AnyWater).validate_python(fields)


LAYERED = water(kind="profile", depth=[0, 10, 20, 60], sound_speed=[1520, 1520, 1500, 1498])


def test_a_hit_of_the_bed_is_a_rays_own_last_point():
    paths = insonify.ray_paths(LAYERED, 5.0, [2.0, 10.0, 60.0, -5.0, 90.0], max_range=500.0, bottom=60.0)
    assert paths.sizes["ray"] == 5
    hits = paths.hit.values
    np.testing.assert_array_equal(hits.sum(axis=1), [1, 1, 1, 0, 1])
    np.testing.assert_allclose(paths.range.values[hits], [475.430622, 239.228222, 31.281329, 0.0], atol=6e-7)
    np.testing.assert_allclose(paths.depth.values[hits], 60.0)
    np.testing.assert_allclose(paths.time.values[hits][:3], [0.3179804118, 0.1632912097, 0.0421014320], atol=6e-11)
    np.testing.assert_allclose(paths.tube.values[hits][:3], [863.1684, 211.6164, 62.3989], atol=6e-5)
    for row, k in zip(paths.depth.values, hits.argmax(axis=1)):
        assert k == 0 or np.isnan(row[k + 1 :]).all()
    assert list(paths.end.values) == ["bottom", "bottom", "bottom", "surface", "bottom"]


def test_points_lie_at_the_ranges_asked_for_and_uniform_water_bends_nothing():
    paths = insonify.ray_paths(LAYERED, 5.0, 2.0, max_range=400.0, bottom=60.0, ranges=[0.0, 100.0, 333.0])
    np.testing.assert_array_equal(paths.range.values, [[0.0, 100.0, 333.0]])
    assert not paths.hit.any()
    assert paths.end.values[0] == "range"
    assert float(paths.grazing[0, 0]) == pytest.approx(2.0, abs=1e-12)
    paths = insonify.ray_paths(water(kind="uniform", sound_speed=1480.0), 3.0, [30.0], max_range=40.0)
    np.testing.assert_allclose(paths.depth[0], 3.0 + math.tan(math.radians(30.0)) * paths.range[0])
    np.testing.assert_allclose(paths.time[0] * 1480.0, paths.range[0] / math.cos(math.radians(30.0)))
    np.testing.assert_allclose(paths.tube[0], paths.range[0] / math.cos(math.radians(30.0)))


def test_eigenrays_are_told_by_launch_angle_with_their_intensity():
    even = water(kind="uniform", sound_speed=1500.0)
    rays = insonify.eigenrays(even, 30.0, 75.0, 50.0, bottom=50.0, reflections=2)
    straight, by_surface = math.hypot(75.0, 20.0), math.hypot(75.0, 80.0)
    by_both = math.hypot(75.0, 120.0)
    np.testing.assert_allclose(np.sort(rays.time * 1500.0), [straight, by_surface, by_both], rtol=1e-12)
    np.testing.assert_allclose(rays.intensity, (rays.time * 1500.0) ** -2.0, rtol=1e-9)
    assert (np.diff(rays.angle) > 0.0).all()
    assert sorted(zip(rays.by_surface.values.tolist(), rays.by_bottom.values.tolist())) == [(0, 0), (1, 0), (1, 1)]
    down = insonify.eigenrays(even, 10.0, 0.0, 40.0)  # one straight down spreads as any
    assert down.angle.values.tolist() == [90.0]
    assert float(down.intensity[0]) == pytest.approx(30.0**-2)


def test_a_section_of_equal_profiles_joins_points_as_layers_do():
    section = water(
        kind="section", distance=[-10, 70, 900], depth=[0, 10, 20, 60], sound_speed=[[1520, 1520, 1500, 1498]] * 3
    )
    for x, depth in ((80.0, 40.0), (300.0, 15.0), (30.0, 60.0)):
        ours, layered = (
            insonify.eigenrays(kind, 5.0, x, depth, bottom=60.0, reflections=1) for kind in (section, LAYERED)
        )
        assert ours.sizes == layered.sizes
        np.testing.assert_allclose(ours.angle, layered.angle, rtol=0, atol=1e-8)
        np.testing.assert_allclose(ours.time, layered.time, rtol=0, atol=1e-12)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"angles": [[1.0, 2.0]]}, "angles: has 2 dimensions"),
        ({"angles": 95.0}, "angles: 95 must lie between -90 and 90 degrees"),
        ({"angles": [1.0, math.nan]}, "angles: nan"),
        ({"source_depth": -1.0}, "source_depth: -1"),
        ({"source_depth": 70.0}, "source_depth: 70 is not valid; the bed is at 60 m"),
        ({"bottom": 0.0}, "bottom: 0"),
        ({"max_range": 0.0}, "max_range: 0"),
        ({"max_range": math.inf}, "max_range: inf"),
        ({"ranges": [1.0, 101.0]}, "ranges: 101 must lie between 0 and max_range, 100 m"),
        ({"ranges": [1.0, 1.0]}, "ranges: must increase"),
    ],
)
def test_a_wrong_number_is_told_in_a_sentence(change, words):
    given = {"source_depth": 5.0, "angles": 10.0, "max_range": 100.0, "bottom": 60.0} | change
    with pytest.raises(SceneError, match=words):
        insonify.ray_paths(LAYERED, **given)
    with pytest.raises(SceneError, match="section"):  # which has no shadow zones
        insonify.shadow_zones(water(kind="section"), 5.0, 30.0, max_range=100.0)


def test_a_declared_surface_sends_rays_back():
    calm = water(kind="uniform", sound_speed=1500.0, surface={"kind": "flat"})
    path = insonify.ray_paths(calm, 20.0, [-45.0], max_range=60.0, bottom=100.0, ranges=[20.0, 60.0]).isel(ray=0)
    np.testing.assert_allclose(path.depth.values, [0.0, 40.0], atol=1e-9)
    np.testing.assert_allclose(path.time.values[-1] * 1500.0, 60.0 * math.sqrt(2.0), rtol=1e-12)
    assert path.end == "range"
