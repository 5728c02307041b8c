"""What a record tells of each target, against closed forms: boxes, shadow length, target strength."""

import math

import numpy as np
import pytest
import xarray as xr

from beds import arrays_of, poses_of
from insonify.io.records import read_record, write_record
from insonify.scene import edit, load_scene
from insonify.simulation import prepare, simulate, simulate_blocks
from insonify.tracers import sweep
from insonify.tracers.labels import PATHS, trace_labels

FLAT = np.zeros((4, 4))
ALTITUDE = 10.0


def scene_of(target, **changes):
    """A level bed of 10 m altitude, a wide beam, and one target."""
    fixed = {
        "targets": [target],
        "sonar.beam": {"kind": "fan", "width": 6.0},
        "track.start": [18.0, 0.0],
        "track.pings": 21,
    }
    return edit(load_scene("pipe-span"), fixed | changes)


def sphere_cross_section(radius, distance, diffuse):
    """Backscattering cross-section of a Lambert sphere, (k/π) ∫ cos²α dA over all that the sonar sees of it, in m²."""
    psi = np.linspace(0.0, math.acos(radius / distance), 200_001)
    psi = 0.5 * (psi[1:] + psi[:-1])
    rho = np.sqrt(distance**2 + radius**2 - 2.0 * distance * radius * np.cos(psi))
    cosine = (distance * np.cos(psi) - radius) / rho
    step = math.acos(radius / distance) / psi.size
    return 2.0 * diffuse * radius**2 * np.sum(cosine**2 * np.sin(psi)) * step


@pytest.mark.parametrize(("radius", "distance"), [(0.5, 20.0), (0.2, 35.0), (1.0, 15.0)])
def test_target_strength_of_a_lambert_sphere(radius, distance):
    """Far off it is 10 log10(2 k a² / 3): ∫ cos²α dA over a hemisphere is 2πa²/3."""
    diffuse = 0.6
    position = [20.0, distance, -22.0]  # 2 m below the sonar
    material = {"name": "steel", "diffuse": diffuse, "specular": 0.0}
    ball = {"kind": "sphere", "radius": radius, "position": position, "material": material}
    width = math.degrees(3.0 * radius / distance)  # half as wide again as the ball
    scene = scene_of(ball, **{"sonar.beam": {"kind": "fan", "width": width}})
    record = simulate(scene, truth=True, forced={"planes": "64"})
    strength = record.target_strength.sel(target="sphere_0").item()
    away = math.hypot(distance, 2.0)
    assert strength == pytest.approx(10.0 * math.log10(sphere_cross_section(radius, away, diffuse)), abs=0.03)
    assert strength == pytest.approx(10.0 * math.log10(2.0 / 3.0 * diffuse * radius**2), abs=9.0 * radius / away)


def test_target_strength_of_a_metre_of_pipe():
    """A knife takes in 1 m: (k/π) ∫ cos²α a dα over half a turn is k a / 2."""
    pipe = {"kind": "pipe", "position": [20.0, 40.0], "length": 80.0, "radius": 0.05, "gap": 8.0}
    pipe["material"] = {"name": "steel", "diffuse": 0.8, "specular": 0.0}
    record = simulate(scene_of(pipe, **{"sonar.beam": "knife"}), truth=True)
    assert record.target_strength.item() == pytest.approx(10.0 * math.log10(0.5 * 0.8 * 0.05), abs=0.01)


def test_target_strength_is_the_echo_of_the_record_without_its_spreading():
    """Over mute bed all of the record is the target's."""
    ball = ((0.3, 20.0, 3.0), 0.5)
    options = {"half_width": 0.02, "bins": 800, "spreading": True, "reflectivity": [(0.0, 0.0, 1.0), (0.5, 0.3, 6.0)]}
    arrays = arrays_of(FLAT, 0.1, periodic=True, solids=[ball], **options)
    arrays = arrays._replace(solids=arrays.solids._replace(material=np.array([1])))
    poses = poses_of([0.0, 0.2, 0.6], 0.0, ALTITUDE)
    record, found = sweep.trace(arrays, poses, planes=16), trace_labels(arrays, poses, planes=16)
    np.testing.assert_allclose(found.target_echo[..., 0], (record / arrays.range_factor).sum(axis=-1), rtol=1e-3)


def test_a_plate_casts_a_shadow_from_its_foot_to_where_its_upper_edge_comes_down():
    height, away = 1.0, 40.0
    plate = {"kind": "box", "position": [20.0, away], "size": [30.0, 0.001, height]}
    scene = scene_of(plate, **{"sonar.beam": "knife", "sonar.range": 60.0, "sonar.bins": 3000, "sonar.ping_rate": 5.0})
    record = simulate(scene, truth=True)
    step = scene.sonar.range / scene.sonar.bins
    foot, top = math.hypot(away, ALTITUDE), math.hypot(away, ALTITUDE - height)
    tip = top * ALTITUDE / (ALTITUDE - height)
    length = record.shadow_length.sel(target="box_0", channel="port").item()
    assert length == pytest.approx(tip - foot, abs=1.01 * step)
    # The surveyor's height from a shadow, A L / (R + L), with R to where the shadow begins: low by about (A/R)².
    surveyed = ALTITUDE * length / (foot + length)
    assert surveyed == pytest.approx(height, rel=(ALTITUDE / foot) ** 2 + 0.01)
    # It is exact from the range of the edge itself, where the echo begins.
    box = record.target_box.sel(target="box_0", channel="port")
    near, far = box.sel(bound="first_bin").item() * step, (box.sel(bound="last_bin").item() + 1) * step
    assert ALTITUDE * (far - near) / far == pytest.approx(height, rel=0.02)
    assert near == pytest.approx(top, abs=1.01 * step)
    assert far == pytest.approx(tip, abs=1.01 * step)
    assert record.shadow_length.sel(target="box_0", channel="starboard").item() == 0.0


@pytest.fixture(scope="module")
def targets():
    return edit(load_scene("targets"), {"track.pings": 60, "track.speed": 16.0, "sonar.bins": 500})


@pytest.fixture(scope="module")
def record(targets):
    return simulate(targets, truth=True)


def bounds_of(mask):
    """First and last ping and bin of a mask (ping, bin), -1 without any."""
    pings, bins = (np.flatnonzero(mask.any(axis=axis)) for axis in (1, 0))
    return [pings[0], pings[-1], bins[0], bins[-1]] if pings.size else [-1] * 4


def test_boxes_hold_the_labelled_bins(targets, record):
    for target in range(len(targets.targets)):
        for side in range(2):
            echo = (record.target_id.values[side] == target) & (record.path.values[side] == PATHS.index("direct"))
            dark = (record.shadow_id.values[side] == target) & (record.shadow.values[side] >= 0.5)
            for name, mask in (("echo_box", echo), ("shadow_box", dark), ("target_box", echo | dark)):
                np.testing.assert_array_equal(record[name].values[target, side], bounds_of(mask))
            spans = [np.ptp(np.flatnonzero(row)) + 1 for row in dark if row.any()]
            assert record.shadow_length.values[target, side] == pytest.approx(max(spans, default=0) * 0.08)
    assert (record.echo_box.values[..., 0] >= 0).sum() == len(targets.targets)
    assert np.isfinite(record.target_strength).all()


@pytest.mark.parametrize("suffix", [".nc", ".npz", ".zarr"])
def test_files_hold_it_for_the_whole_record(tmp_path, targets, record, suffix):
    write_record(tmp_path / f"a{suffix}", simulate_blocks(targets, truth=True, block=7))
    read = read_record(tmp_path / f"a{suffix}")
    for name in ("echo_box", "shadow_box", "target_box", "shadow_length", "target_strength"):
        xr.testing.assert_equal(read[name].reset_coords(drop=True), record[name].reset_coords(drop=True))
        if suffix != ".npz":
            assert read[name].attrs == record[name].attrs
            assert read[name].attrs["units"]
    assert list(read.target.values) == [f"{each.kind}_{k}" for k, each in enumerate(targets.targets)]


def test_blocks_tell_what_was_seen_so_far(targets, record):
    blocks = list(simulate_blocks(targets, truth=True, block=11))
    strengths = np.array([block.target_strength.values for block in blocks])
    assert (np.fmax.accumulate(strengths) == np.nan_to_num(strengths, nan=-np.inf))[~np.isnan(strengths)].all()
    np.testing.assert_array_equal(strengths[-1], record.target_strength)
    assert np.isnan(strengths[0]).any()


def test_a_target_out_of_sight_has_no_boxes_and_no_strength():
    ball = {"kind": "sphere", "radius": 0.5, "position": [20.0, 300.0]}
    found = simulate(scene_of(ball, **{"track.pings": 2}), truth=True)
    assert (found.target_box == -1).all()
    assert (found.shadow_length == 0.0).all()
    assert np.isnan(found.target_strength.item())


def test_a_scene_without_targets_tells_of_none():
    found = simulate(edit(scene_of({"kind": "sphere", "position": [0.0, 9.0]}), {"targets": []}), truth=True)
    assert "target" not in found.dims
    assert not found.shadow.any()


def test_light_has_no_target_strength():
    ball = {"kind": "sphere", "radius": 0.5, "position": [20.0, 20.0]}
    found = simulate(scene_of(ball, **{"sonar.law": "light"}), truth=True)
    assert np.isnan(found.target_strength.item())
    assert (found.echo_box.sel(channel="port") >= 0).all()


def test_pings_do_not_depend_on_how_many_are_labelled(targets):
    simulation = prepare(targets)
    whole = simulation.truth(np.arange(20))
    np.testing.assert_array_equal(whole.target_echo[7:9], simulation.truth(np.arange(7, 9)).target_echo)
