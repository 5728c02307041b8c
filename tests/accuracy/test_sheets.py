"""Rays in sheets against closed forms, and against many rays one by one."""

from __future__ import annotations

import math

import numpy as np
import pytest

from beds import bed_of, gaussian_pattern, poses_of, problem_of, rough
from insonify.accuracy import compare
from insonify.charts.reference import trace
from insonify.kernels.types import LIGHT, SONAR, Water
from insonify.scene import SceneError
from insonify.sound.flat_bed import flat_bed_curve
from insonify.tracers import rays, sheets

FAN = math.radians(1.0)
POSES = poses_of([0.0, 3.7], 1.3, 8.0)
SPEEDS = np.array([[1490.0, 1490.0, 1500.0, 1500.0]])
THERMOCLINE = Water(True, np.array([-5.0, 3.0, 5.0, 20.0]), SPEEDS, np.zeros(1), 1.0, 0.0, 1500.0, 25.0)
BODIES = [((0.0, 12.0, 0.6), 0.6), ((-5.0, -15.0, 0.9), (9.0, -14.0, 0.9), 0.4)]


def bed_problem(half_width=0.0, **options):
    options = {"bins": 300, "bin_length": 0.1, **options}
    return problem_of(rough(256, 256, 0.05), 0.1, periodic=True, half_width=half_width, **options)


@pytest.mark.parametrize("law", [SONAR, LIGHT])
@pytest.mark.parametrize("half_width", [0.0, FAN])
def test_a_level_bed_is_as_its_closed_form(half_width, law):
    problem = problem_of(np.zeros((8, 8)), 4.0, periodic=True, half_width=half_width, law=law)
    record = sheets.trace(problem, poses_of(0.0, 0.0, 8.0), sheets=4, rays=4000)[0, 0]
    right = flat_bed_curve(problem, 8.0)
    first = math.ceil(1.4 * 8.0 / problem.bin_length)
    np.testing.assert_allclose(record[first:-1] / right[first:-1], record[-2] / right[-2], rtol=1e-3)


CASES = {
    "knife": bed_problem(),
    "fan": bed_problem(FAN),
    "light": bed_problem(FAN, law=LIGHT),
    "bodies": bed_problem(FAN, solids=BODIES),
    "bent": bed_problem(FAN)._replace(water=THERMOCLINE),
}


@pytest.mark.parametrize("name", CASES)
def test_sheets_and_single_rays_tend_to_the_same(name):
    problem = CASES[name]
    many = rays.trace(problem, POSES, rays=1 << 18)
    few = compare(problem, POSES, rays.trace(problem, POSES, rays=1 << 17), many)
    across = 1 if problem.half_width == 0.0 else 64
    found = compare(problem, POSES, sheets.trace(problem, POSES, sheets=across, rays=(1 << 17) // across), many)
    assert found.beyond < min(few.beyond, 0.004)
    assert abs(found.energy_bias) < 5e-4


def test_doubled_sheets_move_less_than_doubled_rays():
    problem = CASES["bodies"]
    one, two = (sheets.trace(problem, POSES, sheets=k, rays=64 * k) for k in (22, 32))
    few, more = (rays.trace(problem, POSES, rays=64 * k * k) for k in (22, 32))
    assert compare(problem, POSES, one, two).beyond < 0.5 * compare(problem, POSES, few, more).beyond


def test_no_record_depends_on_the_threads():
    poses = poses_of(np.arange(20) * 0.3, 1.3, 8.0)
    one, two = (sheets.trace(CASES["bodies"], poses, sheets=4, rays=100, threads=threads) for threads in (1, 2))
    np.testing.assert_array_equal(one, two)


def test_what_cannot_be_traced_is_refused():
    with pytest.raises(SceneError, match="bounces"):
        sheets.trace(CASES["fan"]._replace(bounces=1), POSES)
    with pytest.raises(SceneError, match="level knife or fan"):
        sheets.trace(bed_problem(FAN, pattern=gaussian_pattern(FAN)), POSES)
    with pytest.raises(SceneError, match="as many as sheets"):
        sheets.trace(CASES["fan"], POSES, sheets=8, rays=4)


def test_a_bed_with_holes():
    heights = rough(64, 64, 0.05)
    heights[20:30, 20:40] = np.nan
    problem = CASES["fan"]._replace(bed=bed_of(heights, 0.1))
    poses = poses_of(3.0, 1.0, 4.0)
    right = rays.trace(problem, poses, rays=1 << 17)
    assert compare(problem, poses, sheets.trace(problem, poses, sheets=128, rays=4096), right).all_bins < 0.006


def test_a_reference_is_right_at_nadir_too():
    problem = CASES["bodies"]
    many = rays.trace(problem, POSES, rays=1 << 19)
    assert compare(problem, POSES, trace(problem, POSES, 1 << 18), many).all_bins < 0.002
