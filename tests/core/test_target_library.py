"""Library of targets: closed meshes in metres, named, listed, and made anew by their script."""

import runpy

import numpy as np
import pytest
import trimesh

import insonify
from insonify import cli
from insonify.files import bundled_meshes, bundled_targets, resources
from insonify.scene import edit

SCRIPT = resources() / "meshes" / "make_library.py"


@pytest.fixture(scope="module")
def script() -> dict[str, object]:
    return runpy.run_path(str(SCRIPT))


def test_the_library_names_every_mesh_that_the_script_makes(script):
    assert set(bundled_targets()) == set(script["LIBRARY"]) <= set(bundled_meshes())
    assert len(bundled_targets()) >= 12


@pytest.mark.parametrize("name", list(bundled_targets()))
def test_a_target_is_closed_and_as_its_script_makes_it(name, script):
    path = bundled_meshes()[name]
    mesh, made = trimesh.load_mesh(path, process=False), script["target"](name)
    np.testing.assert_allclose(mesh.triangles, made.triangles, atol=1e-5)
    assert made.is_watertight
    assert all(part.volume > 0.0 for part in made.split())
    assert path.stat().st_size < 100_000
    assert 0.1 < mesh.extents.max() < 5.0
    assert mesh.bounds[0, 2] == 0.0


def test_the_listing_gives_the_measures_of_a_drum(capsys):
    assert cli.main(["targets"]) == 0
    lines = dict(line.split(maxsplit=1) for line in capsys.readouterr().out.splitlines())
    assert list(lines) == list(bundled_targets())
    assert lines["drum"] == "0.89 x 0.60 x 0.60 m  steel drum of 200 l, lying"


def test_a_drum_by_its_name_is_seen_with_its_shadow():
    target = {"kind": "mesh", "path": "drum", "position": [5.0, 12.0]}
    changes = {"targets": [target], "track.pings": 50, "sonar.range": 25.0}
    record = insonify.simulate(edit(insonify.load_scene("default"), changes), truth=True)
    assert float(record["shadow_length"].sel(channel="port")[0]) > 0.5
