"""Simulations and files in several threads at once, after a fork and in spawned processes: the same bits everywhere."""

import multiprocessing
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest

from insonify.io.bathymetry import read_grid
from insonify.io.records import read_record, write_record
from insonify.scene import SceneError, edit, load_scene
from insonify.simulation import simulate, simulate_blocks

SCENES = ("pipe-span", "ripples", "targets")
SHORT = {"track.pings": 40, "sonar.bins": 300}


def echoes(name: str) -> np.ndarray:
    return simulate(edit(load_scene(name), SHORT)).intensity.values


@pytest.fixture(scope="module")
def expected() -> dict[str, np.ndarray]:
    return {name: echoes(name) for name in SCENES}


def test_four_threads_simulate_at_once(expected):
    with ThreadPoolExecutor(4) as pool:
        for name, found in zip(SCENES * 2, pool.map(echoes, SCENES * 2)):
            np.testing.assert_array_equal(found, expected[name])


@pytest.mark.parametrize("suffix", [".nc", ".npz", ".xtf"])
def test_four_threads_write_and_read_at_once(tmp_path, suffix):
    def exchange(number: int) -> np.ndarray:
        record = simulate(edit(load_scene("pipe-span"), SHORT | {"seed": number}))
        for _ in range(3):
            write_record(tmp_path / f"{number}{suffix}", [record])
            read = read_record(tmp_path / f"{number}{suffix}")
        return np.abs(read.intensity.values - record.intensity.values).max() / record.intensity.values.max()

    with ThreadPoolExecutor(4) as pool:
        differences = list(pool.map(exchange, range(4)))
    assert max(differences) < (1e-4 if suffix == ".xtf" else 1e-12)  # XTF holds 16 bits
    assert len(list(tmp_path.iterdir())) == 4


def test_four_threads_are_refused_at_once(tmp_path):
    def refused(number: int) -> str:
        (tmp_path / f"{number}.tif").write_text("not a raster")
        with pytest.raises(SceneError) as caught:
            read_grid(str(tmp_path / f"{number}.tif"))
        return str(caught.value)

    with ThreadPoolExecutor(4) as pool:
        for number, told in enumerate(pool.map(refused, range(4))):
            assert f"{number}.tif' cannot be read" in told


def compute(name: str, path: str) -> None:
    np.save(path, echoes(name))


@pytest.mark.filterwarnings("ignore:.*multi-threaded.*:DeprecationWarning")
@pytest.mark.parametrize("method", ["fork", "spawn"])
def test_another_process_computes_the_same(tmp_path: Path, expected, method):
    arguments = ("pipe-span", str(tmp_path / "found.npy"))
    child = multiprocessing.get_context(method).Process(target=compute, args=arguments)
    child.start()
    child.join(300)
    assert child.exitcode == 0
    np.testing.assert_array_equal(np.load(tmp_path / "found.npy"), expected["pipe-span"])


@pytest.mark.parametrize("stop", [1, 3])
def test_a_stream_may_be_left_and_begun_again(expected, stop):
    scene = edit(load_scene("pipe-span"), SHORT)
    left = simulate_blocks(scene, block=7)
    begun = [next(left) for _ in range(stop)]
    left.close()
    again = list(simulate_blocks(scene, block=9))
    for blocks in (begun, again):
        found = np.concatenate([block.intensity.values for block in blocks], axis=1)
        np.testing.assert_array_equal(found, expected["pipe-span"][:, : found.shape[1]])
