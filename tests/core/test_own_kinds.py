"""A shape, a map and a material of somebody else's go the whole way: scene, plan, tracers, picture and command."""

import math
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
import xarray as xr

import insonify
from insonify.cli import main
from insonify.planning.relevance import outline_of
from insonify.scene import SceneError, edit, scene_from_toml, scene_to_toml
from insonify.scene.seabed.materials import catalogue
from insonify.scene.seabed.materials.catalogue import MATERIALS, Catalogue, read_materials
from insonify.simulation import prepare
from insonify.statistics.record_errors import compare_records
from insonify.terrain import build_ground
from insonify.tracers import rays, sweep
from own_kinds import OWN_MATERIALS, own_kinds, own_scene

CORAL = (OWN_MATERIALS / "coral.toml").read_text()
SEDIMENT = "sediment = { loss = 0.02, volume = 0.002, spectral_strength = 0.004, spectral_exponent = 3.2 }"


@pytest.fixture(autouse=True, scope="module")
def _known():
    with own_kinds():
        yield


def test_a_hoop_is_placed_and_measured():
    scene = own_scene()
    mesh = prepare(scene).arrays.mesh
    low, high = mesh.corners.min(axis=(0, 1)), mesh.corners.max(axis=(0, 1))
    np.testing.assert_allclose([low, high], [[2.5, 15.5, 0.0], [7.5, 20.5, 1.0]], atol=1e-9)
    outline = outline_of(scene, 0)
    assert outline.triangles == len(mesh.corners)
    assert outline.extent((1.0, 0.0, 0.0)) == pytest.approx(2.5)
    assert outline.radius == pytest.approx(math.hypot(2.5, 2.5, 0.5))


def test_a_dumbbell_is_placed_and_measured():
    scene = own_scene("dumbbell")
    solids = prepare(scene).arrays.solids
    np.testing.assert_allclose(solids.start[:, :2] - [5.0, 18.0], [[-1.5, 0.0], [-1.5, 0.0], [1.5, 0.0]])
    np.testing.assert_allclose(solids.start[:, 2], 0.6)
    outline = outline_of(scene, 0)
    assert outline.radius == pytest.approx(2.1)
    assert [outline.extent(axis) for axis in np.eye(3)] == pytest.approx([2.1, 0.6, 0.6])


@pytest.mark.parametrize("kind", ["hoop", "dumbbell"])
def test_sweep_and_rays_hear_the_same(kind):
    simulation = prepare(own_scene(kind))
    poses = simulation.poses(np.array([20, 25, 32]))
    swept = sweep.trace(simulation.arrays, poses, planes=64)
    traced = rays.trace(simulation.arrays, poses, rays=60000)
    assert compare_records(simulation.arrays, poses, swept, traced).beyond < 0.05
    bare = prepare(edit(own_scene(kind), {"targets": []}))
    without = sweep.trace(bare.arrays, poses, planes=64)
    assert compare_records(simulation.arrays, poses, without, swept).beyond > 0.3


def test_the_plan_and_the_truth_take_it_into_account():
    chosen = insonify.plan(own_scene())
    targets = next(entry for entry in chosen.entries if entry.subject == "targets")
    assert "with 6,144 triangles" in targets.reason
    truth = insonify.simulate(own_scene(), truth=True)
    assert "hoop_0" in truth.target_id.attrs["flag_meanings"]
    assert "coral" in truth.material.attrs["flag_meanings"]


def test_it_is_written_read_and_set_from_the_command_line(tmp_path):
    scene = own_scene()
    assert scene_from_toml(scene_to_toml(scene)) == scene
    file = tmp_path / "ring.toml"
    file.write_text(scene_to_toml(scene))
    words = ["render", str(file), "--set", "targets.0.tube=0.8", "--set", "track.pings=3"]
    for name in ("ring.nc", "ring.png"):
        assert main([*words, "-o", str(tmp_path / name)]) == 0
    with xr.open_dataset(tmp_path / "ring.nc") as record:
        assert scene_from_toml(record.attrs["scene"]).targets[0].tube == 0.8
    with pytest.raises(SceneError, match=r"targets\.0\.tube: -1 is out of bounds"):
        edit(scene, {"targets.0.tube": -1})


@pytest.mark.parametrize(
    "relief", [{"kind": "flat"}, {"period": 25.6}, {"extent": "endless", "clamp": "soft", "coefficients": "gaussian"}]
)
def test_a_map_is_laid_on_every_kind_of_bed(relief):
    material = {"kind": "halves", "of": ["silt", "coral"], "border": 3.0}
    scene = edit(own_scene(), {"seabed.relief": {"kind": "fractal"} | relief, "seabed.material": material})
    ground = build_ground(scene)
    assert ground.names == ("silt", "coral")
    near = ground.around((0.0, 6.0), 5.0)
    assert set(np.unique(near.materials)) == {0, 1}
    assert insonify.plan(scene).entries
    record = insonify.simulate(edit(scene, {"track.pings": 2}))
    assert np.isfinite(record.intensity).all()


def test_a_material_has_the_numbers_of_its_table_and_packages_announce_folders_of_them(monkeypatch):
    coral = MATERIALS["coral"]
    impedance = 2.1 * 1.9
    assert coral.reflectivity.reflection == pytest.approx((impedance - 1.0) / (impedance + 1.0))
    assert coral.reflectivity[:3] == coral.reflectivity_at(100e3)[:3] == (0.7, 0.2, 12.0)
    assert "coral" in list(MATERIALS)
    entry = SimpleNamespace(load=lambda: str(OWN_MATERIALS))
    monkeypatch.setattr(catalogue, "announced", lambda group: [entry] if group == "insonify.materials" else [])
    assert set(Catalogue()) == set(MATERIALS)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("[chalk]\ndiffuse = 2.0", ["chalk.toml: chalk.diffuse: 2.0", "less than or equal to 1"]),
        ("[chalk]\ncolor = 1", ["chalk.toml: chalk.diffuse"]),
        ("[chalk", ["chalk.toml", "not valid TOML"]),
        (CORAL.replace("0.2", "0.4"), ["chalk.toml: coral: ", "exceed 1, the energy that arrives"]),
        (f"{CORAL}\n{SEDIMENT}".replace("2.1", "inf"), ["chalk.toml: coral: ", "is not a sediment"]),
        (f"{CORAL}\n{SEDIMENT}".replace("0.02", "-1"), ["chalk.toml: coral.sediment.loss: -1"]),
    ],
)
def test_a_wrong_material_is_told_by_its_file_and_field(tmp_path: Path, text: str, words: list[str]):
    (tmp_path / "chalk.toml").write_text(text)
    with pytest.raises(SceneError) as caught:
        read_materials(tmp_path)
    assert all(word in str(caught.value) for word in words)
    assert "\n" not in str(caught.value)
