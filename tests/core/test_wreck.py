"""The wreck: her mesh, and a record as alike a real one as the likeness can tell."""

import numpy as np
import pytest

from insonify.io.meshes import read_mesh
from insonify.scene import edit, load_scene
from insonify.simulation import prepare, simulate
from insonify.statistics.record_statistics import measure_statistics

MAST = np.arange(352, 378)  # pings about it
STARBOARD = 1


@pytest.fixture(scope="module")
def scene():
    return load_scene("wreck")


def test_the_mesh_is_a_ship_of_24_m_with_a_mast():
    corners = read_mesh("wreck")
    assert 5_000 < len(corners) < 20_000
    low, high = corners.min(axis=(0, 1)), corners.max(axis=(0, 1))
    assert 24.0 < high[0] - low[0] < 28.0
    assert high[2] > 7.0
    # Closed parts, wound outwards, hold a volume; an open or inverted one would take it away.
    a, b, c = np.moveaxis(corners, 1, 0)
    assert (a * np.cross(b, c)).sum() / 6.0 > 5.0


def test_the_bed_is_as_alike_as_the_real_ones_even_patches(scene):
    bed = measure_statistics(simulate(edit(scene, {"targets": [], "track.pings": 192})))
    low, middle, high = np.percentile(bed.variation, [10.0, 50.0, 90.0])
    assert 0.25 < low < middle < high < 0.53
    # The real recording falls by -0.43 along the track and -0.21 across it.
    assert -0.7 < bed.along.slope() < -0.15
    assert -0.5 < bed.across.slope() < -0.05


def test_the_shadows_are_as_deep_as_the_real_ones_and_hull_and_mast_are_in_the_record(scene):
    # 24.7 dB in the real recording.
    assert measure_statistics(simulate(scene)).shadow_depth == pytest.approx(25.0, abs=4.0)
    without = edit(scene, {"targets": []})
    pings = np.arange(240, 300, 4)
    a, b = (prepare(s).intensity(pings)[:, STARBOARD] for s in (scene, without))
    ratio = 10.0 * np.log10(a.mean(axis=0) / b.mean(axis=0))
    assert ratio[170:450].max() > 6.0  # the sides
    assert ratio[400:560].min() < -15.0  # the shadow beyond


def test_the_mast_throws_its_shadow_to_the_last_bin(scene):
    heard = prepare(scene).intensity(MAST)[:, STARBOARD, 620:]
    far = 10.0 * np.log10(heard.reshape(len(MAST), 4, -1).mean(axis=2))  # four stretches of range
    dark = far < np.median(far, axis=0) - 12.0
    assert (dark.sum(axis=0) >= 3).all()
    assert (dark.sum(axis=0) <= 9).all()
    assert dark.all(axis=1).sum() >= 3  # the same pings at every range: straight across the track
