"""Blocks of a record in plain arrays: as a Dataset has them, and as Datasets are written."""

import numpy as np
import pytest
import xarray as xr

from insonify.io.record_block import as_block, as_dataset, make_record_block
from insonify.io.records import write_record
from insonify.scene import edit, load_scene
from insonify.simulation import simulate, simulate_blocks, simulate_record_blocks

SMALL = {"track.pings": 6, "sonar.bins": 80}


def scene(name="targets"):
    return edit(load_scene(name), SMALL)


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
    np.testing.assert_array_equal(
        block.variables["level"].along("ping_time", "channel"), np.arange(6.0).reshape(2, 3).T
    )


@pytest.mark.parametrize("suffix", [".nc", ".npz", ".xtf", ".zarr"])
def test_files_do_not_depend_on_what_blocks_they_are_written_from(tmp_path, suffix):
    truth = suffix != ".xtf"
    given = [simulated(scene(), truth=truth, block=4) for simulated in (simulate_record_blocks, simulate_blocks)]
    if suffix != ".nc":  # whose chunks are those of the first block
        whole = simulate(scene(), truth=truth)
        given += [[whole], [whole.isel(ping_time=[k]) for k in range(6)]]
    written = []
    for number, blocks in enumerate(given):
        path = tmp_path / f"{number}{suffix}"
        write_record(path, blocks)
        written.append([file.read_bytes() for file in sorted([path, *path.rglob("*")]) if file.is_file()])
    assert written[0]
    assert all(files == written[0] for files in written)
