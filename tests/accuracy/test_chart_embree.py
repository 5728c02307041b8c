"""Embree over a bed of triangles, beside exact rays over the bilinear one."""

from __future__ import annotations

import math

import numpy as np
import pytest

from beds import arrays_of, poses_of, rough
from insonify.accuracy.charts.embree import TriangulatedBed, explain_omission
from insonify.accuracy.record_errors import compare_records
from insonify.scene import SceneError
from insonify.tracers import rays

POSES = poses_of([0.0, 3.7], 1.3, 8.0, [0.3, 1.9])
FAN = math.radians(1.0)


def bed_arrays(**options):
    options = {"bins": 300, "bin_length": 0.1, "periodic": True, "half_width": FAN, **options}
    return arrays_of(rough(256, 256, 0.05), 0.1, **options)


@pytest.fixture(autouse=True)
def _installed():
    pytest.importorskip("embreex")


@pytest.mark.parametrize("half_width", [0.0, FAN])
def test_over_a_level_bed_every_ray_returns_the_same(half_width):
    # Triangles and bilinear cells are then one surface: only single precision is left.
    arrays = arrays_of(np.zeros((64, 64)), 1.0, periodic=True, half_width=half_width, bins=300, bin_length=0.1)
    record, right = TriangulatedBed(arrays, POSES).trace(POSES, rays=3000), rays.trace(arrays, POSES, rays=3000)
    assert compare_records(arrays, POSES, record, right).beyond < 0.01
    assert abs(compare_records(arrays, POSES, record, right).energy_bias) < 1e-5


def test_over_a_rough_bed_the_surface_differs_as_its_cells_are_cut():
    arrays = bed_arrays()
    bed = TriangulatedBed(arrays, POSES)
    own = bed.trace(POSES, rays=1 << 17)
    surface = compare_records(arrays, POSES, own, rays.trace(arrays, POSES, rays=1 << 17)).beyond
    sampling = compare_records(arrays, POSES, bed.trace(POSES, rays=4000), own).beyond
    single = compare_records(
        arrays, POSES, rays.trace(arrays, POSES, rays=4000), rays.trace(arrays, POSES, rays=1 << 17)
    ).beyond
    assert 0.005 < surface < 0.2
    assert sampling == pytest.approx(single, rel=0.5)


def test_a_bed_with_an_edge_and_a_hole_is_silent_there():
    arrays = bed_arrays(periodic=False)
    heights = arrays.bed.heights.copy()
    heights[60:80, 20:60] = np.nan
    arrays = arrays._replace(bed=arrays.bed._replace(heights=heights))
    poses = poses_of(4.0, 4.0, 6.0)
    record, right = TriangulatedBed(arrays, poses).trace(poses, rays=20_000), rays.trace(arrays, poses, rays=20_000)
    heard, dark = right > 0.0, (right == 0.0) & (record > 0.0)
    assert heard.any()
    assert dark.sum() < 0.03 * heard.sum()


def test_what_it_is_not_asked_for_is_said():
    assert "straight" in explain_omission(bed_arrays()._replace(bounces=1), POSES)
    assert "targets" in explain_omission(bed_arrays(solids=[((0.0, 9.0, 0.5), 0.5)]), POSES)
    with pytest.raises(SceneError, match="targets"):
        TriangulatedBed(bed_arrays(solids=[((0.0, 9.0, 0.5), 0.5)]), POSES)
