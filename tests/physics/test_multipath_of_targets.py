"""Multipath of round targets against launch angles and azimuths in plain NumPy."""

import itertools
import math
from functools import lru_cache, partial

import numpy as np
import pytest

from beds import arrays_of, poses_of
from brute_force import frustum, sphere
from insonify.kernels.common.types import LIGHT, SONAR
from insonify.tracers import rays, sweep
from sea_surfaces import naive_target_ghost, under_sea

ALTITUDE, DEPTH = 8.0, 7.0
WAYS = ("surface_bottom", "surface_bottom_surface", "second_bottom")
BALL = ((0.05, 12.0, 0.9), 0.6)
PIPE = ((-4.0, 13.0, 0.5), (5.0, 12.5, 0.7), 0.3)
CONE = ((0.3, 11.0, 0.2), (0.3, 11.0, 2.2), 1.0, 0.2)
LYING_CONE = ((-1.5, 12.0, 1.2), (1.5, 13.0, 0.8), 0.9, 0.3)
BODIES = {
    "ball": (BALL, sphere(*BALL)),
    "pipe": (PIPE, frustum(*PIPE, PIPE[2])),
    "cone": (CONE, frustum(*CONE)),
    "lying cone": (LYING_CONE, frustum(*LYING_CONE)),
}
DULL, SHINY, NARROW = (0.7, 0.0, 1.0), (0.5, 0.4, 20.0), (0.0, 1.0, 200.0)


def alone(body, material, law, half_width=0.0):
    """A body over a black bed."""
    arrays = arrays_of(
        np.zeros((4, 4)), 0.5, periodic=True, bins=1200, bin_length=0.05, law=law, half_width=half_width,
        reflectivity=[material, (0.0, 0.0, 1.0)], solids=[body],
    )  # fmt: skip
    return arrays._replace(bed=arrays.bed._replace(materials=np.ones_like(arrays.bed.materials)))


def ghost(trace, arrays, way):
    pose = poses_of(0.0, 0.0, ALTITUDE)
    return (trace(under_sea(arrays, ALTITUDE + DEPTH, way), pose).astype(float) - trace(arrays, pose))[0, 0]


@lru_cache
def twin(name, way, law, material, across=1, up=20_000, half_width=0.0):
    body, meet = BODIES[name]
    arrays = alone(body, material, law, half_width)
    return naive_target_ghost(arrays, meet, material, ALTITUDE, DEPTH, way, across=across, up=up)


def compare(trace, name, way, law, material, half_width=0.0, **grid):
    right = twin(name, way, law, material, half_width=half_width, **grid)
    record = ghost(trace, alone(BODIES[name][0], material, law, half_width), way)
    return np.linalg.norm(record - right) / np.linalg.norm(right), abs(record.sum() / right.sum() - 1.0)


EVERY = pytest.mark.parametrize(("name", "way"), list(itertools.product(BODIES, WAYS)))
# Every body and every way once; a knife, which is quick, has all pairs.
SOME = pytest.mark.parametrize(
    ("name", "way"),
    [
        pytest.param(name, way, marks=[pytest.mark.slow] * (name != "ball" and way != WAYS[number % 3]))
        for number, name in enumerate(BODIES)
        for way in WAYS
    ],
)


@pytest.mark.parametrize(
    ("law", "material", "most", "bias"),
    [
        # The grid of angles resolves 0.06 % of the bins.
        (LIGHT, DULL, 0.001, 0.0005),
        (SONAR, SHINY, 0.003, 0.003),
        pytest.param(LIGHT, SHINY, 0.001, 0.0005, marks=pytest.mark.slow),
        pytest.param(SONAR, DULL, 0.003, 0.003, marks=pytest.mark.slow),
    ],
)
@EVERY
def test_a_knife_hears_a_round_body_as_a_grid_of_angles_does(name, way, law, material, most, bias):
    error, off = compare(sweep.trace, name, way, law, material)
    assert error < most
    assert off < bias


@SOME
def test_rays_come_near_the_light_of_a_round_body(name, way):
    """Rays of equal steps of angle are sparse in slant range at a body's edge: they converge slowly."""
    error, off = compare(partial(rays.trace, rays=1 << 17), name, way, LIGHT, DULL)
    assert error < 0.06
    assert off < 0.02


@pytest.mark.parametrize(("law", "bias"), [(LIGHT, 0.004), (SONAR, 0.001)])
@pytest.mark.parametrize(("name", "way"), list(itertools.product(("ball", "pipe"), WAYS)))
def test_a_narrow_lobe_of_a_round_body_has_its_energy(name, way, law, bias):
    assert compare(sweep.trace, name, way, law, NARROW)[1] < bias


@SOME
def test_a_fan_averages_the_light_of_a_round_body(name, way):
    fan = {"half_width": math.radians(1.0), "across": 401, "up": 1000}
    error, off = compare(partial(sweep.trace, planes=256), name, way, LIGHT, DULL, **fan)
    assert error < 0.005
    assert off < 0.003
