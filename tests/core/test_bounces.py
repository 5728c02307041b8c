"""Rays that go on after their first hit: mirrors, lenses and the ghosts they bring, in closed form."""

import itertools
import math

import numpy as np
import pytest

from beds import BOX_FACES, arrays_of, box_corners, icosphere, mesh_of, poses_of, rough
from brute_force import strength
from insonify.compiler.jit import kernel
from insonify.kernels.common.scattering import backscatter_strength, bistatic_strength
from insonify.kernels.common.types import BED, LIGHT, SONAR
from insonify.kernels.rays.path_tracing import advance_to, meet_next, split_path, start_path
from insonify.planning import plan
from insonify.scene import SceneError, edit, load_scene
from insonify.simulation import prepare
from insonify.tracers import rays

DEEP = np.full((2, 2), -1e6)  # a bed out of the way
SHINY = (0.5, 0.4, 7.0)
WALL = [(-99.0, 20.0, -99.0), (99.0, 20.0, -99.0), (99.0, 20.0, 99.0), (-99.0, 20.0, 99.0)]
QUAD = [(0, 1, 2), (0, 2, 3)]
CUBE = box_corners((-0.5,) * 3, (0.5,) * 3)


def scene_of(interface, *, mesh=None, mesh_material=0, **options):
    """A scene out of whose way the bed is, with the interface of each material."""
    if mesh is not None:
        mesh = mesh._replace(material=np.full(len(mesh.material), mesh_material))
    options = {"reflectivity": [(0.0, 0.0, 1.0)] * len(interface), "bins": 700, **options}
    return arrays_of(DEEP, periodic=True, mesh=mesh, **options)._replace(interface=np.array(interface, dtype=float))


def test_two_facing_mirrors():
    # Seven metres apart, slantwise between them: the gain is the product of the coefficients, range by range.
    walls = mesh_of([*np.array(WALL) - (0, 20, 0), *np.array(WALL) - (0, 13, 0)], [*QUAD, (4, 5, 6), (4, 6, 7)])
    walls = walls._replace(material=np.where(walls.corners[:, 0, 1] == 0.0, 0, 1))
    arrays = scene_of([(0.9, 1.0), (0.7, 1.0)])._replace(mesh=walls)
    paths = rays.follow(arrays, (0.0, 3.0, 0.0), (0.4, 1.0, 0.1), 9)
    k = np.arange(10)
    assert paths.bounce.tolist() == k.tolist()
    np.testing.assert_allclose(paths.length, (4.0 + 7.0 * k) * math.sqrt(1.17), rtol=1e-9)
    np.testing.assert_allclose(paths.position[:, 1], np.where(k % 2 == 0, 7.0, 0.0), atol=1e-8)
    np.testing.assert_allclose(paths.position[:, 0], 0.4 * (4.0 + 7.0 * k), rtol=1e-8)
    np.testing.assert_allclose(paths.throughput, 0.49 ** ((k + 1) // 2) * 0.81 ** (k // 2), rtol=1e-12)


@pytest.mark.parametrize("reflection", [0.5, 0.9, 1.0])
def test_a_closed_furnace(reflection):
    # Inside a closed surface of albedo a all hits together carry 1 + a + a² + … : 1 / (1 − a) but for a^depth.
    rng = np.random.default_rng(1)
    arrays = scene_of([(reflection, 1.0)], mesh=mesh_of(*icosphere(2, 5.0)))
    paths = rays.follow(arrays, rng.uniform(-2, 2, (200, 3)), rng.normal(size=(200, 3)), 16)
    a, carried = reflection**2, np.bincount(paths.ray, paths.throughput)
    depth = np.searchsorted(-(a ** np.arange(17)), -1e-6, side="right")  # the faintest are dropped
    np.testing.assert_allclose(carried, (a ** np.arange(depth)).sum(), rtol=1e-9)
    if a < 1.0:
        np.testing.assert_allclose(carried, 1.0 / (1.0 - a), rtol=2.0 * a**depth / (1.0 - a) + 1e-9)


def test_energy_is_neither_made_nor_lost_where_nothing_absorbs():
    # Perfect walls around bodies of all kinds: what a hit reflects and what it lets through are all that came.
    rng = np.random.default_rng(2)
    bodies = [((2.0, 0.0, 0.0), 1.0), ((-3.0, -1.0, 0.0), (-1.0, -2.0, 1.0), 0.4, 0.9), ((0.0, 2.0, -2.0), 0.7)]
    room, box = icosphere(2, 6.0), CUBE * 1.5 + (0.0, 0.0, 2.5)
    mesh = mesh_of([*room[0], *box], [*room[1].tolist(), *(np.array(BOX_FACES) + len(room[0])).tolist()], target=7)
    arrays = scene_of([(0.6, 1.6), (1.0, 1.0), (0.3, 0.6)], solids=bodies)
    outside = np.linalg.norm(mesh.corners, axis=2).min(axis=1) > 5.9
    arrays = arrays._replace(
        mesh=mesh._replace(material=np.where(outside, 1, 2), target=np.where(outside, 8, 7)),
        solids=arrays.solids._replace(material=np.array([0, 2, 0])),
    )
    origins = rng.uniform(-4, 4, (600, 3))
    from_water = rays.cast(arrays, origins, (0, 0, 1))[1] == 8
    paths = rays.follow(arrays, origins[from_water], rng.normal(size=(from_water.sum(), 3)), 5)
    carried = np.zeros((from_water.sum(), 6))
    np.add.at(carried, (paths.ray, paths.bounce), paths.throughput)
    assert (carried <= 1.0 + 1e-12).all()
    # What is lost is what was dropped for being faint.
    assert np.median(carried[:, -1]) > 0.999
    assert (carried[:, 2] > 0.999).mean() > 0.9


def test_a_lens_by_snell_and_by_its_focus():
    # A ball of speed ratio 2/3 (n = 1.5) focuses rays near its axis n R / (2 (n − 1)) = 1.5 R behind its middle.
    arrays = scene_of([(0.2, 2.0 / 3.0)], solids=[((0.0, 0.0, 0.0), 1.0)])
    arrays = arrays._replace(bed=arrays.bed._replace(heights=np.full((2, 2), -3.0, np.float32), low=-3.0, high=-3.0))
    offsets = np.array([1e-3, 1e-2, 0.3, 0.7])
    paths = rays.follow(arrays, np.column_stack([offsets, 0 * offsets, 0 * offsets + 4.0]), (0, 0, -1), 2)
    on_ball = np.abs(np.linalg.norm(paths.position, axis=1) - 1.0) < 1e-9
    through = np.flatnonzero((paths.bounce == 2) & (paths.what == BED))
    landed, left = paths.position[through], paths.position[(paths.bounce == 1) & on_ball]
    np.testing.assert_array_equal(paths.ray[through], np.arange(4))
    # By hand: the chord turns by β − α at either face, sin β = sin α / n.
    alpha = np.arcsin(offsets)
    beta = np.arcsin(offsets / 1.5)
    place = alpha - 2.0 * beta
    np.testing.assert_allclose(left[:, 0], -np.sin(place), atol=1e-9)
    np.testing.assert_allclose(left[:, 2], -np.cos(place), atol=1e-9)
    turned = 2.0 * (alpha - beta)
    np.testing.assert_allclose(landed[:, 0], left[:, 0] - (left[:, 2] + 3.0) * np.tan(turned), atol=1e-9)
    # Inside a metre takes 1.5 times as long as in water.
    lengths = 4.0 - np.cos(alpha) + 1.5 * 2.0 * np.cos(beta) + (left[:, 2] + 3.0) / np.cos(turned)
    np.testing.assert_allclose(paths.length[through], lengths, rtol=1e-9)
    np.testing.assert_allclose(paths.throughput[through], 0.96**2, rtol=1e-12)
    focus = left[:, 2] - left[:, 0] * (landed[:, 2] - left[:, 2]) / (landed[:, 0] - left[:, 0])
    assert -focus[0] == pytest.approx(1.5, rel=1e-5)
    assert -focus[1] == pytest.approx(1.5, rel=1e-3)


@pytest.mark.parametrize("shift", [(0.0, 0.0, 0.0), (500_000.0, 5_800_000.0, 0.0)])
def test_a_slab_shifts_a_ray_and_steel_turns_it_back(shift):
    # A closed box of triangles: in and out again parallel; beyond the critical angle everything is reflected.
    box, bound = mesh_of(CUBE * (40.0, 40.0, 2.0) + shift, BOX_FACES), 1e-10 if shift[0] == 0.0 else 1e-6
    for speeds, sine, passes in ((1.5, 0.3, True), (0.7, 0.6, True), (3.9, 0.3, False)):
        arrays = scene_of([(0.8, speeds)], mesh=box)
        start = np.add(shift, (0.1, 0.2, 4.0))
        direction = np.array([sine, 0.0, -math.sqrt(1.0 - sine**2)])
        paths = rays.follow(arrays, start, direction, 1)
        inside = paths.position[paths.bounce == 1]
        if not passes:
            assert not len(inside)
            continue
        slope = speeds * sine / math.sqrt(1.0 - (speeds * sine) ** 2)
        step = 2.0 * slope
        np.testing.assert_allclose(inside[0] - paths.position[0], (step, 0.0, -2.0), atol=bound)
        assert paths.length[1] - paths.length[0] == pytest.approx(math.hypot(step, 2.0) / speeds, abs=bound)
        assert paths.throughput[1] == pytest.approx(1.0 - 0.64, abs=1e-12)


def test_a_chain_of_cylinders_is_one_body():
    # A bent pipe: the ball in its elbow and the flat ends inside it are no surfaces to a ray within.
    elbow = [((-4.0, 0.0, 0.0), (0.0, 0.0, 0.0), 0.5), ((0.0, 0.0, 0.0), (3.0, 2.0, 0.0), 0.5), ((0.0, 0.0, 0.0), 0.5)]
    arrays = scene_of([(0.5, 1.0)], solids=elbow)
    arrays = arrays._replace(solids=arrays.solids._replace(target=np.zeros(3, dtype=np.int64)))
    paths = rays.follow(arrays, (-6.0, 0.0, 0.1), (1.0, 0.02, 0.0), 1)
    assert paths.bounce.tolist() == [0, 1]
    np.testing.assert_allclose(paths.position[0, 0], -4.0, atol=1e-12)
    assert paths.position[1, 0] > 0.4


@kernel
def last_edges(arrays, bundle, through, out):
    """Follow each ray, passing on where ``through`` says so and mirrored elsewhere: where it ends, and its edges."""
    for k in range(bundle.x.size):
        path = start_path(bundle, k)
        for passes in through:
            meeting = meet_next(arrays, path, 1e3)
            path = advance_to(arrays, path, meeting)
            waiting = [path]
            waiting.pop()
            split_path(arrays, path, meeting, 1e9, waiting)
            path = waiting[0] if passes else waiting[-1]
        path = advance_to(arrays, path, meet_next(arrays, path, 1e3))
        out[k, 0], out[k, 1], out[k, 2] = path.x, path.y, path.z
        out[k, 3], out[k, 4], out[k, 5] = path.up.x, path.up.y, path.up.z
        out[k, 6], out[k, 7], out[k, 8] = path.across.x, path.across.y, path.across.z


BALL = (0.0, 12.0, 4.0), 1.5
PIPE = (-3.0, 12.0, 4.0), (4.0, 12.5, 4.4), 1.5
CONE = (0.0, 12.0, 6.0), (0.3, 12.5, 1.0), 0.9, 2.6


@pytest.mark.parametrize(
    ("body", "through"),
    [
        *itertools.product([BALL, PIPE, CONE], ([False], [True, True])),
        (BALL, [True, False, True]),
    ],
)
def test_the_edges_of_a_tube_are_what_neighbouring_rays_show(body, through):
    # Off and through balls, pipes and cones, onto the walls and the floor of a room around them.
    room = mesh_of(CUBE * 60.0, BOX_FACES)
    arrays = scene_of([(0.5, 0.8), (1.0, 1.0)], solids=[body], mesh=room, mesh_material=1)._replace(bounces=9)
    elevation, azimuth, step = -0.44, 1.53, 1e-5
    e, a = elevation + step * np.array([0, 1, -1, 0, 0]), azimuth + step * np.array([0, 0, 0, 1, -1])
    ways = np.column_stack([np.cos(e) * np.cos(a), np.cos(e) * np.sin(a), np.sin(e)])
    out = np.empty((5, 9))
    last_edges(arrays, rays._bundle((0.0, 0.0, 10.0), ways), np.array(through), out)
    up = (out[1, :3] - out[2, :3]) / (2.0 * step)
    across = (out[3, :3] - out[4, :3]) / (2.0 * step) / math.cos(elevation)
    np.testing.assert_allclose(out[0, 3:6], up, rtol=1e-5, atol=1e-5 * np.abs(up).max())
    np.testing.assert_allclose(out[0, 6:9], across, rtol=1e-5, atol=1e-5 * np.abs(across).max())


def circle_cut(image, sonar, centre, radius, mixed, arrays):
    """Ghosts of a circle in the athwart plane by a dense sum along it, (bins,); image and sonar as (y, z)."""
    psi = np.linspace(-math.pi, math.pi, 2_000_001)
    normal = np.column_stack([np.cos(psi), np.sin(psi)])
    point = centre + radius * normal
    s, r = (np.linalg.norm(point - eye, axis=1) for eye in (image, sonar))
    cos_s, cos_r = (((eye - point) * normal).sum(1) / d for eye, d in ((image, s), (sonar, r)))
    if not mixed:
        r, cos_r = s, cos_s
    away = (((image - point) * ((sonar if mixed else image) - point)).sum(1)) / (s * r)
    seen = (cos_s > 0.0) & (cos_r > 0.0)
    ranges = 0.5 * (s + r)
    value = (2.0 if mixed else 1.0) * strength(cos_s, SHINY, SONAR, other=cos_r, towards=away)
    value *= ranges**4 / (s * r) ** 2 * radius * (psi[1] - psi[0])
    return np.bincount((ranges[seen] / arrays.bin_length).astype(int), value[seen], arrays.bins)[: arrays.bins]


def test_ghosts_of_a_ball_before_a_mirror():
    # The wall at y = 20 shows the ball to an image of the sonar at y = 40: straight echo, mixed and retro ghost.
    centre, radius, gain = np.array([12.0, 4.0]), 0.8, 0.9
    arrays = scene_of(
        [(1.0, 1.0), (gain, 1.0)], solids=[((0.0, *centre), radius)], mesh=mesh_of(WALL, QUAD), mesh_material=1,
        reflectivity=[SHINY, (0.0, 0.0, 1.0)], bins=350, bin_length=0.1,
    )  # fmt: skip
    sonar, image = np.array([0.0, 10.0]), np.array([40.0, 10.0])
    record = rays.trace(arrays._replace(bounces=1), poses_of(0.0, 0.0, 10.0), rays=1 << 18)[0, 0]
    direct = rays.trace(arrays, poses_of(0.0, 0.0, 10.0), rays=1 << 18)[0, 0]
    mixed, retro = (circle_cut(image, sonar, centre, radius, m, arrays) for m in (True, False))
    ghosts = record.astype(float) - direct
    first = np.flatnonzero(ghosts > 1e-6 * ghosts.max())[0] * 0.1
    assert first == pytest.approx(np.flatnonzero(mixed)[0] * 0.1, abs=0.11)
    assert int((np.linalg.norm(image - centre) - radius) / 0.1) == np.flatnonzero(retro)[0]
    np.testing.assert_array_equal(ghosts[: np.flatnonzero(mixed)[0]], 0.0)
    for expected in (gain**2 * mixed, gain**4 * retro):
        window = slice(np.flatnonzero(expected)[0] - 2, np.flatnonzero(expected)[-1] + 3)
        assert np.linalg.norm(ghosts[window] - expected[window]) < 0.01 * np.linalg.norm(expected)
    assert ghosts.sum() == pytest.approx((gain**2 * mixed + gain**4 * retro).sum(), rel=0.01)


def test_the_retro_ghost_is_what_an_image_of_the_sonar_hears():
    # In a fan, over rough ground and a ball: the record from behind a perfect mirror, without the mirror.
    heights = np.roll(rough(64, 64, 0.2, seed=4), 16, axis=0)
    options = {"periodic": True, "half_width": math.radians(3.0), "bins": 240, "bin_length": 0.25}
    options |= {"solids": [((0.3, 14.0, 2.0), 1.0)], "reflectivity": [SHINY, (0.0, 0.0, 1.0)]}
    bare = arrays_of(heights, 0.5, **options)._replace(interface=np.array([[0.0, 1.0], [1.0, 1.0]]))
    wall = mesh_of(WALL, QUAD)
    mirror = bare._replace(mesh=wall._replace(material=np.ones(2, np.int64)))
    pose, image = poses_of(0.0, 0.0, 9.0), poses_of(0.0, 40.0, 9.0, math.pi)
    with_ghosts = rays.trace(mirror._replace(bounces=1), pose, rays=1 << 16)[0, 0].astype(float)
    with_ghosts -= rays.trace(mirror, pose, rays=1 << 16)[0, 0]
    # A turned fish behind the wall hears to port what the mirror shows.
    heard = rays.trace(bare, image, rays=1 << 16)[0, 0]
    straight = rays.trace(mirror, pose, rays=1 << 16)[0, 0]
    late = slice(170, 240)  # beyond the mixed ghosts of what lies before the wall
    assert straight[late].sum() == 0.0
    ranges = (np.arange(240) + 0.5) * 0.25
    assert ranges[170] > 40.0
    assert np.linalg.norm(with_ghosts[late] - heard[late]) < 0.05 * np.linalg.norm(heard[late])


def test_nothing_changes_where_nothing_goes_on():
    arrays = arrays_of(rough(64, 64, 0.2), 0.5, periodic=True, half_width=0.02)
    poses = poses_of(np.arange(12) * 0.3, 0.0, 8.0)
    once = rays.trace(arrays, poses, rays=400)
    np.testing.assert_array_equal(once, rays.trace(arrays._replace(bounces=4), poses, rays=400))
    ball = arrays._replace(interface=np.array([[0.5, 1.2]]), bounces=3)
    one, other = (rays.trace(ball, poses, rays=400, threads=n) for n in (1, 3))
    np.testing.assert_array_equal(one, other)
    assert (one >= once).all()
    assert (one > once).any()


@pytest.mark.parametrize("law", [LIGHT, SONAR])
@pytest.mark.parametrize("shininess", [1.0, 5.0, 7.5])
def test_bistatic_strength_of_one_way_is_the_monostatic(law, shininess):
    for c in np.linspace(-0.1, 1.0, 101):
        monostatic = backscatter_strength(c, 0.3, 0.6, shininess, law)
        bistatic = bistatic_strength(c, c, 2.0 * c * c - 1.0, 0.3, 0.6, shininess, law)
        np.testing.assert_allclose(monostatic, bistatic, rtol=1e-14)


def test_bounces_ask_for_rays():
    few = {"sonar.range": 30.0, "sonar.bins": 60, "sonar.beam": "knife"}
    scene = edit(load_scene("default"), few | {"sonar.bounces": 2})
    chosen = plan(scene)
    assert chosen.method == "rays"
    assert "2 bounces" in chosen.lines()[0]
    for method in ("sweep", "march"):
        with pytest.raises(SceneError, match=r"sonar\.bounces"):
            plan(scene, method=method)


def test_figure_1_hears_its_ball_three_times():
    # The mirror's face is at y = 26.9 and the ball at (20, 0.8): the sonar's image is at y = 53.8, ten metres up.
    scene = edit(load_scene("figure-1"), {"sonar.pulse": "ideal", "sonar.bounces": 1})
    mirrored, straight = (
        prepare(edit(scene, {"sonar.bounces": n}), method="rays", tolerance=0.1, forced={"bounces": "on"}).intensity(
            np.array([50])
        )[0, 0]
        for n in (1, 0)
    )
    angle = np.linspace(0.0, 2.0 * math.pi, 100_001)
    place = np.array([20.0, 0.8]) + 0.8 * np.column_stack([np.cos(angle), np.sin(angle)])
    near, far = np.linalg.norm(place - (0.0, 10.0), axis=1), np.linalg.norm(place - (53.8, 10.0), axis=1)
    lit = ((place - (20.0, 0.8)) * ((0.0, 10.0) - place)).sum(1) > 0.0
    lit_by_mirror = ((place - (20.0, 0.8)) * ((53.8, 10.0) - place)).sum(1) > 0.0
    mixed = (0.5 * (near + far))[lit & lit_by_mirror].min()
    for first, record in ((near.min(), straight), (mixed, mirrored - straight), (far.min(), mirrored - straight)):
        bin_ = int(first / 0.06)
        assert record[bin_ : bin_ + 2].max() > 3.0 * record[bin_ - 6 : bin_ - 1].max()
