"""What the plan takes targets to be, against their surfaces summed up, and what it foretells against the sweep."""

from __future__ import annotations

import math

import numpy as np
import pytest

from insonify.accuracy.record_errors import compare_records
from insonify.kernels.common.types import SPHERE, Solids
from insonify.planning import fitted_laws, target_errors
from insonify.planning.plane_count import predict_target_demand
from insonify.planning.predicted_errors import PredictedErrors
from insonify.planning.scene_summary import summarise_scene
from insonify.scene import SceneError, edit, load_scene
from insonify.scene.targets import mesh
from insonify.simulation import prepare
from insonify.tracers import sweep

BARE = edit(load_scene("default"), {"targets": [], "sonar.pulse": "ideal", "seabed.relief": "flat", "track.speed": 0.1})
"""A level bed 10 m below the sonar, that goes east."""
POSED = {"heading": 35.0, "pitch": 20.0}
FREE = {
    "sphere": {"kind": "sphere", "radius": 0.6},
    "pipe": {"kind": "pipe", "radius": 0.3, "length": 4.0} | POSED,
    "box": {"kind": "box", "size": [2.0, 1.0, 0.7], "roll": 30.0} | POSED,
    "cone": {"kind": "cone", "radius": 0.5, "height": 1.5, "roll": -40.0} | POSED,
    "mesh": {"kind": "mesh", "path": "wreck", "scale": 0.2, "roll": 30.0} | POSED,
}
SUBSTANCES = ("silt", "steel")


def at(target, away=25.0, up=-26.0, **changes):
    """Scene with one target to port: free in the water, or on the bed."""
    position = [5.0, away] if up is None else [5.0, away, up]
    return edit(BARE, {"targets": [{**target, "position": position}]} | changes)


def seen(scene):
    return target_errors.observe_target(scene, summarise_scene(scene), 0)


def skin(scene, count=200):
    """Places on the bodies that the tracers have, their normals and areas."""
    arrays = prepare(scene).arrays
    places, normals, areas = [], [], []
    turn = 2.0 * math.pi * (np.arange(count) + 0.5) / count
    share = (np.arange(count) + 0.5)[:, None] / count
    for row in range(arrays.solids.shape.size):
        start, axis, length, radius, taper = (getattr(arrays.solids, name)[row] for name in Solids._fields[1:6])
        if arrays.solids.shape[row] == SPHERE:
            z = np.broadcast_to(2.0 * share - 1.0, (count, count))
            level = np.sqrt(1.0 - z**2)
            normal = np.stack([level * np.cos(turn), level * np.sin(turn), z], axis=-1).reshape(-1, 3)
            places.append(start + radius * normal)
            normals.append(normal)
            areas.append(np.full(len(normal), 4.0 * math.pi * radius**2 / len(normal)))
            continue
        one = np.cross(axis, [0.3, 0.5, 0.8])
        one /= np.linalg.norm(one)
        around = np.cos(turn)[:, None] * one + np.sin(turn)[:, None] * np.cross(axis, one)
        off = radius + taper * length * share
        places.append((start + length * share[..., None] * axis + off[..., None] * around).reshape(-1, 3))
        normal = (around - taper * axis) / math.hypot(1.0, taper)
        normals.append(np.broadcast_to(normal, (count, count, 3)).reshape(-1, 3))
        ring = 2.0 * math.pi * off * length * math.hypot(1.0, taper) / count**2
        areas.append(np.broadcast_to(ring, (count, count)).ravel())
        for end, rim, facing in ((0.0, radius, -axis), (length, radius + taper * length, axis)):
            places.append(start + end * axis + rim * around)
            normals.append(np.broadcast_to(facing, (count, 3)))
            areas.append(np.full(count, math.pi * rim**2 / count))
    for corners in arrays.mesh.corners:
        normal = np.cross(corners[1] - corners[0], corners[2] - corners[0])
        places.append(corners)
        normals.append(np.broadcast_to(normal / np.linalg.norm(normal), (3, 3)))
        areas.append(np.full(3, np.linalg.norm(normal) / 6.0))
    return (np.concatenate(values) for values in (places, normals, areas))


@pytest.mark.parametrize("substance", SUBSTANCES)
@pytest.mark.parametrize("kind", ["sphere", "pipe", "box", "cone"])
@pytest.mark.parametrize("away", [25.0, -40.0])
def test_the_parts_of_a_target_return_what_its_surface_does(kind, substance, away):
    scene = at(FREE[kind] | {"material": substance}, away)
    places, normals, areas = skin(scene)
    # The sonar goes along the x axis, 6 m higher.
    cosine = np.maximum(normals @ [0.0, -away, 6.0] / math.hypot(away, 6.0), 0.0)
    of = scene.targets[0].material.reflectivity
    lobe = np.maximum(2.0 * cosine**2 - 1.0, 0.0) ** of.shininess
    right = (areas * cosine**2 * (of.diffuse + 0.5 * (of.shininess + 2.0) * of.specular * lobe)).sum()
    found = seen(scene)
    assert sum(side.echo for side in found.sides) == pytest.approx(right, rel=0.1)
    assert 0.99 <= found.length / np.ptp(places[:, 0]) < 1.4


@pytest.mark.parametrize("heading", [0.0, 50.0, 90.0])
def test_what_one_line_meets_of_a_box_and_what_the_next_ones_add_is_all_that_it_is_deep(heading):
    scene = at({"kind": "box", "size": [3.0, 1.0, 0.5], "heading": heading})
    places, normals, _ = skin(scene)
    ranges = np.hypot(places[:, 1], places[:, 2] - 10.0)
    for side in seen(scene).sides:
        assert side.depth + side.turn < 1.05 * np.ptp(ranges)
    top = np.isclose(normals[:, 2], 1.0)
    assert max(side.depth + side.turn for side in seen(scene).sides if side.echo > 1e-9) == pytest.approx(
        np.ptp(ranges[top]), rel=0.05
    )


def test_nothing_is_asked_for_what_lies_below_the_bed_or_too_near_to_count():
    sunk = at(FREE["sphere"] | {"gap": -1.3}, up=None)
    assert seen(sunk) is None
    assert PredictedErrors(sunk, summarise_scene(sunk)).demand.error == 0.0
    near = seen(at(FREE["sphere"], away=3.0))
    assert near.sides == ()
    assert near.shadow == 0.0


def test_a_target_is_judged_by_the_pings_that_go_out_at_it():
    view, ball = summarise_scene(BARE), FREE["sphere"]
    balls = [ball | {"position": [x, 25.0]} for x in (5.0, 60.0, 5.5)]
    demands = [
        predict_target_demand(
            edit(BARE, {"targets": [balls[k] for k in chosen]}), view, tuple(range(len(chosen))), 1.0
        ).error
        for chosen in ((0,), (0, 1), (0, 2))
    ]
    assert demands[1] == pytest.approx(demands[0])
    # Two in a ping are missed each by itself; they fill as much more of the record.
    assert demands[0] < demands[2] < math.sqrt(2.0) * demands[0]


@pytest.mark.parametrize("name", ["lying", "athwart", "ball", "small", "box", "cone", "wreck", "light"])
def test_planes_miss_of_a_target_what_is_foretold(name):
    target = {
        "lying": {"kind": "pipe", "radius": 0.3, "length": 6.0, "heading": 30.0},
        "athwart": {"kind": "pipe", "radius": 0.3, "length": 6.0, "heading": 80.0},
        "ball": {"kind": "sphere", "radius": 0.7, "material": "medium_sand"},
        "small": {"kind": "sphere", "radius": 0.15, "material": "medium_sand"},
        "box": {"kind": "box", "size": [1.0, 1.6, 0.8], "heading": 40.0},
        "cone": {"kind": "cone", "radius": 0.6, "height": 1.2, "material": "concrete"},
        "wreck": {"kind": "mesh", "path": "wreck", "scale": 0.1, "heading": 20.0},
        "light": {"kind": "sphere", "radius": 0.7},
    }[name]
    scene = at(target, up=None, **{"sonar.law": "light" if name == "light" else "sonar"})
    found, simulation = seen(scene), prepare(scene)
    reach = 0.25 * (found.length + found.width)
    pings = np.unique(np.linspace(max(500.0 - 100.0 * reach, 0.0), 500.0 + 100.0 * reach, 12).astype(np.int64))
    poses, demand = simulation.poses(pings), PredictedErrors(scene, summarise_scene(scene)).demand.error
    fine = sweep.trace(simulation.arrays, poses, planes=256)
    off = []
    for planes in (4, 8, 16):
        made = compare_records(
            simulation.arrays, poses, sweep.trace(simulation.arrays, poses, planes=planes), fine
        ).beyond
        off.append(math.log(demand / planes**fitted_laws.TARGET_ORDER / made))
    assert abs(np.mean(off)) < math.log(3.0), off


def test_planes_meet_a_target_however_faint_it_is():
    speck = at({"kind": "sphere", "radius": 0.02, "material": "silt"}, up=None)
    chosen, found = prepare(speck).plan, seen(speck)
    error = PredictedErrors(speck, summarise_scene(speck)).demand.error / 4**fitted_laws.TARGET_ORDER
    assert fitted_laws.MARGIN_OF_TARGETS * error < 0.03  # four planes would do for the record
    assert found.width / chosen.planes < 0.5 * found.length


def test_a_mesh_is_measured_once(monkeypatch):
    scene = at(FREE["mesh"])
    assert seen(scene) is not None
    monkeypatch.setattr(mesh, "read_mesh", lambda path: pytest.fail("read once more"))
    assert seen(scene) is not None


def test_a_mesh_that_is_not_there_is_told_by_its_target():
    missing = {"kind": "mesh", "path": "nowhere.obj"}
    with pytest.raises(SceneError, match=r"^targets\.0\.path: .*nowhere"):
        seen(at(missing))
