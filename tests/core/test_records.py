"""Records on disk and in blocks: what is read back is what was simulated, and no file is ever half there."""

import warnings
from unittest.mock import Mock

import netCDF4
import numpy as np
import pytest
import pyxtf
import xarray as xr
import zarr

from commands import refused
from insonify.cli import main
from insonify.io.atomic import replacing
from insonify.io.record_block import as_block, as_dataset, make_record_block
from insonify.io.records import read_record, write_record
from insonify.io.records.zarr_store import CHUNK, SHARD
from insonify.record import labels
from insonify.record.labels import Label
from insonify.scene import SceneError, edit, load_scene
from insonify.simulation import simulate, simulate_blocks, simulate_record_blocks
from level_records import level_record
from small_sets import contents
from xtf_files import made_record, packets, random_counts


def block(first: int, pings: int, bins: int = 16) -> xr.Dataset:
    """Pings of a record, each as loud as its number."""
    numbers = np.arange(first, first + pings)
    echo = np.broadcast_to(numbers[:, None] + np.arange(bins) / 100, (2, pings, bins))
    record = level_record(echo, 0.05, 2.0, 0.2, scene='title = "ä"\n', version="0.1.0", number=3)
    time = np.datetime64("2000-01-01", "ns") + (numbers * 10**8).astype("timedelta64[ns]")
    record = record.assign_coords(channel=["port", "starboard"], ping_time=time, range_sample=np.arange(bins))
    return record.assign(caustic=record.intensity < 0.0)


@pytest.mark.parametrize("pings", [(5, 5, 2), (700, 700, 3), (1, 1)])
def test_compression_loses_nothing_and_takes_less(tmp_path, pings):
    starts = np.cumsum([0, *pings])
    parts = [block(int(first), count, bins=500) for first, count in zip(starts, pings)]
    for name in ("none", "zlib"):
        write_record(tmp_path / f"{name}.nc", parts, compression=name)
    plain, packed = (xr.load_dataset(tmp_path / f"{name}.nc") for name in ("none", "zlib"))
    xr.testing.assert_identical(plain, packed)
    np.testing.assert_array_equal(packed.intensity, xr.concat(parts, "ping_time").intensity)
    assert (tmp_path / "zlib.nc").stat().st_size < (tmp_path / "none.nc").stat().st_size


def test_chunks_hold_whole_pings_of_one_channel_and_only_pings_are_without_limit(tmp_path):
    write_record(tmp_path / "record.nc", [block(0, 1500, bins=500), block(1500, 40, bins=500)])
    with netCDF4.Dataset(tmp_path / "record.nc") as file:
        assert file["intensity"].chunking() == [1, 500, 500]  # a megabyte
        assert file["platform_x"].chunking() == [1500]
        assert [d.name for d in file.dimensions.values() if d.isunlimited()] == ["ping_time"]


@pytest.mark.parametrize("placed", [True, False], ids=["on a map", "in metres"])
def test_groups_of_sonar_netcdf_hold_the_record(tmp_path, capsys, placed):
    """What netCDF4 and xarray find in them; the geometry follows the formulas of the convention."""
    place = {"origin_x": 560_000.0, "origin_y": 6_500_000.0} | ({"crs": "EPSG:32631"} if placed else {})
    scene = '[sonar.pulse]\nkind = "chirp"\nduration = 1e-3\nbandwidth = 2e4\n'
    told = {"scene": scene, "version": "0.1.0", "beam_width": 1.5, "vertical_beam_tilt": 30.0, **place}
    record = made_record(random_counts(11), time_coverage_start="2024-02-29T12:00:00", **told)
    path = tmp_path / "a.nc"
    parts = record.isel(ping_time=slice(4)), record.isel(ping_time=slice(4, None))
    write_record(path, parts, convention="sonar-netcdf4")
    with netCDF4.Dataset(path) as file:
        assert set(file.groups) == {"Environment", "Platform", "Provenance", "Sonar", "Vendor_specific"}
        assert (file.sonar_convention_name, file.sonar_convention_version) == ("SONAR-netCDF4", "2.0")
        samples = file["Sonar/Beam_group1/backscatter_r"]
        assert samples.datatype.name == "sample_t"
        assert file["Sonar/Beam_group1/transmit_type"].datatype.enum_dict == {"CW": 0, "LFM": 1, "HFM": 2}
        got = np.array([[samples[ping, beam] for ping in range(7)] for beam in (0, 1)])
        np.testing.assert_allclose(got, record.intensity, rtol=2e-7)
        assert file["Vendor_specific"].scene == scene
        np.testing.assert_allclose(file["Vendor_specific/platform_altitude"][:], record.platform_altitude)
    group = {name: xr.load_dataset(path, group=name) for name in (
        "Sonar/Beam_group1", "Platform/Position/sonar", "Platform/Attitude/sonar", "Environment",
    )}  # fmt: skip
    beams, position, attitude, water = group.values()
    assert list(beams.beam) == ["port", "starboard"]
    assert (beams.sample_count == 40).all()
    start = np.datetime64("2024-02-29T12:00:00")
    for times in (beams.ping_time, position.time, attitude.time):
        np.testing.assert_array_equal((times - start) / np.timedelta64(1, "ms"), 250.0 * np.arange(7))
    first = beams.isel(ping_time=0, beam=0, tx_beam=0)
    delays = float(first.blanking_interval - first.sample_time_offset) + np.arange(40) * float(first.sample_interval)
    ranges = float(water.sound_speed_indicative) * delays / 2.0
    np.testing.assert_allclose(ranges, record.slant_range, rtol=1e-6)
    np.testing.assert_array_equal(beams.rx_beam_rotation_phi, [[60.0, -60.0]] * 7)
    assert (beams.transmit_type == 1).all()
    np.testing.assert_array_equal(beams.transmit_frequency_stop - beams.transmit_frequency_start, 2e4)
    for name in ("pitch", "roll"):
        np.testing.assert_allclose(attitude[name], record[f"platform_{name}"], rtol=1e-6)
    np.testing.assert_allclose(beams.tx_transducer_depth, record.platform_depth, rtol=1e-6)
    np.testing.assert_allclose(attitude.vertical_offset, -record.platform_depth, rtol=1e-6)
    write_record(tmp_path / "a.xtf", [record])
    xtf = packets(tmp_path / "a.xtf")[1]
    fixes = [(ping.SensorXcoordinate, ping.SensorYcoordinate) if placed else (np.nan, np.nan) for ping in xtf]
    np.testing.assert_array_equal(np.transpose([position.longitude, position.latitude]), fixes)
    np.testing.assert_allclose(position.heading, [ping.SensorHeading for ping in xtf], rtol=1e-6)
    error = refused(capsys, "render", str(path), "-o", str(tmp_path / "a.png"))
    assert "a.nc: is in SONAR-netCDF4, which is only written; give the record from which it was made" in error


def test_a_tow_is_written_without_being_held(tmp_path):
    """Blocks are asked for one at a time, each after the last was written."""
    alive: list[int] = []

    def blocks():
        for first in range(0, 40, 4):
            alive.append(first)
            assert len(alive) == first // 4 + 1
            yield block(first, 4)

    write_record(tmp_path / "record.nc", blocks())
    with xr.open_dataset(tmp_path / "record.nc") as read:
        assert read.sizes["ping_time"] == 40


def test_npz_reads_back_without_pickles(tmp_path):
    record = block(0, 4).assign_attrs(comment="", table={"a": [1, None]}, pair=[1.5, 2.5])
    write_record(tmp_path / "record.npz", [record])
    with np.load(tmp_path / "record.npz", allow_pickle=False) as read:
        np.testing.assert_array_equal(read["intensity"], record.intensity)
        np.testing.assert_array_equal(read["slant_range"], record.slant_range)
        assert list(read["channel"]) == ["port", "starboard"]
        assert str(read["attrs.scene"]) == record.attrs["scene"]
        assert str(read["attrs.comment"]) == ""
        assert str(read["attrs.table"]) == "{'a': [1, None]}"
        assert list(read["attrs.pair"]) == [1.5, 2.5]


def test_a_link_keeps_pointing_where_it_did(tmp_path):
    target, link = tmp_path / "target.txt", tmp_path / "link.txt"
    target.write_text("old")
    link.symlink_to(target)
    with replacing(link) as beside:
        beside.write_text("new")
    assert link.is_symlink()
    assert target.read_text() == "new"


def test_a_full_disk_is_called_by_its_name(tmp_path, monkeypatch):
    """The netCDF library reports it as a RuntimeError, often only when the file is closed."""
    full = Mock(side_effect=RuntimeError("NetCDF: HDF error"))
    monkeypatch.setattr("insonify.io.records.netcdf.append_to", full)
    with pytest.raises(OSError, match=r"could not be written \(NetCDF: HDF error\)") as caught:
        write_record(tmp_path / "record.nc", [block(0, 4)])
    assert caught.value.filename == str(tmp_path / "record.nc")
    assert list(tmp_path.iterdir()) == []


def test_a_record_is_read_as_it_was_written(tmp_path):
    untold = block(0, 4).assign(platform_altitude=("ping_time", np.full(4, np.nan)))
    for record in (block(0, 4), untold, untold.isel(ping_time=[0], range_sample=[0])):
        write_record(tmp_path / "record.nc", [record])
        np.testing.assert_array_equal(read_record(tmp_path / "record.nc").intensity, record.intensity)


@pytest.mark.parametrize(
    ("spoil", "words"),
    [
        (lambda r: r.drop_vars("platform_x"), r"it lacks platform_x"),
        (lambda r: r.isel(channel=[0]), r"it has 1 channels, 4 pings and 16 bins"),
        (lambda r: r.isel(ping_time=[]), r"it has 2 channels, 0 pings and 16 bins"),
        (lambda r: r.isel(range_sample=[]), r"it has 2 channels, 4 pings and 0 bins"),
        (lambda r: r.assign(intensity=r.intensity * np.nan), r"intensity holds values that are not finite"),
        (lambda r: r.assign(intensity=r.intensity - 1.0), r"intensity is negative"),
        (lambda r: r.assign(intensity=r.intensity.astype(str)), "intensity is not an array of numbers over channel"),
        (lambda r: r.assign(intensity=r.intensity.transpose("ping_time", ...)), "intensity is not an array of numbers"),
        (lambda r: r.assign(platform_y=r.platform_y * np.nan), r"platform_y holds values that are not finite"),
        (lambda r: r.assign(slant_range=r.slant_range * 0.0), r"slant_range does not increase"),
    ],
)
def test_what_is_no_record_is_told_in_one_sentence(tmp_path, spoil, words):
    spoil(block(0, 4)).drop_encoding().to_netcdf(tmp_path / "record.nc")
    with pytest.raises(SceneError, match=rf"record\.nc: is not a record \({words}[^\n]*\); give one made by insonify$"):
        read_record(tmp_path / "record.nc")


def scene(name="targets", **changes):
    return edit(load_scene(name), {"track.pings": 6, "sonar.bins": 80} | changes)


def test_a_label_that_follows_from_others_is_in_records_that_have_those(monkeypatch):
    monkeypatch.setattr(labels, "LABELS", dict(labels.LABELS))
    Label("grazing", "grazing angle", "degree", lambda block: 90.0 - block.columns["incidence"], ("incidence",))
    record = simulate(scene(), truth=True)
    np.testing.assert_array_equal(record.grazing, 90.0 - record.incidence)
    assert record.grazing.attrs == {"units": "degree", "long_name": "grazing angle"}
    assert "grazing" not in simulate(scene(), truth="targets")


@pytest.mark.parametrize("truth", [False, True])
def test_a_block_is_the_dataset(truth):
    ours = list(simulate_record_blocks(scene(), truth=truth, block=4))
    datasets = list(simulate_blocks(scene(), truth=truth, block=4))
    assert [block.sizes["ping_time"] for block in ours] == [4, 2]
    for block, dataset in zip(ours, datasets):
        xr.testing.assert_identical(block.to_dataset(), dataset)
        assert list(block.variables) == list(dataset.variables)
        assert block.sizes == dict(dataset.sizes)
        again = as_block(dataset)
        assert set(again.coordinates) == set(block.coordinates)
        xr.testing.assert_identical(as_dataset(again), dataset)
        assert as_block(block) is block
        assert as_dataset(dataset) is dataset


def test_variables_are_given_as_a_dataset_takes_them():
    across = ("channel", "ping_time")
    data = {"level": (across, np.arange(6.0).reshape(2, 3), {"units": "dB"}), "target": ["a", "b", "c", "d"]}
    coordinates = {"channel": ["port", "starboard"], "ping_time": ("ping_time", np.arange(3.0), {"units": "s"})}
    block = make_record_block(data, coordinates, {"title": "made up"})
    xr.testing.assert_identical(block.to_dataset(), xr.Dataset(data, coordinates, {"title": "made up"}))
    assert set(block.coordinates) == {"target", "channel", "ping_time"}
    level = block.variables["level"].along("ping_time", "channel")
    np.testing.assert_array_equal(level, np.arange(6.0).reshape(2, 3).T)


@pytest.mark.parametrize("suffix", [".nc", ".npz", ".xtf", ".jsf", ".zarr"])
def test_files_do_not_depend_on_what_blocks_they_are_written_from(tmp_path, suffix):
    truth = suffix not in (".xtf", ".jsf")
    given = [simulated(scene(), truth=truth, block=4) for simulated in (simulate_record_blocks, simulate_blocks)]
    if suffix != ".nc":  # whose chunks are those of the first block
        whole = simulate(scene(), truth=truth)
        given += [[whole], [whole.isel(ping_time=[k]) for k in range(6)]]
    written = []
    for number, blocks in enumerate(given):
        path = tmp_path / f"{number}{suffix}"
        write_record(path, blocks)
        written.append(contents(path))
    assert written[0]
    assert all(files == written[0] for files in written)


@pytest.mark.parametrize("suffix", [".zarr", ".nc", ".npz"])
def test_xarray_shows_units_and_values(tmp_path, suffix):
    placed = scene("default", **{"world.crs": "EPSG:32631", "world.origin": [5e5, 4e6], "title": "ä"})
    path = tmp_path / f"a{suffix}"
    write_record(path, simulate_blocks(placed, truth=True, bin_error=True, block=2))
    expected, read = simulate(placed, truth=True, bin_error=True), read_record(path)
    assert {"error", "bin_error"} <= set(expected)
    assert 0.0 < expected.attrs["record_error"] < 0.03
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
    assert found.slant_range.attrs == expected.slant_range.attrs
    assert dict(found.dtypes) == dict(expected.dtypes)
    named = {"channel", "target", "bound", "target_id", "material", "path", "shadow_id", "caustic"}
    for name in set(found.variables) - named:
        assert found[name].attrs["units"], name
        assert found[name].attrs["long_name"], name
    assert found.target_id.flag_meanings == "nothing bed pipe_0 sphere_1 sphere_2"
    assert found.material.flag_meanings == "nothing medium_sand steel steel steel"
    assert found.shadow_id.flag_meanings == "nothing pipe_0 sphere_1 sphere_2"
    np.testing.assert_array_equal(found.target_id.flag_values, [-2, -1, 0, 1, 2])
    np.testing.assert_array_equal(found.shadow_id.flag_values, [-2, 0, 1, 2])
    assert found.platform_longitude.attrs["standard_name"] == "longitude"
    np.testing.assert_allclose(found.platform_longitude[0], 3.0, atol=1e-5)


def test_the_note_of_a_recording_has_the_error_of_the_record(tmp_path):
    record = simulate(scene(title="x" * 80))
    write_record(tmp_path / "a.xtf", [record.isel(ping_time=[k]) for k in range(6)])
    header, _ = pyxtf.xtf_read(str(tmp_path / "a.xtf"))
    note = header.NoteString.decode()
    assert note == f"{note.partition(' (')[0]} (place made up), error {100.0 * record.attrs['record_error']:.2g} %"
    assert len(note) == 63


def test_blocks_of_pings_share_a_file_whatever_blocks_they_are_written_from(tmp_path):
    record = simulate(scene("default")).isel(ping_time=np.arange(2 * SHARD + 300) % 6)
    record = record.assign_coords(ping_time=("ping_time", 0.1 * np.arange(2 * SHARD + 300), record.ping_time.attrs))
    write_record(tmp_path / "a.zarr", [record])
    store = zarr.open_group(tmp_path / "a.zarr", mode="r")
    assert store.metadata.zarr_format == 3
    assert store["intensity"].shards == (2, SHARD, 80)
    assert store["intensity"].chunks == (1, CHUNK, 80)
    files = sorted(file for file in (tmp_path / "a.zarr" / "intensity").rglob("*") if file.is_file())
    assert len(files) == 3 + 1  # shards and the array's own description
    np.testing.assert_array_equal(store["intensity"][:], record.intensity)
    for size in (100, 700, 3000):
        parts = (record.isel(ping_time=slice(first, first + size)) for first in range(0, 2 * SHARD + 300, size))
        write_record(tmp_path / "b.zarr", parts)
        assert contents(tmp_path / "a.zarr") == contents(tmp_path / "b.zarr"), size


def test_a_store_is_written_and_read_by_the_command_and_a_folder_of_the_user_is_not_replaced(tmp_path, capsys):
    path = tmp_path / "a.zarr"
    words = ["pipe-span", "--set", "track.pings=5", "--set", "sonar.bins=100", "-o", str(path)]
    for _ in range(2):  # the second time it replaces the first
        assert main(["render", *words]) == 0
    for name in ("a.png", "a.xtf"):
        assert main(["render", str(path), "-o", str(tmp_path / name)]) == 0
    assert sorted(file.name for file in tmp_path.iterdir()) == ["a.png", "a.xtf", "a.zarr"]
    assert capsys.readouterr().err == ""
    mine = tmp_path / "mine.zarr"
    mine.mkdir()
    (mine / "thesis.txt").write_text("words")
    error = refused(capsys, "render", "pipe-span", "-o", str(mine))
    assert "mine.zarr: is a folder; give the name of a file in it" in error
    assert (mine / "thesis.txt").read_text() == "words"


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


@pytest.mark.parametrize("name", ["a.nc", "a.npz"])
def test_what_is_no_file_of_a_record_is_one_sentence(tmp_path, name):
    names = name, "none.zarr", "text.zarr", "empty.zarr", "broken.zarr"
    path, none, text, folder, broken = (tmp_path / each for each in names)
    text.write_text("no store")
    for missing in (path, none, text):
        with pytest.raises(SceneError, match=rf"{missing.name}: does not exist; give the path of a record[^\n]*$"):
            read_record(missing)
    path.write_bytes(b"no record")
    folder.mkdir()
    broken.mkdir()
    (broken / "zarr.json").write_text('{"zarr_format": 3, "node_type"')
    for unreadable in (path, folder, broken):
        with pytest.raises(SceneError, match=rf"{unreadable.name}: cannot be read[^\n]*$"):
            read_record(unreadable)
    np.savez(tmp_path / "b.npz", intensity=np.zeros((2, 3, 4)))
    with pytest.raises(SceneError, match=r"is not a record \(it lacks slant_range"):
        read_record(tmp_path / "b.npz")
