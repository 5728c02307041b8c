"""Rays in sheets against closed forms, and against many rays one by one."""

import math

import numpy as np
import pytest

from beds import arrays_of, bed_of, gaussian_pattern, poses_of, rough, rough_arrays
from insonify.accuracy.charts.method_settings import pack_for_chart
from insonify.accuracy.charts.reference import name_rays, trace_exact_rays
from insonify.acoustics.flat_bed import flat_bed_curve
from insonify.kernels.common.types import LIGHT, SONAR, no_surface_multipath
from insonify.scene import SceneError, edit, load_scene
from insonify.statistics.record_errors import compare_records
from insonify.tracers import ray_sheets, rays, sweep
from water import water_of

FAN = math.radians(1.0)
POSES = poses_of([0.0, 3.7], 1.3, 8.0)
THERMOCLINE = water_of([-5.0, 3.0, 5.0, 20.0], [1490.0, 1490.0, 1500.0, 1500.0], surface=25.0)
BODIES = [((0.0, 12.0, 0.6), 0.6), ((-5.0, -15.0, 0.9), (9.0, -14.0, 0.9), 0.4)]


@pytest.mark.parametrize("law", [SONAR, LIGHT])
@pytest.mark.parametrize("half_width", [0.0, FAN])
def test_a_level_bed_is_as_its_closed_form(half_width, law):
    arrays = arrays_of(np.zeros((8, 8)), 4.0, periodic=True, half_width=half_width, law=law)
    record = ray_sheets.trace(arrays, poses_of(0.0, 0.0, 8.0), sheets=4, rays=4000)[0, 0]
    right = flat_bed_curve(arrays, 8.0)
    first = math.ceil(1.4 * 8.0 / arrays.bin_length)
    np.testing.assert_allclose(record[first:-1] / right[first:-1], record[-2] / right[-2], rtol=1e-3)


# Of those that run slowly each part is in one of the others.
SLOW = ("fan", "light", "pattern")
CASES = {
    "knife": rough_arrays(),
    "fan": rough_arrays(FAN),
    "light": rough_arrays(FAN, law=LIGHT),
    "bodies": rough_arrays(FAN, solids=BODIES),
    "bent": rough_arrays(FAN)._replace(water=THERMOCLINE),
    "pattern": rough_arrays(FAN, pattern=gaussian_pattern(FAN)),
    "pattern, light": rough_arrays(FAN, pattern=gaussian_pattern(FAN), law=LIGHT),
    "pattern, bent": rough_arrays(FAN, pattern=gaussian_pattern(FAN), solids=BODIES)._replace(water=THERMOCLINE),
}


@pytest.mark.parametrize("name", [pytest.param(name, marks=[pytest.mark.slow] * (name in SLOW)) for name in CASES])
def test_sheets_converge_and_single_rays_tend_to_the_same(name):
    arrays = CASES[name]
    across = (1, 1, 1) if arrays.half_width == 0.0 else (16, 32, 64)
    one, two, four = (ray_sheets.trace(arrays, POSES, sheets=n, rays=512 << k) for k, n in enumerate(across))
    first, second = compare_records(arrays, POSES, one, four).beyond, compare_records(arrays, POSES, two, four).beyond
    assert second < 0.4 * first
    assert second < 0.004
    found = ray_sheets.trace(arrays, POSES, sheets=across[-1], rays=4096)
    few, many = (rays.trace(arrays, POSES, rays=1 << k) for k in (15, 18))
    by_few, by_many = (compare_records(arrays, POSES, record, found) for record in (few, many))
    assert by_many.beyond < min(0.3 * by_few.beyond, 0.004)
    assert by_many.all_bins < 0.01
    assert abs(by_many.energy_bias) < 5e-4


def test_what_water_that_folds_returns_is_spread_over_its_bins_and_swept_alike():
    arrays, poses = pack_for_chart(load_scene("double-image"), 1)
    right = rays.trace(arrays, poses, rays=1 << 20)
    sheets = (ray_sheets.trace(arrays, poses, sheets=n, rays=16 * n) for n in (32, 128))
    one, two = (compare_records(arrays, poses, record, right) for record in sheets)
    assert one.beyond < 0.03
    assert two.beyond < min(0.3 * one.beyond, 0.01)
    assert abs(two.energy_bias) < 2e-3
    for half_width, limit in ((0.0, 0.003), (FAN / 2.0, 0.03)):
        arrays = arrays._replace(half_width=half_width)
        right = ray_sheets.trace(arrays, poses, sheets=64, rays=1 << 13)
        assert compare_records(arrays, poses, sweep.trace(arrays, poses, rays=4000), right).beyond < limit


def test_what_cannot_be_traced_is_refused():
    with pytest.raises(SceneError, match="bounces"):
        ray_sheets.trace(CASES["fan"]._replace(bounces=1), POSES)
    with pytest.raises(SceneError, match="at least one per sheet"):
        ray_sheets.trace(CASES["fan"], POSES, sheets=8, rays=4)


def test_a_bed_with_holes():
    heights = rough(64, 64, 0.05)
    heights[20:30, 20:40] = np.nan
    arrays = CASES["fan"]._replace(bed=bed_of(heights, 0.1))
    poses = poses_of(3.0, 1.0, 4.0)
    right = rays.trace(arrays, poses, rays=1 << 17)
    found = ray_sheets.trace(arrays, poses, sheets=128, rays=4096)
    assert compare_records(arrays, poses, found, right).all_bins < 0.006


def test_a_reference_is_right_at_nadir_and_has_its_first_echoes_in_sheets():
    bodies = CASES["bodies"]
    many = rays.trace(bodies, POSES, rays=1 << 19)
    assert compare_records(bodies, POSES, trace_exact_rays(bodies, POSES, 1 << 18), many).all_bins < 0.002
    arrays, poses = pack_for_chart(edit(load_scene("rough-ground"), {"sonar.bins": 200}), 2)
    many = rays.trace(arrays, poses, rays=1 << 18)
    paths = rays.trace_surface_paths(arrays, poses, rays=1 << 14)
    found = trace_exact_rays(arrays, poses, 1 << 14)
    single = rays.trace(arrays, poses, rays=1 << 14)
    first = trace_exact_rays(arrays._replace(multipath=no_surface_multipath()), poses, 1 << 14)
    np.testing.assert_array_equal(found, first + paths)
    assert compare_records(arrays, poses, first, many).beyond > 0.1  # the paths do matter
    assert compare_records(arrays, poses, found, many).beyond < compare_records(arrays, poses, single, many).beyond
    assert compare_records(arrays, poses, found, many).beyond < 0.02
    assert name_rays(arrays) == "rays in sheets, surface paths by single rays"
    assert name_rays(arrays._replace(multipath=no_surface_multipath())) == "rays in sheets"
    assert name_rays(arrays._replace(bounces=1)) == "single rays"


def test_the_change_by_more_rays_shows_the_error_of_steep_ground_that_glints():
    arrays = rough_arrays(FAN)
    steep = arrays.bed._replace(heights=4.0 * arrays.bed.heights, transposed=4.0 * arrays.bed.transposed)
    glinting = arrays._replace(bed=steep, reflectivity=np.array([[0.1, 0.6, 50.0]]))
    coarse, fine = (trace_exact_rays(glinting, POSES, 1 << n) for n in (13, 14))
    right = ray_sheets.trace(glinting, POSES, sheets=64, rays=1 << 13)
    moved = compare_records(glinting, POSES, coarse, fine).beyond
    assert compare_records(glinting, POSES, fine, right).beyond < 5.0 * moved
