"""From call to Dataset, file and picture, beside the tracer's own time: run with `pytest -m bench -s tests/bench`.

A knife over a bare bed of 1024², 2 × 1000 bins and an ideal pulse: the less a ping costs to trace, the more the rest
counts. All calls take turns in one process. The floor only reads a ping's heights and writes its bins.
"""

import os

import numpy as np
import pytest

from floor import floor_call
from insonify.accuracy.timing import time_calls
from insonify.commands.render import write
from insonify.display.display_options import DisplayOptions
from insonify.display.normalisation import LevelBed
from insonify.io.records import write_record
from insonify.parallel import count_threads
from insonify.scene import edit, load_scene
from insonify.simulation import prepare, simulate, simulate_blocks
from insonify_viewer.work.simulator import BLOCK_TIME

pytestmark = pytest.mark.bench
DEFAULT = load_scene("default")
BARE = edit(DEFAULT, {"sonar.beam": "knife", "targets": [], "sonar.pulse": "ideal"})
THREADS = [1, count_threads()]


def tracer(simulation, pings, threads):
    """Call of the tracer alone, poses and planes known."""
    arrays, poses = simulation.reduced, simulation.poses(np.arange(pings))
    return lambda: simulation.tracer.trace(arrays, poses, threads=threads, **simulation.plan.settings)


def viewer(simulation, pings):
    """Call of what the viewer's worker does with pings, as many at a time as it sends to the window."""
    level, size = LevelBed(simulation), simulation.pings_within(BLOCK_TIME)
    blocks = [np.arange(first, min(first + size, pings)) for first in range(0, pings, size)]
    return lambda: [None for block in blocks if level.amplitudes(block) is None]


def fresh(path, write, *given, **named):
    """Write a file that is not there yet: to replace one, file systems first put the new one on the disk."""
    path.unlink(missing_ok=True)
    write(*given, **named)


def tell(say, title, timings, pings, own):
    say(f"{title}:")
    for name, timing in timings.items():
        over = 1e3 * (timing.median - 1.5 * timings[own].median)
        say(
            f"  {name:32s} {1e6 * timing.median / pings:8.2f} µs a ping ± {100 * timing.spread:3.0f} %, "
            f"{timing.median / timings[own].median:6.2f} × the tracer, 1.5 × {over:+.1f} ms",
        )


@pytest.mark.parametrize("pings", [512, 20_000])
@pytest.mark.parametrize("threads", THREADS)
def test_from_call_to_dataset_and_file(say, tmp_path, pings, threads):
    scene = edit(BARE, {"track.pings": pings})
    simulation = prepare(scene, threads=threads)
    calls = {
        "floor": floor_call(simulation, pings),
        "tracer": tracer(simulation, pings, threads),
        "intensity": lambda: simulation.intensity(np.arange(pings)),
        "viewer": viewer(simulation, pings),
        "prepare": lambda: prepare(scene, threads=threads),
        "simulate": lambda: simulate(scene, threads=threads),
        "simulate_blocks": lambda: [None for _ in simulate_blocks(scene, threads=threads)],
    }
    for name in ("record.nc", "record.npz", "record.png"):
        calls[name] = lambda path=tmp_path / name: fresh(path, write, scene, path, DisplayOptions(), threads=threads)
    timings = time_calls(calls, rounds=9 if pings < 5000 else 7)
    tell(say, f"{pings} pings, {threads} threads", timings, pings, "tracer")


def test_writing_beside_the_disk(say, tmp_path):
    """Ready blocks of a record written, beside as many bytes that have reached the disk."""
    scene = edit(BARE, {"track.pings": 20_000})
    blocks = list(simulate_blocks(scene))
    data = np.zeros((20_000, 2, scene.sonar.bins), np.float32)

    def plain():
        with open(tmp_path / "plain", "wb") as file:
            data.tofile(file)
            os.fsync(file.fileno())

    calls = {"plain": lambda: fresh(tmp_path / "plain", plain)}
    for name in ("record.nc", "record.npz"):
        calls[name] = lambda path=tmp_path / name: fresh(path, write_record, path, blocks)
    timings = time_calls(calls, rounds=7)
    disk = timings["plain"].median
    for name in ("record.nc", "record.npz"):
        size, took = os.path.getsize(tmp_path / name), timings[name].median
        say(
            f"{name} of ready blocks: {size / took / 1e6:,.0f} MB/s, {100 * disk / took:.0f} % of the "
            f"{data.nbytes / disk / 1e6:,.0f} that the disk takes",
        )
