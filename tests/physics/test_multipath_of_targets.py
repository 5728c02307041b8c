"""Multipath of round targets against launch angles and azimuths in plain NumPy."""

from __future__ import annotations

import math

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


def compare(record, right):
    """Error of a record and of its energy."""
    return np.linalg.norm(record - right) / np.linalg.norm(right), record.sum() / right.sum() - 1.0


@pytest.mark.parametrize("material", [DULL, SHINY])
@pytest.mark.parametrize("law", [LIGHT, SONAR])
@pytest.mark.parametrize("way", WAYS)
@pytest.mark.parametrize("name", BODIES)
def test_a_knife_hears_a_round_body_as_a_grid_of_angles_does(name, way, law, material):
    body, meet = BODIES[name]
    arrays = alone(body, material, law)
    right = naive_target_ghost(arrays, meet, material, ALTITUDE, DEPTH, way)
    error, bias = compare(ghost(sweep.trace, arrays, way), right)
    # The grid of angles resolves 0.06 % of the bins.
    assert error < (0.001 if law == LIGHT else 0.003)
    assert abs(bias) < (0.0005 if law == LIGHT else 0.003)


@pytest.mark.parametrize("way", WAYS)
@pytest.mark.parametrize("name", BODIES)
def test_rays_come_near_the_light_of_a_round_body(name, way):
    """Rays of equal steps of angle are sparse in slant range at a body's edge: they converge slowly."""
    body, meet = BODIES[name]
    arrays = alone(body, DULL, LIGHT)
    right = naive_target_ghost(arrays, meet, DULL, ALTITUDE, DEPTH, way)
    error, bias = compare(ghost(lambda *args: rays.trace(*args, rays=1 << 17), arrays, way), right)
    assert error < 0.06
    assert abs(bias) < 0.02


@pytest.mark.parametrize("law", [LIGHT, SONAR])
@pytest.mark.parametrize("way", WAYS)
@pytest.mark.parametrize("name", ["ball", "pipe"])
def test_a_narrow_lobe_of_a_round_body_has_its_energy(name, way, law):
    body, meet = BODIES[name]
    arrays = alone(body, NARROW, law)
    right = naive_target_ghost(arrays, meet, NARROW, ALTITUDE, DEPTH, way)
    assert compare(ghost(sweep.trace, arrays, way), right)[1] == pytest.approx(
        0.0, abs=0.004 if law == LIGHT else 0.001
    )


@pytest.mark.parametrize("way", WAYS)
@pytest.mark.parametrize("name", BODIES)
def test_a_fan_averages_the_light_of_a_round_body(name, way):
    body, meet = BODIES[name]
    arrays = alone(body, DULL, LIGHT, math.radians(1.0))
    right = naive_target_ghost(arrays, meet, DULL, ALTITUDE, DEPTH, way, across=401, up=4000)
    error, bias = compare(ghost(lambda *args: sweep.trace(*args, planes=256), arrays, way), right)
    assert error < 0.005
    assert abs(bias) < 0.003
