"""Zarr stores and netCDF files: what xarray shows, in shards that do not depend on the blocks."""

import warnings

import numpy as np
import pytest
import xarray as xr
import zarr

from commands import refused
from insonify.cli import main
from insonify.io.atomic import replacing
from insonify.io.records import read_record, write_record
from insonify.io.records.zarr_store import CHUNK, SHARD
from insonify.scene import SceneError, edit, load_scene
from insonify.simulation import simulate, simulate_blocks

SMALL = {"track.pings": 5, "sonar.bins": 100}


def small_scene(**changes):
    return edit(load_scene("default"), SMALL | changes)


def long_record(pings: int) -> xr.Dataset:
    record = simulate(small_scene())
    many = record.isel(ping_time=np.arange(pings) % 5)
    return many.assign_coords(ping_time=("ping_time", 0.1 * np.arange(pings), record.ping_time.attrs))


@pytest.mark.parametrize("suffix", [".zarr", ".nc", ".npz"])
def test_xarray_shows_units_and_values(tmp_path, suffix):
    scene = small_scene(**{"world.crs": "EPSG:32631", "world.origin": [5e5, 4e6]})
    path = tmp_path / f"a{suffix}"
    write_record(path, simulate_blocks(scene, truth=True, block=2))
    expected, read = simulate(scene, truth=True), read_record(path)
    xr.testing.assert_equal(read, expected)
    if suffix == ".npz":
        assert read.attrs == expected.attrs
        return
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        with xr.open_dataset(path) as found:
            found = found.load()
    xr.testing.assert_equal(found, expected)
    assert found.attrs == expected.attrs | {"Conventions": "CF-1.10"}
    assert {name: found[name].dtype for name in found.data_vars} == {
        name: expected[name].dtype for name in expected.data_vars
    }
    named = {"channel", "target", "bound", "target_id", "material", "path", "shadow_id", "caustic"}
    for name in set(found.variables) - named:
        assert found[name].attrs["units"], name
        assert found[name].attrs["long_name"], name
    assert found.target_id.flag_meanings == "nothing bed pipe_0 sphere_1 sphere_2"
    assert found.material.flag_meanings == "nothing medium_sand steel steel steel"
    np.testing.assert_array_equal(found.target_id.flag_values, [-2, -1, 0, 1, 2])
    np.testing.assert_array_equal(found.shadow_id.flag_values, [-2, 0, 1, 2])
    assert found.shadow_id.flag_meanings == "nothing pipe_0 sphere_1 sphere_2"
    assert found.platform_longitude.attrs["standard_name"] == "longitude"
    np.testing.assert_allclose(found.platform_longitude[0], 3.0, atol=1e-5)


def test_blocks_of_pings_share_a_file(tmp_path):
    record = long_record(2 * SHARD + 300)
    write_record(tmp_path / "a.zarr", [record])
    store = zarr.open_group(tmp_path / "a.zarr", mode="r")
    assert store.metadata.zarr_format == 3
    assert store["intensity"].shards == (2, SHARD, 100)
    assert store["intensity"].chunks == (1, CHUNK, 100)
    files = sorted(file for file in (tmp_path / "a.zarr" / "intensity").rglob("*") if file.is_file())
    assert len(files) == 3 + 1  # shards and the array's own description
    np.testing.assert_array_equal(store["intensity"][:], record.intensity)


def files_in(folder):
    return {file.relative_to(folder): file.read_bytes() for file in folder.rglob("*") if file.is_file()}


@pytest.mark.parametrize("size", [100, 700, 3000])
def test_the_store_does_not_depend_on_the_blocks(tmp_path, size):
    record = long_record(SHARD + 200)
    write_record(tmp_path / "a.zarr", [record])
    parts = [record.isel(ping_time=slice(first, first + size)) for first in range(0, SHARD + 200, size)]
    write_record(tmp_path / "b.zarr", iter(parts))
    assert files_in(tmp_path / "a.zarr") == files_in(tmp_path / "b.zarr")


def test_a_store_is_written_and_read_by_the_command(tmp_path, capsys):
    path = tmp_path / "a.zarr"
    words = ["pipe-span", "--set", "track.pings=5", "--set", "sonar.bins=100", "-o", str(path)]
    for _ in range(2):  # the second time it replaces the first
        assert main(["render", *words]) == 0
    for name in ("a.png", "a.xtf"):
        assert main(["render", str(path), "-o", str(tmp_path / name)]) == 0
    assert sorted(file.name for file in tmp_path.iterdir()) == ["a.png", "a.xtf", "a.zarr"]
    assert capsys.readouterr().err == ""


def test_a_folder_of_the_user_is_not_replaced(tmp_path, capsys):
    path = tmp_path / "mine.zarr"
    path.mkdir()
    (path / "thesis.txt").write_text("words")
    error = refused(capsys, "render", "pipe-span", "-o", str(path))
    assert "mine.zarr: is a folder; give the name of a file in it" in error
    assert (path / "thesis.txt").read_text() == "words"


def test_a_swap_that_fails_puts_the_old_folder_back(tmp_path, monkeypatch):
    final = tmp_path / "a.zarr"
    final.mkdir()
    (final / "old").touch()
    rename = type(final).replace

    def refuse(self, target):
        if self.name == "new.zarr":
            raise OSError(13, "Permission denied")
        return rename(self, target)

    monkeypatch.setattr(type(final), "replace", refuse)
    with pytest.raises(OSError, match="Permission denied"), replacing(final) as beside:
        beside.mkdir()
    assert [file.name for file in tmp_path.rglob("*")] == ["a.zarr", "old"]


@pytest.mark.parametrize("fault", ["missing", "empty", "text", "broken"])
def test_what_is_no_store_is_one_sentence(tmp_path, fault):
    path = tmp_path / "a.zarr"
    if fault == "text":
        path.write_text("no store")
    elif fault != "missing":
        path.mkdir()
    if fault == "broken":
        (path / "zarr.json").write_text('{"zarr_format": 3, "node_type"')
    with pytest.raises(SceneError, match=r"a\.zarr: (does not exist|cannot be read)") as caught:
        read_record(path)
    assert "\n" not in str(caught.value)
