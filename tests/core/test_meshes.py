"""Rays against triangles: no leaks, brute force, and a fine mesh of a sphere against the sphere."""

import math

import numpy as np
import pytest

import brute_force
from beds import arrays_of, box_mesh, icosphere, mesh_of, poses_of
from insonify.kernels.common.types import LIGHT, SONAR
from insonify.packing.containment import solid_angle
from insonify.scene import Scene, SceneError, edit, load_scene
from insonify.simulation import prepare, simulate
from insonify.statistics.record_errors import compare_records
from insonify.tracers import march, rays

FLAT = np.zeros((8, 8))
DEEP = -1e6  # a bed out of the way
NOTHING = -2
MAP = np.array([500_000.0, 5_800_000.0, 0.0])


def alone(mesh, **options):
    """A mesh over a bed so deep that nothing else is met."""
    return arrays_of(np.full((2, 2), DEEP), 1.0, periodic=True, mesh=mesh, **options)


def unit(vectors):
    return vectors / np.linalg.norm(vectors, axis=1, keepdims=True)


def test_one_triangle_and_of_two_that_share_an_edge_always_the_same():
    mesh = mesh_of([(0, 0, 0), (2, 0, 0), (0, 2, 0)], [(0, 1, 2)], target=3)
    origins = [(0.5, 0.5, 4), (0.5, 0.5, -4), (1.5, 1.5, 4), (1.0, 1.0, 3), (0, 0, 5), (2, 0, 6), (-1, 0.5, 0)]
    directions = [(0, 0, -1), (0, 0, 1), (0, 0, -1), (0, 0, -1), (0, 0, -1), (0, 0, -1), (1, 0, 0)]
    distance, what, normal = rays.cast(alone(mesh), origins, directions)
    np.testing.assert_array_equal(distance, [4, 4, math.inf, 3, 5, 6, math.inf])
    assert what.tolist() == [3, 3, NOTHING, 3, 3, 3, NOTHING]
    # From either side, and the normal is turned against the ray.
    np.testing.assert_array_equal(normal[:2], [(0, 0, 1), (0, 0, -1)])
    # On a shared edge the first in the tree is met, whatever else there is.
    mesh = mesh_of([(0, 0, 0), (1, 0, 0), (1, 1, 0.5), (0, 1, 0)], [(0, 1, 2), (0, 2, 3)])
    for n in (1, 7, 64):
        normal = rays.cast(alone(mesh), [(0.5, 0.5, 9.0)] * n, (0, 0, -1))[2]
        np.testing.assert_array_equal(normal, np.tile(mesh.normal[0], (n, 1)))


@pytest.mark.parametrize("centre", [(0.0, 0.0, 0.0), MAP])
def test_brute_force_agrees(centre):
    rng = np.random.default_rng(1)
    vertices, faces = icosphere(2)
    arrays = alone(mesh_of(vertices * rng.uniform(0.6, 1.4, (len(vertices), 1)) + centre, faces))
    bodies, found, twin = brute_force.bodies_of(arrays), [], []
    for origin in centre + 5.0 * unit(rng.normal(size=(30, 3))):
        ways = unit(centre + rng.uniform(-1.2, 1.2, (100, 3)) - origin)
        distance, _, normal = rays.cast(arrays, origin, ways)
        met, cosines = (np.array(columns) for columns in zip(*(meet(origin, ways) for meet in bodies)))
        found.append((distance, -(normal * ways).sum(axis=1)))
        twin.append((met.min(axis=0), np.take_along_axis(cosines, met.argmin(axis=0)[None], axis=0)[0]))
    (distance, cosine), (right, incidence) = (np.moveaxis(records, 1, 0) for records in (found, twin))
    hit = np.isfinite(right)
    assert 0.2 < hit.mean() < 0.9
    error = 1e-7 if centre is MAP else 1e-12
    np.testing.assert_allclose(distance, right, rtol=0.0, atol=error)
    np.testing.assert_allclose(cosine[hit], incidence[hit], rtol=0.0, atol=error)


@pytest.mark.parametrize("centre", [(0.0, 0.0, 0.0), MAP])
def test_no_ray_slips_through_an_edge_or_a_corner(centre):
    # From inside a closed surface every ray meets it, whatever it is aimed at: 10⁵ points of edges, every corner.
    rng = np.random.default_rng(2)
    vertices, faces = icosphere(3)
    vertices = vertices + centre
    edges = vertices[np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])]
    picked = edges[rng.integers(0, len(edges), 100_000)]
    share = rng.choice([0.0, 0.5, 1.0, math.nan], (100_000, 1))
    share = np.where(np.isnan(share), rng.random((100_000, 1)), share)
    goals = (1.0 - share) * picked[:, 0] + share * picked[:, 1]
    origins = centre + rng.uniform(-0.3, 0.3, (100_000, 3))
    arrays = alone(mesh_of(vertices, faces))
    distance, what, _ = rays.cast(arrays, origins, goals - origins)
    assert (what == 0).all()
    np.testing.assert_allclose(distance, np.linalg.norm(goals - origins, axis=1), atol=1e-7)
    # The same from outside: through a point of an edge in front, towards a point inside.
    outside = goals - 3.0 * unit(origins - goals)
    _, what, _ = rays.cast(arrays, outside, goals - outside)
    assert (what == 0).all()


def test_boxes_that_lie_along_the_axes_and_walls_at_grazing_do_not_leak():
    # Rays exactly along axes, along faces' planes, through edges and corners of a cube on integers.
    mesh = box_mesh((0.0, 0.0, 0.0), (1.0, 1.0, 1.0))
    places = np.array([(x, y) for x in (0.0, 0.25, 0.5, 1.0) for y in (0.0, 0.25, 0.5, 1.0)])
    for axis in range(3):
        for sign in (-1.0, 1.0):
            origins = np.insert(places, axis, 0.5 - 4.5 * sign, axis=1)
            direction = np.insert([0.0, 0.0], axis, sign)
            distance, what, normal = rays.cast(alone(mesh), origins, direction)
            assert (what == 0).all()
            np.testing.assert_allclose(distance, 4.0, atol=1e-12)
            np.testing.assert_array_equal(normal[(places == 0.25).any(1)][0], -direction)
    # A wall seen at 0.001 rad, cut into strips: every ray meets it, nearer rays nearer.
    y = np.linspace(0.0, 100.0, 201)
    vertices = np.concatenate([np.column_stack([y, 0 * y, 0 * y]), np.column_stack([y, 0 * y, 0 * y + 1.0])])
    k = np.arange(200)
    faces = np.concatenate([np.column_stack([k, k + 1, k + 202]), np.column_stack([k, k + 202, k + 201])])
    across = np.linspace(0.01, 0.09, 500)
    origins = np.column_stack([np.full(500, -1.0), across, np.full(500, 0.5)])
    distance, what, _ = rays.cast(alone(mesh_of(vertices, faces)), origins, (1.0, -0.001, 0.0), reach=1e3)
    assert (what == 0).all()
    np.testing.assert_allclose(distance, across / 0.001 * math.hypot(1.0, 0.001), rtol=1e-12)


@pytest.mark.parametrize(("law", "half_width"), [(SONAR, 0.0), (SONAR, 0.02), (LIGHT, 0.0)])
def test_a_record_of_a_fine_mesh_is_that_of_the_sphere(law, half_width):
    ball = ((0.0, 18.0, 1.3), 1.0)
    options = {"periodic": True, "law": law, "half_width": half_width, "bins": 400, "bin_length": 0.1}
    sphere = arrays_of(FLAT, 4.0, solids=[ball], **options)
    mesh = arrays_of(FLAT, 4.0, mesh=mesh_of(*icosphere(4, 1.0, ball[0])), **options)
    poses = poses_of(np.array([-0.4, 0.0, 0.3]), 0.0, 10.0)
    one, other = (rays.trace(arrays, poses, rays=1 << 14) for arrays in (mesh, sphere))
    assert compare_records(sphere, poses, one, other).beyond < 0.02
    marched = march.trace(mesh, poses, step=0.01, rays=1 << 14)
    assert compare_records(sphere, poses, marched, one).beyond < 0.03
    above = ((0.0, 15.0, 14.0), 1.0)  # the fish
    sphere = arrays_of(FLAT, 4.0, solids=[above], **options)
    mesh = arrays_of(FLAT, 4.0, mesh=mesh_of(*icosphere(4, *above[::-1])), **options)
    one, other = (rays.trace(arrays, poses_of(0.0, 0.0, 10.0), rays=1 << 15)[0, 0] for arrays in (mesh, sphere))
    assert np.linalg.norm(one - other) < 0.03 * np.linalg.norm(other)


@pytest.mark.parametrize("turn", [{}, {"heading": 30.0, "pitch": 20.0, "roll": -50.0}])
def test_a_sonar_inside_a_closed_mesh_is_one_sentence(turn):
    box = {"kind": "box", "position": [0.0, 0.0, -20.0], "size": [4.0, 2.0, 2.0]} | turn
    ball = {"kind": "sphere", "position": [0.0, 30.0], "radius": 0.5}
    changes = {"targets": [ball, box], "track.pings": 40, "track.start": [-6.0, 0.0], "sonar.bins": 100}
    simulation = prepare(edit(Scene(), changes | {"track.altitude": 10.0, "track.speed": 3.0}))
    message = r"^targets\.1\.position: the sonar runs into it; move the target or raise the track$"
    for ask in (simulation.intensity, simulation.truth):
        with pytest.raises(SceneError, match=message):
            ask(np.arange(40))
        ask(np.arange(10))
    simulate(edit(simulation.scene, {"track.altitude": 13.0}))


def test_solid_angles_tell_inside_from_outside():
    vertices, faces = icosphere(2)
    corners = vertices[faces]
    rng = np.random.default_rng(4)
    for place in 0.9 * unit(rng.normal(size=(20, 3))):
        assert abs(solid_angle(corners - place)) == pytest.approx(4.0 * math.pi, abs=1e-9)
        assert solid_angle(corners - 1.5 * place) == pytest.approx(0.0, abs=1e-9)
    # A plate seen from high above its middle: its area over the square of the distance.
    plate = np.array([[[-1.0, -1.0, -100.0], [1.0, -1.0, -100.0], [1.0, 1.0, -100.0]]])
    assert abs(solid_angle(plate)) == pytest.approx(2.0 / 100.0**2, rel=1e-3)
    # A shape with a hole does not surround.
    assert abs(solid_angle(corners[: len(corners) // 2])) < 0.9 * 4.0 * math.pi


@pytest.mark.parametrize("height", [1e4, 1e6, 1e9])
def test_a_wall_of_any_height_beside_the_sonar_has_an_echo_that_is_a_number(tmp_path, height):
    path = tmp_path / "wall.obj"
    path.write_text(f"v -9 0 -9\nv 9 0 -9\nv 9 1 {height}\nv -9 1 {height}\nf 1 2 3\nf 1 3 4\n")
    changes = {
        "targets": [{"kind": "mesh", "path": str(path), "position": [1.0, 5.0, -30.0]}],
        "track.pings": 2, "sonar.bins": 60, "track.altitude": 5.0,
    }  # fmt: skip
    for method in ("sweep", "rays"):
        echo = simulate(edit(load_scene("default"), changes), method=method).intensity.values
        assert np.isfinite(echo).all()
        assert echo[0].max() > 0.0
