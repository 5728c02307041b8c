"""Targets: how they are posed, what their lowest point is, and what is wrong with a mistaken one."""

import math

import numpy as np
import pytest

from insonify.kernels.common.types import FRUSTUM
from insonify.kernels.geometry.cross_sections import HalfPlane, may_cut_solid, section_solid, solid_distance_bound
from insonify.scene import build, edit, load_scene
from insonify.scene.targets import TARGETS, Target
from insonify.scene.targets.shape import rotation_matrix
from insonify.simulation import prepare, simulate
from naive import body_depth

POSE = ("heading", "pitch", "roll")
POSES = [(0, 0, 0), (90, 0, 0), (30, 20, 0), (30, 0, 40), (-70, 35, 110), (200, -90, 10), (10, 180, 0)]
HALF_A_BOX = np.array([1.5, 1.0, 0.5])


def arrays(kind, position=(3.0, -2.0), pose=(0, 0, 0), **fields):
    """Arrays of a scene with one target, 30 m deep."""
    target = {"kind": kind, "position": [*position], **dict(zip(POSE, pose)), **fields}
    return prepare(build({"seabed": {"depth": 30.0}, "targets": [target]})).arrays


@pytest.mark.parametrize(
    ("pose", "sides"),
    [
        ((90.0, 0.0, 0.0), [[0, 1, 0], [-1, 0, 0], [0, 0, 1]]),
        ((0.0, 90.0, 0.0), [[0, 0, 1], [0, 1, 0], [-1, 0, 0]]),
        ((0.0, 0.0, 90.0), [[1, 0, 0], [0, 0, 1], [0, -1, 0]]),
        *((pose, None) for pose in POSES),
    ],
)
def test_heading_pitch_and_roll_turn_bow_up_and_port_up_in_this_order(pose, sides):
    bow, port, top = rotation_matrix(*pose).T
    if sides is not None:
        np.testing.assert_array_equal([bow, port, top], sides)
    heading, pitch, roll = np.radians(pose)
    ahead = [math.cos(heading) * math.cos(pitch), math.sin(heading) * math.cos(pitch), math.sin(pitch)]
    np.testing.assert_allclose(bow, ahead, atol=1e-15)
    assert port[2] == pytest.approx(math.cos(pitch) * math.sin(roll), abs=1e-15)
    np.testing.assert_allclose(np.cross(bow, port), top, atol=1e-15)


@pytest.mark.parametrize("pose", POSES)
def test_a_box_stands_where_its_corners_are_with_the_gap_under_its_lowest_point_and_is_closed(pose):
    mesh = arrays("box", [3.0, -2.0, -20.0], pose, size=[3.0, 2.0, 1.0]).mesh
    signs = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
    expected = (signs * HALF_A_BOX) @ rotation_matrix(*pose).T + [3.0, -2.0, 10.0]
    found = np.unique(mesh.corners.reshape(-1, 3).round(9), axis=0)
    np.testing.assert_allclose(found, np.unique(expected.round(9), axis=0), atol=1e-9)
    corners = mesh.corners - [3.0, -2.0, 10.0]
    assert ((corners.mean(axis=1) * mesh.normal).sum(axis=1) > 0).all()
    assert np.linalg.det(corners).sum() / 6.0 == pytest.approx(6.0)
    assert mesh.closed.all()
    for gap in (0.0, 0.75, -0.25):
        z = arrays("box", pose=pose, size=[3.0, 2.0, 1.0], gap=gap).mesh.corners[..., 2]
        assert z.min() == pytest.approx(gap, abs=1e-12)
        assert np.ptp(z) == pytest.approx(2.0 * abs(rotation_matrix(*pose)[2]) @ HALF_A_BOX)


@pytest.mark.parametrize("pose", POSES)
def test_the_gap_is_under_the_rim_or_apex_of_a_cone(pose):
    solids = arrays("cone", pose=pose, radius=0.8, height=1.5, gap=0.25).solids
    up, base = solids.axis[0], solids.start[0]
    assert solids.shape[0] == FRUSTUM
    # Points of the rim, and the apex.
    angle = np.linspace(0.0, 2 * np.pi, 20001)
    across = np.linalg.svd(up[None])[2][1:]
    rim = base + 0.8 * (np.cos(angle)[:, None] * across[0] + np.sin(angle)[:, None] * across[1])
    apex = base + 1.5 * up
    assert min(rim[:, 2].min(), apex[2]) == pytest.approx(0.25, abs=1e-7)
    np.testing.assert_allclose(up, rotation_matrix(*pose)[:, 2], atol=1e-15)
    np.testing.assert_allclose((0.5 * (base + apex))[:2], [3.0, -2.0], atol=1e-12)
    np.testing.assert_allclose(body_depth(solids, 0, np.array([apex, rim[0], rim[777]])), 0.0, atol=1e-9)


@pytest.mark.parametrize(("pitch", "lowest"), [(0.0, -0.5), (90.0, -2.0), (30.0, -1.0 - 0.5 * math.cos(math.pi / 6))])
def test_a_pitched_pipe_stands_on_its_lower_rim(pitch, lowest):
    solids = arrays("pipe", length=4.0, pitch=pitch).solids
    middle = solids.start[0] + 2.0 * solids.axis[0]
    np.testing.assert_allclose(middle, [3.0, -2.0, -lowest], atol=1e-12)


@pytest.mark.parametrize(
    "fields", [{"kind": "sphere"}, {"kind": "cone", "radius": 0.5}, {"kind": "box", "size": [1.0] * 3}]
)
def test_z_places_the_centre_in_the_world_and_a_gap_above_the_bed(fields):
    here = arrays(position=[3.0, -2.0, -25.0], **fields)
    middles = here.solids.start + 0.5 * here.solids.length[:, None] * here.solids.axis
    assert [*middles[:, 2], *(here.mesh.low[:1, 2] + 0.5)] == pytest.approx([5.0])
    if fields["kind"] == "sphere":
        gaps = [arrays("sphere", gap=gap).solids.start[0, 2] for gap in (-0.5, 2)]
        assert gaps == [0.0, 2.5]


def test_what_rests_on_a_rough_bed_rests_on_the_height_at_its_position():
    seabed = {"relief": {"kind": "fractal", "rms": 0.5, "period": 25.6}}
    made = prepare(build({"seabed": seabed, "targets": [{"kind": "box", "position": [3.3, -2.2]}]}))
    bed = made.ground.height_at(np.array([3.3]), np.array([-2.2]))[0]
    assert abs(bed) > 0.01
    assert made.arrays.mesh.corners[..., 2].min() == pytest.approx(bed, abs=1e-12)


def test_every_target_has_its_own_material_and_number():
    span = {"kind": "pipe", "gap": [[-5.0, 0.0], [0.0, 1.0], [5.0, 0.0]]}
    kinds = {"kind": "box"}, {"kind": "cone"}, {"kind": "mesh", "path": "tetrapod"}, span, {"kind": "box"}
    rows = zip(kinds, (0.0, 3.0, 6.0, 9.0, 50.0), ("rock", "steel", "silt", "rock", "concrete"))
    targets = [kind | {"position": [x, 0.0], "material": name} for kind, x, name in rows]
    made = prepare(build({"targets": targets})).arrays
    np.testing.assert_array_equal(made.solids.target, [1, 3, 3, 3, 3, 3, 3, 3])
    np.testing.assert_array_equal(made.solids.material, made.solids.target + 1)
    np.testing.assert_array_equal(np.unique(made.mesh.target), [0, 2, 4])
    np.testing.assert_array_equal(made.mesh.material, made.mesh.target + 1)
    # The middles of the two boxes tell that every triangle kept its number through the tree.
    assert made.mesh.corners[made.mesh.target == 4][..., 0].min() == pytest.approx(49.0)


@pytest.mark.parametrize("kind", ["sphere", "cone", "box", "mesh", "pipe"])
def test_all_bodies_take_the_same_pose_and_look_alike_if_they_are_round_about_it(kind):
    path = {"path": "tetrapod"} if kind == "mesh" else {}
    target = {"kind": kind, "position": [3.0, 12.0], "heading": 30.0, "pitch": 10.0, "roll": -5.0, "gap": 0.2, **path}
    scene = edit(load_scene("default"), {"targets": [target], "track.pings": 40})
    assert scene.targets[0].attitude == (30.0, 10.0, -5.0)
    level = edit(scene, {f"targets.0.{angle}": 0.0 for angle in (["roll"] if kind == "pipe" else POSE)})
    one, other = simulate(scene).intensity, simulate(level).intensity
    if kind == "pipe":
        np.testing.assert_allclose(one, other, rtol=1e-5)
    else:
        assert one.equals(other) == (kind == "sphere")
    assert {"position", *POSE, "gap", "material"} <= set(TARGETS.models(Target)[kind].model_fields)


BODIES = [("sphere", {"radius": 0.7}), ("cone", {}), *(("pipe", {"length": n, "radius": 0.3}) for n in (4.0, 40.0))]


@pytest.fixture(scope="module", params=BODIES, ids=["sphere", "cone", "pipe", "long pipe"])
def solids(request):
    """Solids of a body that is turned."""
    kind, fields = request.param
    return arrays(kind, [3.0, 5.0], (20, 30, 40), **fields).solids


def test_no_point_of_a_body_is_nearer_than_its_bound(solids):
    rng = np.random.default_rng(5)
    for k in range(solids.shape.size):
        middle = solids.start[k] + 0.5 * solids.length[k] * solids.axis[k]
        points = middle + rng.uniform(-3.0, 3.0, (100_000, 3))
        points = points[body_depth(solids, k, points) <= 0.0]
        for sonar in middle + rng.normal(0.0, 5.0, (20, 3)):
            nearest = np.linalg.norm(points - sonar, axis=1).min()
            bound = solid_distance_bound(solids, k, HalfPlane(*sonar, 1.0, 0.0))
            assert nearest - 4.0 * solids.radius[k] - solids.length[k] <= bound <= nearest


def test_half_planes_that_cut_a_body_within_reach_are_kept(solids):
    """A plane is passed over only if it misses the body or has the beam nowhere on it, by points of the body."""
    rng, rim, kept = np.random.default_rng(7), np.zeros(6), [0, 0]
    middle = solids.start[0] + 0.5 * solids.length[0] * solids.axis[0]
    widest = max(solids.radius[0], solids.radius[0] + solids.taper[0] * solids.length[0])
    around = 1.001 * (0.5 * solids.length[0] + widest)  # radius of a ball about the body, outside which it has no point
    x, z = np.linspace(0.0, 60.0, 600), np.linspace(-30.0, 30.0, 300)[:, None]
    for _ in range(400):
        azimuth, reach, height = rng.uniform(-np.pi, np.pi), rng.uniform(0.5, 20.0), rng.uniform(0.5, 10.0)
        sonar = middle + rng.normal(0.0, 8.0, 3)
        plane = HalfPlane(*sonar, np.cos(azimuth), np.sin(azimuth))
        cut = section_solid(solids, 0, plane, rim)[0] != 0
        off = sonar - middle
        near = (off[0] + x * plane.ex) ** 2 + (off[1] + x * plane.ey) ** 2 + (off[2] + z) ** 2 <= around**2
        row, column = np.nonzero(near & (x * height <= reach * np.maximum(np.abs(z), height)))
        points = sonar + np.outer(x[column], [plane.ex, plane.ey, 0.0]) + np.outer(z[row], [0.0, 0.0, 1.0])
        heard = bool((body_depth(solids, 0, points) <= 0.0).any())
        assert may_cut_solid(solids, 0, plane, reach, height) or not heard
        kept[0] += heard
        kept[1] += cut and not may_cut_solid(solids, 0, plane, reach, height)
    assert min(kept) > 0
