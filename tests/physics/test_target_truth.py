"""What a record tells of each target: boxes, strength and shadows, against closed forms, brute force and records."""

import math

import numpy as np
import pytest
import xarray as xr

import brute_force
from beds import arrays_of, box_mesh, poses_of, rough
from insonify.acoustics.beam_patterns import make_pattern
from insonify.io.records import read_record, write_record
from insonify.kernels.common.contributors import empty_contributor_table
from insonify.kernels.common.types import LIGHT, SONAR
from insonify.kernels.labels.refracted_labels import label_refracted_pings
from insonify.kernels.labels.sweep_labels import LabelledPings
from insonify.packing.packed_scene import without_targets
from insonify.scene import edit, load_scene
from insonify.simulation import simulate, simulate_blocks
from insonify.tracers import rays, sweep
from insonify.tracers.labels import PATHS, describe_contributors, empty_labels, trace_labels, turn_into_degrees
from insonify.tracers.plane_counts import empty_squares
from receptions import decibels
from water import water_about

FLAT = np.zeros((4, 4))
ALTITUDE = 10.0


def scene_of(target, **changes):
    """A level bed of 10 m altitude, a wide beam, and one target."""
    fixed = {"targets": [target], "sonar.beam": {"kind": "fan", "width": 6.0}}
    return edit(load_scene("pipe-span"), fixed | {"track.start": [18.0, 0.0], "track.pings": 21} | changes)


def sphere_cross_section(radius, distance, diffuse):
    """Backscattering cross-section of a Lambert sphere, (k/π) ∫ cos²α dA over all that the sonar sees of it, in m²."""
    psi = np.linspace(0.0, math.acos(radius / distance), 200_001)
    psi = 0.5 * (psi[1:] + psi[:-1])
    rho = np.sqrt(distance**2 + radius**2 - 2.0 * distance * radius * np.cos(psi))
    cosine = (distance * np.cos(psi) - radius) / rho
    step = math.acos(radius / distance) / psi.size
    return 2.0 * diffuse * radius**2 * np.sum(cosine**2 * np.sin(psi)) * step


def test_target_strengths_of_lambert_spheres_and_a_metre_of_pipe():
    """Far off a sphere has 10 log10(2 k a² / 3): ∫ cos²α dA over a hemisphere is 2πa²/3."""
    steel = {"name": "steel", "diffuse": 0.6, "specular": 0.0}
    for radius, distance in ((0.5, 20.0), (0.2, 35.0), (1.0, 15.0)):
        ball = {"kind": "sphere", "radius": radius, "position": [20.0, distance, -22.0]}  # 2 m below the sonar
        width = math.degrees(3.0 * radius / distance)  # half as wide again as the ball
        scene = scene_of(ball | {"material": steel}, **{"sonar.beam": {"kind": "fan", "width": width}})
        record = simulate(scene, truth=True, forced={"planes": "64"})
        strength, away = record.target_strength.sel(target="sphere_0").item(), math.hypot(distance, 2.0)
        assert strength == pytest.approx(decibels(sphere_cross_section(radius, away, 0.6)), abs=0.03)
        assert strength == pytest.approx(decibels(2.0 / 3.0 * 0.6 * radius**2), abs=9.0 * radius / away)
    # A knife takes in 1 m of a pipe: (k/π) ∫ cos²α a dα over half a turn is k a / 2.
    pipe = {"kind": "pipe", "position": [20.0, 40.0], "length": 80.0, "radius": 0.05, "gap": 8.0}
    pipe["material"] = steel | {"diffuse": 0.8}
    record = simulate(scene_of(pipe, **{"sonar.beam": "knife"}), truth=True)
    assert record.target_strength.item() == pytest.approx(decibels(0.5 * 0.8 * 0.05), abs=0.01)


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


def bounds_of(mask):
    """First and last ping and bin of a mask (ping, bin), -1 without any."""
    pings, bins = (np.flatnonzero(mask.any(axis=axis)) for axis in (1, 0))
    return [pings[0], pings[-1], bins[0], bins[-1]] if pings.size else [-1] * 4


def test_boxes_and_strengths_are_those_of_labels_in_the_record_its_files_and_its_blocks(tmp_path):
    targets = edit(load_scene("targets"), {"track.pings": 60, "track.speed": 16.0, "sonar.bins": 500})
    record = simulate(targets, truth=True)
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
    for suffix in (".nc", ".npz", ".zarr"):
        write_record(tmp_path / f"a{suffix}", simulate_blocks(targets, truth=True, block=7))
        read = read_record(tmp_path / f"a{suffix}")
        for name in ("echo_box", "shadow_box", "target_box", "shadow_length", "target_strength"):
            xr.testing.assert_equal(read[name].reset_coords(drop=True), record[name].reset_coords(drop=True))
            if suffix != ".npz":
                assert read[name].attrs == record[name].attrs
                assert read[name].attrs["units"]
        assert list(read.target.values) == [f"{each.kind}_{k}" for k, each in enumerate(targets.targets)]
    blocks = list(simulate_blocks(targets, truth=True, block=11))
    strengths = np.array([block.target_strength.values for block in blocks])
    assert (np.fmax.accumulate(strengths) == np.nan_to_num(strengths, nan=-np.inf))[~np.isnan(strengths)].all()
    np.testing.assert_array_equal(strengths[-1], record.target_strength)
    assert np.isnan(strengths[0]).any()


def test_a_target_out_of_sight_has_no_boxes_and_like_one_in_light_no_strength():
    ball = {"kind": "sphere", "radius": 0.5, "position": [20.0, 20.0]}
    found = simulate(scene_of(ball | {"position": [20.0, 300.0]}, **{"track.pings": 2}), truth=True)
    assert (found.target_box == -1).all()
    assert (found.shadow_length == 0.0).all()
    assert np.isnan(found.target_strength.item())
    lit = simulate(scene_of(ball, **{"sonar.law": "light"}), truth=True)
    assert np.isnan(lit.target_strength.item())
    assert (lit.echo_box.sel(channel="port") >= 0).all()
    bare = simulate(scene_of(ball, targets=[]), truth=True)
    assert "target" not in bare.dims
    assert not bare.shadow.any()


DEGREE = math.radians(1.0)
BINS, STEP = 600, 0.05
LENGTH, FREQUENCY, SPEED = 0.2, 400e3, 1500.0
BALL, BEHIND = ((0.0, 20.0, 0.5), 0.5), ((0.1, 22.0, 1.2), 0.3)
PIPE = ((-3.0, 18.0, 0.9), (3.0, 22.5, 0.9), 0.3)  # oblique, above the bed, its ends out of sight
CORNERS = (-0.4, 17.0, 0.0), (0.5, 18.0, 0.8)
BLOCK = brute_force.box(np.mean(CORNERS, axis=0), np.eye(3), 0.5 * np.ptp(CORNERS, axis=0))


ARRAY = brute_force.line_array(LENGTH, SPEED / FREQUENCY)
BEAMS = {  # by kind: further fields, response and azimuths
    "knife": ({}, brute_force.knife, [0.0]),
    "fan": ({"width": 1.0}, brute_force.fan(DEGREE), np.linspace(-0.0106, 0.0106, 151)),
    "gaussian": ({"width": 1.0}, brute_force.gaussian(DEGREE), np.linspace(-0.034, 0.034, 201)),
    "array": ({"length": LENGTH}, ARRAY, np.linspace(-0.13, 0.13, 401)),
}


def beam_options(beam):
    """How a beam is packed, as `arrays_of` takes it."""
    declared = {"kind": beam, **BEAMS[beam][0]}
    scene = edit(load_scene("pipe-span"), {"sonar.beam": declared, "sonar.frequency": FREQUENCY})
    return dict(zip(("half_width", "pattern"), make_pattern(scene, SPEED)))


BODIES = {
    "sphere": ({"solids": [BALL]}, [brute_force.sphere(*BALL)]),
    "pipe": ({"solids": [PIPE]}, [brute_force.frustum(*PIPE, PIPE[2])]),
    "box": ({"mesh": box_mesh(*CORNERS)}, [BLOCK]),
    "sphere behind sphere": ({"solids": [BALL, BEHIND]}, [brute_force.sphere(*BALL), brute_force.sphere(*BEHIND)]),
}


@pytest.mark.parametrize("body", BODIES)
@pytest.mark.parametrize("beam", BEAMS)
@pytest.mark.parametrize("along", [0.0, 0.35])
def test_shares_are_those_of_rays_cast_with_and_without_the_target(beam, body, along):
    (declared, meets), (_, respond, azimuths) = BODIES[body], BEAMS[beam]
    arrays = arrays_of(FLAT, 0.1, periodic=True, bins=BINS, bin_length=STEP, **declared, **beam_options(beam))
    found = trace_labels(arrays, poses_of(along, 0.0, ALTITUDE), planes=128)
    fine = beam == "knife"  # of one azimuth, which many rays cost little
    share, whose = brute_force.shadow_shares(
        meets, respond, height=ALTITUDE, bins=BINS, bin_length=STEP, azimuths=azimuths, along=along,
        per_bin=256 if fine else 16,
    )  # fmt: skip
    # Brute force places an edge to a part of a bin, and the sweep one along the track to a plane of 128.
    np.testing.assert_allclose(found.shadow[0, 0], share, atol=0.003 if fine else 0.03)
    np.testing.assert_allclose(found.shadow[0, 0].sum(), share.sum(), rtol=5e-3)
    clear = share > 0.03
    np.testing.assert_array_equal(found.shadow_id[0, 0][clear], whose[clear])
    assert not found.shadow[0, 1].any()
    assert (found.shadow_id[0, 1] == -2).all()


def muted(arrays):
    """The same scene with targets that hide and return nothing."""
    rows = arrays.reflectivity.shape[0]
    return arrays._replace(
        reflectivity=np.vstack([arrays.reflectivity, [0.0, 0.0, 1.0]]),
        interface=np.vstack([arrays.interface, [0.0, 1.0]]),
        solids=arrays.solids._replace(material=np.full_like(arrays.solids.material, rows)),
        mesh=arrays.mesh._replace(material=np.full_like(arrays.mesh.material, rows)),
    )


def far_off(arrays):
    """The same scene with its targets out of reach; without any, or higher ones, planes would be laid otherwise."""
    solids = arrays.solids._replace(start=arrays.solids.start + np.array([1e5, 1e5, 0.0]))
    return arrays._replace(solids=solids, mesh=without_targets(arrays).mesh)


def share_of_records(trace, arrays, poses, **options):
    """What a record of mute targets lacks of one without targets, and where that one is not faint."""
    with_targets, without = (trace(each, poses, **options) for each in (muted(arrays), far_off(arrays)))
    return 1.0 - with_targets / np.where(without > 0.0, without, 1.0), without > 0.05 * np.median(without)


ROUGH = {"heights": rough(128, 128, rms=0.25), "spacing": 0.25, "periodic": True, "bins": 400, "bin_length": 0.08}
SOLIDS = [BALL, PIPE, ((-14.0, -15.0, 0.6), (14.0, -13.0, 0.6), 0.4)]
POSES = poses_of([0.0, 0.4, 1.0], [0.0, 0.1, 0.0], [9.0, 9.2, 9.1], [0.0, 0.02, -0.01])


@pytest.mark.parametrize("law", [SONAR, LIGHT])
@pytest.mark.parametrize("beam", BEAMS)
def test_shares_are_what_mute_targets_take_from_the_record(beam, law):
    """A rough bed, some of which hides itself: what the bed hides anyway is no shadow of a target."""
    arrays = arrays_of(**ROUGH, solids=SOLIDS, mesh=box_mesh(*CORNERS, target=3), law=law, **beam_options(beam))
    found = trace_labels(arrays, POSES, planes=12)
    expected, loud = share_of_records(sweep.trace, arrays, POSES, planes=12)
    np.testing.assert_allclose(found.shadow[loud], expected[loud], atol=1e-3)
    assert {-2, 0, 1, 2, 3} == set(np.unique(found.shadow_id))
    np.testing.assert_array_equal(found.shadow_id == -2, found.shadow == 0.0)
    assert found.shadow.min() == 0.0
    assert found.shadow.max() == 1.0


@pytest.mark.parametrize("beam", BEAMS)
def test_shares_are_those_of_records_by_rays(beam):
    arrays = arrays_of(**ROUGH, solids=SOLIDS, mesh=box_mesh(*CORNERS, target=3), **beam_options(beam))
    found = trace_labels(arrays, POSES, planes=128).shadow
    expected, loud = share_of_records(rays.trace, arrays, POSES, rays=400_000)
    difference = (found - expected)[loud]
    assert np.sqrt(np.mean(difference**2)) < 0.01
    assert abs(difference.mean()) < 0.001


@pytest.mark.parametrize(("rms", "spacing", "turned"), [(0.25, 0.25, 3.5), (0.1, 0.5, 2.0)])
def test_labels_by_rays_along_arcs_are_those_of_the_sweep(rms, spacing, turned):
    water = water_about(12.0, [0.0, 4.0, 8.0, 54.0], [1490.0, 1490.0, 1494.0, 1495.0])
    bed = ROUGH | {"heights": rough(128, 128, rms), "spacing": spacing}
    arrays = arrays_of(**bed, solids=SOLIDS[:2], half_width=0.02)._replace(water=water)
    poses = poses_of([0.0, 0.4], 0.0, 12.0)
    swept = trace_labels(arrays, poses, planes=64)
    table = empty_contributor_table(1, 2, 1, 400)
    found, described = empty_labels(2, 400, 2), describe_contributors(arrays)
    out = LabelledPings(found, *np.empty((2, 2, 2, 400), np.float32), empty_squares(0), np.arange(2))
    label_refracted_pings(arrays, without_targets(arrays), poses, 100_000, described, table, out)
    turn_into_degrees(found.incidence)
    assert (swept.shadow[:, 0] > 0.5).sum() > 30
    assert np.sqrt(np.mean((found.shadow - swept.shadow) ** 2)) < 0.03
    assert (np.abs(found.shadow - swept.shadow) < 0.05).mean() > 0.98
    both = (found.shadow > 0.05) & (swept.shadow > 0.05)
    assert (found.shadow_id == swept.shadow_id)[both].mean() > 0.99
    assert (found.target_id == swept.target_id).mean() > 0.98
    assert {-2, -1, 0, 1} == set(swept.target_id.ravel())
    same = (found.target_id == swept.target_id) & (found.target_id != -2)
    assert np.quantile(np.abs(found.ground_range - swept.ground_range)[same], 0.9) < 0.15
    assert np.quantile(np.abs(found.incidence - swept.incidence)[same], 0.5) < turned


def test_bed_hidden_by_bed_is_no_shadow_of_a_target():
    """Beyond a wall of bed nothing is heard with or without the ball there."""
    heights = np.zeros((400, 8))
    heights[120:124] = 4.0
    arrays = arrays_of(heights, 0.1, x0=-0.4, y0=0.0, bins=600, solids=[((0.0, 16.0, 0.5), 0.5)])
    found = trace_labels(arrays, poses_of(0.0, 5.0, 6.0))
    assert not found.shadow.any()
    dark = np.s_[0, 0, int(math.hypot(8.0, 6.0) / 0.05) : int(math.hypot(21.0, 6.0) / 0.05)]
    assert (found.target_id[dark] == -2).all()
