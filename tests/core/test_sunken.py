"""Generated wrecks and aircraft, and the library of meshes: size, place, closed parts, and what a record shows."""

import runpy
from typing import get_args

import numpy as np
import pytest
import trimesh
from scipy import sparse

from insonify import cli
from insonify.files import bundled_meshes, bundled_targets, resources
from insonify.io.meshes import read_mesh
from insonify.scene import build, edit, load_scene
from insonify.scene.targets import Pit
from insonify.scene.targets.aircraft import PLANS, ROTORS, Aircraft, PlanName
from insonify.scene.targets.parts import bars, blocks, draw_shares, roughen, skin, tube
from insonify.scene.targets.person import Person
from insonify.scene.targets.wreck import FORMS, FormName, Wreck
from insonify.simulation import prepare, simulate
from insonify.statistics.record_statistics import measure_statistics
from insonify.terrain import build_ground

WHOLE = {"position": (0.0, 0.0), "seed": 3}
CASES = [(Wreck, "form", name) for name in FORMS] + [(Aircraft, "plan", name) for name in PLANS]
OF_TYPES = ("tapered", "swordfish", "b-17", "mig-15", "huey")
SEEN = [case for case in CASES if case[0] is Wreck or case[2] in OF_TYPES]
SCENE = build(
    {
        "seabed": {"spacing": 0.25, "relief": {"kind": "fractal", "period": 64.0, "beta": 1.6, "rms": 0.02}},
        "targets": [{"kind": "wreck", "position": [12.0, 20.0], "length": 14.0}],
        "sonar": {"beam": {"kind": "fan", "width": 1.0}, "range": 40.0, "bins": 200, "ping_rate": 4.0},
        "track": {"pings": 48, "altitude": 8.0},
    }
)
SOFT = {"kind": "fractal", "period": 64.0, "rms": 0.02, "clamp": "soft", "coefficients": "gaussian"}


def volume(triangles):
    """Volume within closed parts, by the divergence theorem."""
    return float(np.linalg.det(triangles).sum()) / 6.0


def is_closed(triangles):
    """Whether every directed edge is run along as often in the other sense."""
    corners, number = np.unique(np.rint(triangles.reshape(-1, 3) * 1e6), axis=0, return_inverse=True)
    faces = number.reshape(-1, 3)
    forth = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    ways = np.unique(forth @ [len(corners), 1], return_counts=True)
    back = np.unique(forth[:, ::-1] @ [len(corners), 1], return_counts=True)
    return np.array_equal(ways[0], back[0]) and np.array_equal(ways[1], back[1])


def test_names_are_those_of_the_tables():
    assert set(get_args(FormName)) == set(FORMS)
    assert set(get_args(PlanName)) == set(PLANS)


FLAT = np.stack([*np.meshgrid(np.arange(7.0), np.arange(5.0), indexing="ij"), np.zeros((7, 5))], axis=-1)
PUNCHED = np.ones((6, 4), bool)
PUNCHED[[2, 3, 5], [1, 2, 3]] = False  # two that touch at a corner, one at the rim
STRAIGHT = np.outer(np.linspace(0.0, 10.0, 5), [1.0, 0.0, 0.0])
BAR = 0.5 * 64 * np.sin(2 * np.pi / 64) * 0.25 * 5.0


@pytest.mark.parametrize(
    ("triangles", "expected"),
    [
        (bars([[0, 0, 0]], [[3, 4, 0]], 0.5, faces=64), pytest.approx(BAR)),
        (blocks([[0, 0, 0], [5, 0, 1]], [1.0, 2.0, 3.0], [[0, 0, 0], [30, 20, 10]]), pytest.approx(12.0)),
        (skin(FLAT, 0.1, PUNCHED), pytest.approx(0.1 * 21.0)),
        (skin(tube(STRAIGHT, np.full(5, 2.0), 48), 0.1), pytest.approx(np.pi * (2.0**2 - 1.9**2) * 10.0, rel=0.01)),
    ],
    ids=["bar", "blocks", "skin around holes", "tube"],
)
def test_parts_are_closed_face_outwards_and_have_their_volumes(triangles, expected):
    assert is_closed(triangles)
    assert volume(triangles) == expected


def test_shares_depend_on_seed_and_name_alone():
    assert np.array_equal(draw_shares(1, "a", 9)[:4], draw_shares(1, "a", 4))
    assert not np.intersect1d(draw_shares(1, "a", 50), draw_shares(1, "b", 50)).size
    drawn = draw_shares(2**53, "c", 4000)
    assert 0.0 < drawn.min() < 0.01 < 0.99 < drawn.max() < 1.0
    assert drawn.mean() == pytest.approx(0.5, abs=4 / np.sqrt(12 * 4000))


def test_roughening_stays_within_its_height_and_keeps_parts_closed_and_a_skin_lies_beneath_its_grid():
    smooth = blocks([[0, 0, 0]], [1.0, 2.0, 3.0])
    rough = roughen(smooth, 0.2, 5)
    assert is_closed(rough)
    assert 0.0 < np.abs(rough - smooth).max() <= 0.2 + 1e-6
    assert skin(FLAT, 0.1, PUNCHED)[..., 2].max() == 0.0


@pytest.mark.parametrize(("kind", "name", "value"), CASES)
def test_a_whole_one_is_as_long_and_as_broad_as_declared_and_each_closed_and_of_few_triangles(kind, name, value):
    shares = ("decay",) if kind is Wreck else ("porosity", "crumpled")
    states = dict.fromkeys(shares, 0.0)
    whole = kind(**WHOLE, **states, **{name: value}, length=20.0)
    wider = "beam" if kind is Wreck else "span"
    other = kind(**WHOLE, **states, **{name: value, wider: 1.3 * whole.breadth}, length=20.0)
    corners = whole.shape().triangles
    if value in ROTORS:  # the rotor reaches ahead and beside
        rotor = whole.pieces()[2]
        assert np.hypot(rotor[..., 0] - 0.17 * 20.0, rotor[..., 1]).max() == pytest.approx(
            0.5 * whole.breadth, rel=0.02
        )
    else:
        assert np.ptp(corners[..., 0]) == pytest.approx(20.0, rel=0.01)
        assert np.ptp(corners[..., 1]) == pytest.approx(whole.breadth, rel=0.02)
        assert np.ptp(other.shape().triangles[..., 1]) == pytest.approx(1.3 * whole.breadth, rel=0.02)
        assert corners[..., 0].min() + corners[..., 0].max() == pytest.approx(0.0, abs=0.2)
    for number in range(3):
        state = dict.fromkeys(shares, 0.5 * number) | ({"engines": 4} if kind is Aircraft else {})
        shape = kind(position=(0, 0), seed=number, broken=0.4 * number, **state, **{name: value}).shape()
        assert np.isfinite(shape.triangles).all()
        assert shape.closed
        assert is_closed(shape.triangles)
        assert 400 < len(shape.triangles) < 9000


@pytest.mark.parametrize("kind", [Wreck, Aircraft])
def test_the_same_fields_make_the_same_mesh_and_every_field_another(kind):
    base = {"position": (0.0, 0.0), "broken": 0.3, "growth": 0.05}
    first = kind(**base).build().triangles
    assert np.array_equal(first, kind(**base).build().triangles)
    others = {
        "length": 13.0,
        "fish": 3,
        "seed": 2,
        "broken": 0.5,
        "buried": 0.2,
        "growth": 0.1,
        "pitch": 8.0,
        "roll": 8.0,
    }
    of_wreck = {"form": "tug", "beam": 5.0, "timber": True, "decay": 0.6}
    of_aircraft = {"plan": "delta", "span": 9.0, "engines": 2, "tail": "high", "porosity": 0.5, "crumpled": 0.4}
    others |= of_wreck if kind is Wreck else of_aircraft
    for name, value in others.items():
        changed = kind(**{**base, name: value}).build().triangles
        assert changed.shape != first.shape or not np.allclose(changed, first), name


@pytest.mark.parametrize("kind", [Wreck, Aircraft])
def test_what_is_buried_lies_below_the_bed(kind):
    ground = build_ground(SCENE)
    for buried, gap in ((0.0, 0.0), (0.4, 0.0), (0.25, 0.5)):
        target = kind(position=(12.0, 20.0), buried=buried, gap=gap, roll=15.0, heading=30.0, growth=0.05)
        level = float(ground.height_at(np.array([12.0]), np.array([20.0]))[0]) + gap
        z = target.placed(ground).triangles[..., 2]
        assert (level - z.min()) / (z.max() - z.min()) == pytest.approx(buried, abs=0.05)


def test_a_pit_has_its_depth_and_a_rim_and_ends():
    pit = Pit(10.0, 20.0, 90.0, (8.0, 4.0), 0.5)
    assert pit.heights(np.array([10.0]), np.array([20.0]))[0] == pytest.approx(-0.5)
    along = pit.heights(np.full(500, 10.0), np.linspace(20.0, 60.0, 500))
    across = pit.heights(np.linspace(10.0, 50.0, 500), np.full(500, 20.0))
    assert along.max() == pytest.approx(across.max(), rel=1e-2)
    assert along.max() == pytest.approx(0.5 * 0.6 * np.exp(-1.0 - 1.0 / 0.6), rel=1e-2)  # where the slope is 0
    assert np.argmax(along) == pytest.approx(2 * np.argmax(across), abs=2)
    assert abs(along[-1]) < 1e-8


@pytest.mark.parametrize("extent", ["periodic", "endless"])
def test_scour_changes_the_bed_about_a_wreck_alone(extent):
    scene = edit(SCENE, {"seabed.relief": SOFT | {"extent": extent}})
    before, after = build_ground(scene), build_ground(edit(scene, {"targets.0.scour": 0.8}))
    x, y = (axis.ravel() for axis in np.meshgrid(np.arange(-2.0, 26.0), np.arange(6.0, 34.0)))
    change = after.height_at(x, y) - before.height_at(x, y)
    expected = edit(scene, {"targets.0.scour": 0.8}).pits[0].heights(x, y)
    assert np.abs(change - expected).max() < 0.03  # of bilinear interpolation between nodes
    assert change.min() == pytest.approx(-0.8, abs=0.03)


def parts_of(triangles):
    """Number of triangles in each closed part."""
    corners = np.unique(np.rint(triangles.reshape(-1, 3) * 1e6), axis=0, return_inverse=True)[1].reshape(-1, 3)
    edges = np.concatenate([corners[:, :2], corners[:, 1:]])
    links = sparse.coo_array((np.ones(len(edges)), edges.T), shape=2 * (corners.max() + 1,))
    return np.bincount(sparse.csgraph.connected_components(links)[1][corners[:, 0]])


@pytest.mark.parametrize("plan", [name for name in PLANS if name not in ROTORS])
def test_wings_mirror_one_another_and_an_impact_leaves_them_straight(plan):
    whole, bent = (Aircraft(position=(0, 0), plan=plan, porosity=0, crumpled=c).pieces() for c in (0.0, 0.8))
    port, starboard = (piece.reshape(-1, 3) for piece in whole[2:4])
    assert port.max(axis=0) == pytest.approx(np.multiply(starboard, [1.0, -1.0, 1.0]).max(axis=0), abs=1e-9)
    # Turned as a whole: its spread along the span remains.
    spreads = [
        np.linalg.svd(mesh.reshape(-1, 3) - mesh.mean(axis=(0, 1)), compute_uv=False)[0] for mesh in (whole[2], bent[2])
    ]
    assert spreads[1] == pytest.approx(spreads[0], rel=0.02)


def test_the_types_have_their_published_dimensions_and_a_length_scales_them():
    # Crew manuals and type records: span and length in metres.
    for plan, span, length, engines in (
        ("spitfire", 11.23, 9.12, 1),
        ("b-17", 31.62, 22.66, 4),
        ("dakota", 28.96, 19.43, 2),
    ):
        craft = Aircraft(position=(0.0, 0.0), plan=plan)
        assert (craft.breadth, craft.overall_length, craft.value_in_force("engines")) == (span, length, engines)
        half = Aircraft(position=(0.0, 0.0), plan=plan, length=0.5 * length)
        assert half.breadth == pytest.approx(0.5 * span)
    assert Aircraft.suited_to(1000.0, "") == {"length": 12.0}


def test_what_breaks_off_turns_at_its_joint_and_the_body_stays():
    whole, broken = (Aircraft(position=(0.0, 0.0), plan="b-17", broken=share, seed=5) for share in (0.0, 0.2))
    pieces = whole.pieces()
    apart = [*broken._torn(broken.pieces(), 0.0)]
    assert np.array_equal(apart[0], broken.pieces()[0])
    moved = [np.abs(a - b).max() > 0.0 for a, b in zip(broken.pieces(), apart)]
    assert any(moved)
    assert not all(moved)
    assert len(broken.pieces()) <= len(pieces) == 8


def test_fish_stand_over_it_and_a_current_digs_before_and_leaves_a_ridge_behind():
    bare, full = (Wreck(position=(0.0, 0.0), length=20.0, fish=count) for count in (0, 30))
    assert np.array_equal(full.shape().triangles[: len(bare.shape().triangles)], bare.shape().triangles)
    fish = full.shape().triangles[len(bare.shape().triangles) :]
    assert len(parts_of(fish)) == 30
    assert fish[..., 2].min() > 0.3 * bare.shape().triangles[..., 2].max()
    pit = Pit(0.0, 0.0, 30.0, (8.0, 4.0), 0.5, 30.0)
    along = np.linspace(-24.0, 24.0, 481)
    heights = pit.heights(along * np.cos(np.pi / 6), along * np.sin(np.pi / 6))
    assert heights.min() < -0.5
    assert along[np.argmin(heights)] < 0.0 < 8.0 < along[np.argmax(heights)]
    assert heights.max() == pytest.approx(0.35 * 0.5, rel=0.2)


@pytest.mark.parametrize("form", ["person", "sack"])
def test_a_person_is_as_long_as_declared_closed_and_lies_on_the_bed_with_what_belongs_to_it(form):
    plain = {"position": (0.0, 0.0), "form": form, "spread": 0.0, "bent": 0.0, "clothing": 0.0}
    still = Person(**plain).shape()
    assert is_closed(still.triangles)
    assert still.lowest == pytest.approx(0.0)
    assert np.ptp(still.triangles, axis=(0, 1)) == pytest.approx([1.75, 0.55, 0.25], rel=0.35)
    assert np.ptp(still.triangles[..., 0]) == pytest.approx(1.75, rel=0.05)
    number = len(parts_of(still.triangles))
    others = {"length": 1.6, "clothing": 1.0, "rope": 2.0, "buried": 0.3, "roll": 180.0, "pitch": 9.0}
    others |= {"spread": 1.0, "bent": 0.7} if form == "person" else {}
    for name, value in others.items():
        shape = Person(**(plain | {name: value})).shape()
        assert is_closed(shape.triangles)
        assert shape.triangles.shape != still.triangles.shape or not np.allclose(shape.triangles, still.triangles), name
        added = {"clothing": 6, "rope": 9}.get(name, 0)  # cloths; eight parts of a rope and its weight
        assert len(parts_of(shape.triangles)) == number + added, name
    wide = Person(**(plain | {"spread": 1.0})).shape()
    assert form == "sack" or np.ptp(wide.triangles[..., 1]) > 2.0 * np.ptp(still.triangles[..., 1])
    assert Person(**(plain | {"buried": 0.4})).shape().lowest == pytest.approx(-0.4 * np.ptp(still.triangles[..., 2]))
    loose = {"position": (0.0, 0.0), "form": form, "clothing": 0.8}
    assert not np.allclose(Person(**loose, seed=1).build().triangles, Person(**loose, seed=2).build().triangles)
    assert np.array_equal(Person(**loose).build().triangles, Person(**loose).build().triangles)


@pytest.mark.usefixtures("fixed_model")
@pytest.mark.parametrize(("kind", "name", "value"), SEEN)
def test_each_returns_an_echo_and_casts_a_shadow(kind, name, value):
    target = {"kind": kind.__name__.lower(), "position": [12.0, 20.0], "length": 10.0, name: value}
    record = simulate(edit(SCENE, {"targets": [target]}), truth=True)
    assert (record.target_id == 0).sum() > 50
    assert (record.shadow > 0.5).sum() > 50


def test_the_mesh_is_a_ship_of_24_m_with_a_mast():
    corners = read_mesh("wreck")
    assert 5_000 < len(corners) < 20_000
    low, high = corners.min(axis=(0, 1)), corners.max(axis=(0, 1))
    assert 24.0 < high[0] - low[0] < 28.0
    assert high[2] > 7.0
    assert volume(corners) > 5.0  # an open or inverted part would take it away


def test_the_bed_is_as_alike_as_the_real_ones_even_patches():
    bed = measure_statistics(simulate(edit(load_scene("wreck"), {"targets": [], "track.pings": 192})))
    low, middle, high = np.percentile(bed.variation, [10.0, 50.0, 90.0])
    assert 0.25 < low < middle < high < 0.53
    # The real recording falls by -0.43 along the track and -0.21 across it.
    assert -0.7 < bed.along.slope() < -0.15
    assert -0.5 < bed.across.slope() < -0.05


def test_the_shadows_are_as_deep_as_the_real_ones_and_hull_and_mast_are_in_the_record():
    scene = load_scene("wreck")
    # 24.7 dB in the real recording.
    assert measure_statistics(simulate(scene)).shadow_depth == pytest.approx(25.0, abs=4.0)
    simulation, without = prepare(scene), prepare(edit(scene, {"targets": []}))
    starboard, pings, of_mast = 1, np.arange(240, 300, 4), np.arange(352, 378)
    a, b = (s.intensity(pings)[:, starboard] for s in (simulation, without))
    ratio = 10.0 * np.log10(a.mean(axis=0) / b.mean(axis=0))
    assert ratio[170:450].max() > 6.0  # the sides
    assert ratio[400:560].min() < -15.0  # the shadow beyond
    # The mast throws its own to the last bin.
    heard = simulation.intensity(of_mast)[:, starboard, 620:]
    far = 10.0 * np.log10(heard.reshape(len(of_mast), 4, -1).mean(axis=2))  # four stretches of range
    dark = far < np.median(far, axis=0) - 12.0
    assert (dark.sum(axis=0) >= 3).all()
    assert (dark.sum(axis=0) <= 9).all()
    assert dark.all(axis=1).sum() >= 3  # the same pings at every range: straight across the track


def test_the_library_is_what_its_script_makes_and_the_listing_names_its_measures(capsys):
    script = runpy.run_path(str(resources() / "meshes" / "make_library.py"))
    assert set(bundled_targets()) == set(script["LIBRARY"]) <= set(bundled_meshes())
    assert len(bundled_targets()) >= 12
    assert cli.main(["targets"]) == 0
    lines = dict(line.split(maxsplit=1) for line in capsys.readouterr().out.splitlines())
    assert list(lines) == list(bundled_targets())
    assert lines["drum"] == "0.89 x 0.60 x 0.60 m  steel drum of 200 l, lying"
    for name in bundled_targets():
        path = bundled_meshes()[name]
        mesh, made = trimesh.load_mesh(path, process=False), script["target"](name)
        np.testing.assert_allclose(mesh.triangles, made.triangles, atol=1e-5, err_msg=name)
        assert made.is_watertight, name
        assert all(part.volume > 0.0 for part in made.split()), name
        assert path.stat().st_size < 100_000, name
        assert 0.1 < mesh.extents.max() < 5.0, name
        assert mesh.bounds[0, 2] == 0.0, name
