"""Labels of range bins, against closed forms and against the record itself."""

import math

import numpy as np
import pytest
import xarray as xr

from beds import arrays_of, pipe_edges, poses_of, rough
from insonify.kernels.common.types import LIGHT, SONAR
from insonify.scene import edit, load_scene
from insonify.simulation import prepare, simulate
from insonify.tracers import sweep
from insonify.tracers.labels import trace_labels

ALTITUDE = 10.02
FLAT = np.zeros((4, 4))
NARROW = math.radians(0.5)


def both(arrays, poses, planes=4):
    return sweep.trace(arrays, poses, planes=planes), trace_labels(arrays, poses, planes=planes)


@pytest.mark.parametrize("law", [SONAR, LIGHT])
@pytest.mark.parametrize("half_width", [0.0, NARROW])
@pytest.mark.parametrize("spacing", [0.1, 3.0])
def test_a_level_bed(law, half_width, spacing):
    arrays = arrays_of(FLAT, spacing, periodic=True, law=law, half_width=half_width)
    _, truth = both(arrays, poses_of([0.0, 0.3], 0.1, ALTITUDE, 0.4))
    first = int(ALTITUDE / 0.05)
    edges = np.sqrt(np.maximum((0.05 * np.arange(1001)) ** 2 - ALTITUDE**2, 0.0))  # on the ground, 0 in the water
    heard = np.s_[..., first:]
    assert not truth.shadow.any()
    nothing = {"target_id": -2, "material": -1, "path": -1, "ground_range": np.nan, "incidence": np.nan}
    for name, value in nothing.items():
        np.testing.assert_array_equal(getattr(truth, name)[..., :first], value)
    for name, value in {"target_id": -1, "material": 0, "path": 0}.items():
        np.testing.assert_array_equal(getattr(truth, name)[heard], value)
    rounding = 1e-4
    assert (truth.ground_range[heard] >= edges[:-1][heard] - rounding).all()
    assert (truth.ground_range[heard] <= edges[1:][heard] + rounding).all()
    expected = np.degrees(np.arctan(truth.ground_range[heard] / ALTITUDE))
    np.testing.assert_allclose(truth.incidence[heard], expected, atol=0.05)


def test_a_tilted_bed_is_met_at_its_own_angle():
    """A slope of 0.2 towards the sonar: the incidence is less by the tilt."""
    x, spacing = np.arange(401), 0.25
    heights = np.broadcast_to(0.2 * (x - 200.0) * spacing, (401, 401)).T.copy()
    arrays = arrays_of(heights, spacing, x0=-50.0, y0=-50.0, bins=800)
    _, truth = both(arrays, poses_of(0.1, 0.1, 10.0))
    for side, sign in enumerate((1.0, -1.0)):
        heard = truth.target_id[0, side] == -1
        grazing = np.arctan2(10.0 - sign * 0.2 * truth.ground_range[0, side] - 0.02, truth.ground_range[0, side])
        expected = 90.0 - np.degrees(grazing) - sign * math.degrees(math.atan(0.2))
        np.testing.assert_allclose(truth.incidence[0, side][heard], np.abs(expected)[heard], atol=0.1)


def test_a_pipe_that_spans():
    """Echo 30.68–31.18 m and shadow 34.72–38.89 m; the bed between is lit."""
    scene = edit(load_scene("pipe-span"), {"track.pings": 3})
    record = simulate(scene, truth=True)
    starboard, port = record.sel(channel="starboard"), record.sel(channel="port")
    step = scene.sonar.range / scene.sonar.bins
    r = record.slant_range.values
    near, _, begins, ends = pipe_edges(1.0)
    dark = (r > begins + step) & (r < ends - step)
    np.testing.assert_array_equal(starboard.shadow.values[:, dark], 1.0)
    assert (starboard.shadow_id.values[:, dark] == 0).all()
    assert not starboard.shadow.values[:, (r < begins - step) | (r > ends + step)].any()
    assert (starboard.target_id.values[:, dark] == -2).all()
    echo = (r > near + step) & (r < near + 0.4)
    assert (starboard.target_id.values[:, echo] == 0).all()
    names = dict(zip(record.material.flag_values, record.material.flag_meanings.split()))
    assert {names[m] for m in np.unique(starboard.material.values[:, echo])} == {"steel"}
    # What meets the pipe at slant range s turns by the law of cosines from its axis.
    s = r[echo]
    expected = np.degrees(np.arccos(((near + 0.5) ** 2 - s**2 - 0.25) / (2.0 * s * 0.5)))
    np.testing.assert_allclose(starboard.incidence.values[:, echo] - expected, 0.0, atol=4.0)
    assert not port.shadow.any()
    assert set(np.unique(port.target_id)) == {-2, -1}


def test_a_mute_bed_in_sight_is_no_shadow_nor_is_where_there_is_no_bed():
    ball = ((0.0, 20.0, 0.5), 0.5)
    arrays = arrays_of(FLAT, 0.1, periodic=True, solids=[ball], reflectivity=[(0.0, 0.0, 1.0)])
    _, truth = both(arrays, poses_of(0.0, 0.0, ALTITUDE))
    assert (truth.target_id == -2).all()
    assert not truth.shadow.any()
    # A plate 20 m wide under the sonar, and a wall of holes in it.
    heights = np.zeros((201, 201))
    heights[140:150] = np.nan
    arrays = arrays_of(heights, 0.1, x0=-10.0, y0=-10.0, bins=400)
    _, truth = both(arrays, poses_of(0.0, 0.0, 5.0))
    assert not truth.shadow.any()
    assert (truth.target_id[0, :, int(math.hypot(10.0, 5.0) / 0.05) + 1 :] == -2).all()


@pytest.mark.parametrize("law", [SONAR, LIGHT])
@pytest.mark.parametrize("half_width", [0.0, NARROW])
def test_what_is_heard_has_a_contributor_and_nothing_else_has(law, half_width):
    balls = [((1.0, 11.0, 0.3), 0.8), ((2.0, -9.0, 4.0), 0.6), ((2.4, -9.5, 4.1), 0.6)]
    bodies = [((-20.0, 14.0, 1.5), (20.0, 17.0, 0.2), 0.4), *balls]
    options = {"periodic": True, "solids": bodies, "law": law, "half_width": half_width, "spreading": law == SONAR}
    arrays = arrays_of(rough(128, 128, rms=0.3), 0.2, reflectivity=[(0.6, 0.3, 5.0)], **options)
    rng = np.random.default_rng(3)
    poses = poses_of(rng.uniform(-3, 3, 24), rng.uniform(-2, 2, 24), rng.uniform(6, 9, 24), rng.uniform(-0.3, 0.3, 24))
    record, truth = both(arrays, poses, planes=6)
    np.testing.assert_array_equal(truth.target_id == -2, record == 0.0)
    np.testing.assert_array_equal(truth.path == -1, record == 0.0)
    np.testing.assert_array_equal(np.isnan(truth.ground_range), record == 0.0)
    np.testing.assert_array_equal(record[truth.shadow == 1.0] > 0.0, truth.target_id[truth.shadow == 1.0] >= 0)
    assert (truth.shadow == 1.0).any()
    assert set(np.unique(truth.target_id)) == {-2, -1, 0, 1, 2, 3}
    # The number of threads changes nothing.
    for one, other in zip(*(trace_labels(arrays, poses, planes=6, threads=threads) for threads in (1, 2))):
        np.testing.assert_array_equal(one, other)


@pytest.fixture(scope="module")
def short():
    return edit(load_scene("default"), {"track.pings": 6, "track.start": [38.0, 0.0]})


# The march as coarse as the relief: a finer one takes half a minute to plan.
@pytest.mark.parametrize(("method", "tolerance"), [("sweep", 0.03), ("march", 0.5), ("rays", 0.03)])
def test_truth_changes_nothing_else(short, method, tolerance):
    plain, full = (simulate(short, method=method, tolerance=tolerance, truth=truth) for truth in (False, True))
    xr.testing.assert_identical(plain, full[list(plain.data_vars)])
    dtypes = dict.fromkeys(("shadow", "ground_range", "incidence"), "f4") | {"path": "i1", "caustic": "?"}
    dtypes |= dict.fromkeys(("target_id", "material", "shadow_id"), "i2")
    added = {name for name in set(full.data_vars) - set(plain.data_vars) if "target" not in full[name].dims}
    assert added == set(dtypes)
    assert {name: full[name].dtype for name in added} == {name: np.dtype(d) for name, d in dtypes.items()}
    assert all(full[name].dims == full.intensity.dims for name in added)


def test_truth_is_that_of_an_ideal_pulse(short):
    """The tone of 0.1 ms of this scene reaches on by 7.5 cm, past two bins."""
    simulation = prepare(short)
    record = simulate(short, truth=True)
    traced = simulation.trace(simulation.poses(np.arange(6)))
    np.testing.assert_array_equal(np.moveaxis(record.target_id.values, 1, 0) == -2, traced == 0.0)
    assert (record.intensity.values[record.target_id.values == -2] > 0.0).any()


@pytest.mark.parametrize("law", [SONAR, LIGHT])
def test_the_strongest_is_who_sends_back_most(law):
    """Records in which all the others are mute tell what each sends back."""
    table = [(0.6, 0.3, 5.0), (0.2, 0.0, 1.0), (0.8, 0.1, 9.0), (0.4, 0.6, 20.0)]
    bodies = [((-9.0, 12.0, 1.5), (9.0, 13.0, 0.2), 0.4), ((1.0, -8.0, 0.3), 0.8)]
    options = {"periodic": True, "solids": bodies, "law": law, "half_width": NARROW, "reflectivity": table}
    arrays = arrays_of(rough(96, 96, rms=0.2), 0.25, **options)
    patches = (np.add.outer(np.arange(96) // 5, np.arange(96) // 7) % 2).astype(np.uint8)
    bed, solids = arrays.bed._replace(materials=patches, mapped=True), arrays.solids._replace(material=np.array([2, 3]))
    arrays = arrays._replace(bed=bed, solids=solids)
    poses = poses_of(np.linspace(-4.0, 4.0, 12), 0.1, 8.0, 0.1)
    rows = []
    for row in np.eye(4):
        alone = arrays._replace(reflectivity=row[:, None] * table)
        rows.append(sweep.trace(alone, poses, planes=6))
    heard, truth = both(arrays, poses, planes=6)
    ranked = np.sort(rows, axis=0)
    # Under the sonar the sweep spreads a piece over its bins a little more evenly than it is.
    clear = (heard > 0.0) & (ranked[-1] > 1.2 * ranked[-2])
    assert clear.mean() > 0.6
    strongest = np.argmax(rows, axis=0)
    np.testing.assert_array_equal(truth.material[clear], strongest[clear])
    np.testing.assert_array_equal(truth.target_id[clear], np.array([-1, -1, 0, 1])[strongest][clear])
