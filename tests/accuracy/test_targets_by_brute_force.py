"""Echoes of round and flat targets with specular lobes of any width, against a grid of rays in plain NumPy."""

import math

import numpy as np
import pytest

from beds import BOX_FACES, arrays_of, box_corners, mesh_of, poses_of
from brute_force import box, frustum, sphere, target_record
from insonify.scene.targets.shape import rotation_matrix
from insonify.tracers import ray_sheets, sweep

NO_BED = np.full((4, 4), np.nan)
HEIGHT, BINS, BIN = 10.0, 600, 0.05
FAN = math.radians(0.5)


def alone(half_width, material, **bodies):
    """Bodies without a bed."""
    return arrays_of(NO_BED, 10.0, half_width=half_width, bins=BINS, bin_length=BIN, reflectivity=[material], **bodies)


BALL = ((0.05, 12.0, 0.6), 0.6)
PIPE = ((-4.0, 13.0, 0.5), (5.0, 12.5, 0.7), 0.3)
CENTRE, HALF = np.array([0.3, 13.0, 1.0]), np.array([1.2, 0.9, 0.4])
# One face looks at the sonar.
AXES = rotation_matrix(0.0, 0.0, math.degrees(math.atan2(CENTRE[1], HEIGHT - CENTRE[2])))
TURNED_BOX = mesh_of(box_corners(-HALF, HALF) @ AXES.T + CENTRE, BOX_FACES)
TARGETS = {
    "sphere": (sphere(*BALL), {"solids": [BALL]}, (-0.73, -0.59)),
    "pipe": (frustum(*PIPE, PIPE[2]), {"solids": [PIPE]}, (-0.67, -0.60)),
    "box": (box(CENTRE, AXES, HALF), {"mesh": TURNED_BOX}, (-0.72, -0.48)),
}


@pytest.mark.parametrize("shininess", [25.0, pytest.param(100.0, marks=pytest.mark.slow), 1000.0])
@pytest.mark.parametrize("half_width", [0.0, FAN])
@pytest.mark.parametrize("name", TARGETS)
def test_an_echo_is_that_of_a_grid_of_rays(name, half_width, shininess):
    meet, bodies, elevations = TARGETS[name]
    arrays = alone(half_width, (0.5, 0.45, shininess), **bodies)
    right = target_record(arrays, meet, HEIGHT, elevations)
    for record in (
        sweep.trace(arrays, poses_of(0.0, 0.0, HEIGHT), planes=64),
        ray_sheets.trace(arrays, poses_of(0.0, 0.0, HEIGHT), sheets=256, rays=4096),
    ):
        assert np.linalg.norm(record[0, 0] - right) < 0.002 * np.linalg.norm(right)
        assert record[0, 0].sum() == pytest.approx(right.sum(), rel=0.001)


@pytest.mark.parametrize("shininess", [8.0, 1000.0])
def test_sheets_of_few_rays_resolve_a_small_ball(shininess):
    ball = ((0.0, 8.0, 0.2), 0.03)
    arrays = alone(FAN, (0.5587, 0.4413, shininess), solids=[ball])
    right = target_record(arrays, sphere(*ball), 6.0, (-0.632, -0.623))
    record = ray_sheets.trace(arrays, poses_of(0.0, 0.0, 6.0), sheets=1024, rays=1024)
    assert record[0, 0].sum() == pytest.approx(right.sum(), rel=0.003)


@pytest.mark.parametrize("place", [0.97, 1.0, 0.0])  # just inside the edge of the beam, across it, and athwart
@pytest.mark.parametrize("width", [24.0, 60.0])
def test_a_wide_fan_has_no_floor_on_balls(width, place):
    half, distance, height = math.radians(width) / 2.0, 16.0, 8.0
    ball = ((distance * math.sin(place * half), distance * math.cos(place * half), 0.4), 0.3)
    arrays = alone(half, (0.5, 0.2, 15.0), solids=[ball])
    steepest = math.atan2(0.4 - height, distance)
    right = target_record(arrays, sphere(*ball), height, (steepest - 0.018, steepest + 0.018), 20_000, 300)
    record = sweep.trace(arrays, poses_of(0.0, 0.0, height), planes=4096)[0, 0]
    assert np.linalg.norm(record - right) < 0.006 * np.linalg.norm(right)


def test_a_pipe_askew_is_no_comb_of_planes():
    # Across the beam the pipe's range changes by 4 bins, in each of two planes by 2.
    pipe = ((-20.0, 8.0, 0.5), (30.0, 38.0, 0.5), 0.3)
    arrays = alone(FAN, (0.5, 0.3, 12.0), solids=[pipe])
    right = target_record(arrays, frustum(*pipe, 0.3), HEIGHT, (-0.6, -0.3), 3000, 2000)
    for planes in (2, 3, 8):
        record = sweep.trace(arrays, poses_of(0.0, 0.0, HEIGHT), planes=planes)[0, 0]
        assert np.linalg.norm(record - right) < 0.05 * np.linalg.norm(right)
        assert record.sum() == pytest.approx(right.sum(), rel=0.001)
