"""The sweep against the ray tracer: how near, and how fast it gets nearer."""

import math

import numpy as np
import pytest

import naive
from beds import arrays_of, bed_of, poses_of, rough
from exact_rays import order
from insonify.kernels.common.types import LIGHT, SONAR
from insonify.scene import edit, load_scene
from insonify.simulation import prepare
from insonify.statistics.record_errors import compare_records
from insonify.tow.poses import take_poses
from insonify.tracers import march, rays, sweep

HEIGHTS = rough(64, 64, 0.1, 3)


def both(name, changes, pings, *, planes=1, count=1 << 18):
    """Packed scene, poses of some pings, and their records by the sweep and by rays."""
    simulation = prepare(edit(load_scene(name), changes))
    arrays, poses = simulation.arrays, simulation.poses(np.asarray(pings))
    return arrays, poses, sweep.trace(arrays, poses, planes=planes), rays.trace(arrays, poses, rays=count)


def finer(heights, times):
    """The same bilinear bed on a grid so many times finer."""
    place = np.arange(heights.shape[0] * times) / times
    return naive.heights(bed_of(heights, periodic=True), *np.meshgrid(place, place))


@pytest.mark.parametrize(
    ("heading", "times", "low", "high", "least"),
    [
        # Near the grid's axes each segment has the normal of its middle and spreads its energy evenly: both err with
        # the square of its length.
        (0.04, (2, 4, 8), 1.8, 2.2, 1e-3),
        # Densities are linear; from four times finer on what is left is the noise of the rays, 5e-5.
        (0.3, (1, 2, 4), 3.0, math.inf, 2e-4),
    ],
    ids=["along the grid", "oblique"],
)
@pytest.mark.parametrize("law", [LIGHT, SONAR])
def test_finer_grids_of_the_same_bed_converge_in_second_order_or_faster(law, heading, times, low, high, least):
    poses = poses_of(np.arange(3) * 2.74 + 0.1, 0.23, 7.0, heading)
    options = {"periodic": True, "bins": 300, "bin_length": 0.1, "law": law}
    arrays = arrays_of(HEIGHTS, 0.5, **options)
    right = rays.trace(arrays, poses, rays=1 << 21)
    # Division would keep the error of coarse cells small, too.
    whole = arrays.limits._replace(misplaced=math.inf)
    finer_arrays = (arrays_of(finer(HEIGHTS, n), 0.5 / n, **options)._replace(limits=whole) for n in times)
    errors = [compare_records(arrays, poses, sweep.trace(one, poses), right).beyond for one in finer_arrays]
    assert low < order(np.array(times), errors) < high
    assert errors[-1] < least


def test_planes_converge_in_second_order():
    arrays = arrays_of(rough(256, 256, 0.05), 0.2, periodic=True, bins=400, bin_length=0.1, half_width=0.04)
    poses = poses_of(np.arange(8) * 1.37 + 0.1, 0.23, 7.0, 0.3)
    right = sweep.trace(arrays, poses, planes=512)
    planes = np.array([8, 16, 32, 64, 128])
    errors = [compare_records(arrays, poses, sweep.trace(arrays, poses, planes=int(n)), right).beyond for n in planes]
    assert order(planes, errors) == pytest.approx(2.0, rel=0.15)  # edges of shadows cost a little


@pytest.mark.parametrize(
    ("name", "changes", "beyond", "all_bins"),
    [
        ("default", {"sonar.beam": "knife", "targets": []}, 0.012, 0.012),
        ("default", {"sonar.beam": "knife"}, 0.015, 0.015),
        ("default", {"targets": []}, 0.012, 0.015),
        ("default", {}, 0.015, 0.015),
        ("default", {"sonar.law": "light", "sonar.beam": "knife"}, 0.012, 0.015),
        ("default", {"sonar.beam": "knife", "targets": [], "track.heading": 2.0}, 0.012, 0.012),
        ("default", {"sonar.beam": "knife", "targets": [], "track.heading": 30.0}, 0.012, 0.012),
        ("default", {"targets": [], "track.heading": 30.0}, 0.012, 0.015),
        ("real-bed", {"sonar.beam": "knife"}, 0.01, 0.01),
        ("figure-4b", {"targets": []}, 0.012, 0.015),
    ],
)
def test_bundled_scenes_are_as_near_as_said(name, changes, beyond, all_bins):
    errors = compare_records(*both(name, changes, np.arange(60, 340, 70), planes=64))
    assert errors.beyond < beyond
    assert errors.all_bins < all_bins
    assert abs(errors.energy_bias) < 2e-3
    assert errors.dark_leakage < 2e-3


def test_a_beam_that_squints_is_heard_to_the_range_over_ground_that_rises():
    # The same azimuth takes in other ground ranges of high ground than of low.
    relief = {"kind": "von_karman", "rms": 1.2, "across": 40.0, "along": 40.0, "hurst": 1.0}
    changes = {"seabed.relief": relief, "sonar.beam": {"kind": "fan", "width": 4.5, "squint": 9.5}, "targets": []}
    changes |= {"track.altitude": 3.5, "sonar.range": 15.0, "sonar.bins": 150}
    errors = compare_records(*both("default", changes, np.arange(60, 340, 70), planes=16))
    assert errors.beyond < 0.015
    assert abs(errors.energy_bias) < 5e-3


@pytest.mark.parametrize("altitude", [40.5, 43.0, 46.3])
@pytest.mark.parametrize("path", ["direct", "surface_bottom_surface"])
def test_what_is_hardly_within_range_is_heard_to_the_range(altitude, path):
    # Planes are laid for heights in steps of 4 %, within which the last ground range in reach changes twofold.
    own = altitude if path == "direct" else 6.0
    seabed = {"depth": 80.0 if path == "direct" else 0.5 * (altitude + own), "relief": {"kind": "flat"}}
    surface = {"kind": "flat", "surface_echo": False, "surface_bottom": False, "second_bottom": False}
    changes = {"seabed": seabed, "water.surface": surface, "track.altitude": own, "targets": []}
    changes |= {"sonar.beam": {"kind": "gaussian", "width": 1.5}, "sonar.range": 1.03 * altitude, "sonar.bins": 200}
    _, _, record, right = both("default", changes, np.arange(2), planes=16)
    last = slice(195, None)  # up to 1.03 altitudes
    assert record[..., last].sum() == pytest.approx(right[..., last].sum(), rel=0.01)


def test_the_sweep_is_nearer_than_what_it_replaces():
    arrays, poses, swept, right = both("default", {"sonar.beam": "knife"}, np.arange(60, 340, 40))
    single, marched = rays.trace(arrays, poses, rays=1000), march.trace(arrays, poses, rays=1000, step=0.1)
    ours, *others = (compare_records(arrays, poses, record, right).beyond for record in (swept, single, marched))
    assert ours < 0.1 * min(others)


def test_small_bright_balls_enter_and_leave_the_beam_where_they_must():
    # Planes stand still while the cone's edge bends by a few per cent of its width: the flank of a ball's echo moves
    # along the track by at most that, and its sum over the pings that pass it stays.
    _, _, record, right = both("figure-4b", {}, np.arange(150, 320, 2), planes=64, count=1 << 16)
    for ground_range in (22.0, 40.0):
        near = np.hypot(ground_range, 9.85) - 0.15
        echo = slice(int(near / 0.05), int(near / 0.05) + 4)
        a, b = (r[:, 1, echo].sum(axis=1, dtype=float) for r in (record, right))
        assert a.sum() == pytest.approx(b.sum(), rel=0.03)
        assert np.abs(np.cumsum(a) - np.cumsum(b)).max() < 0.03 * b.sum()


def thermocline(above, below, top):
    """Water 10 m/s slower below so many metres over a bed at 30 m, from so many metres over it downwards."""
    depth, speeds = [0.0, 30.0 - top, 30.0 - above, 40.0], [1510.0, 1510.0, below, below]
    return {"water": {"kind": "profile", "depth": depth, "sound_speed": speeds}}


WATERS = {
    "above the bed": thermocline(above=3.0, top=6.0, below=1500.0),
    "about the sonar": thermocline(above=8.0, top=16.0, below=1500.0),
    "upside down": thermocline(above=3.0, top=6.0, below=1520.0),
}
KNIFE = {"sonar.beam": "knife", "receiver.speckle": "none"}


def bent_errors(name, changes, pings):
    """Error of each ping against rays that follow arcs."""
    arrays, poses, *records = both(name, KNIFE | changes, pings, count=100_000)
    assert arrays.water.bent
    single = [slice(k, k + 1) for k in range(len(pings))]
    return [compare_records(arrays, take_poses(poses, k), *(record[k] for record in records)) for k in single]


@pytest.mark.parametrize("water", WATERS.values(), ids=WATERS)
def test_scenes_in_thermoclines(water):
    found = [
        *bent_errors("default", water | {"targets": []}, [40, 210]),
        *bent_errors("default", water, [100, 150, 260, 330]),
        *bent_errors("targets", water, [60, 140, 220, 300]),
    ]
    beyond = [error.beyond for error in found]
    assert np.median(beyond) < 0.006
    # A broad face square to the sound puts all of its echo into a bin or two, between which a millimetre tells.
    assert max(beyond) < 0.03
    assert max(abs(error.energy_bias) for error in found) < 0.001


def test_a_mesh_in_a_thermocline():
    found = bent_errors("wreck", WATERS["about the sonar"], [100, 150, 250])
    assert max(error.beyond for error in found) < 0.015
