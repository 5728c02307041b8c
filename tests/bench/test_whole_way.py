"""From command and call to Dataset, file and picture, printed: run with `pytest -m bench -s tests/bench`.

A knife over a bare bed of 1024², 2 × 1000 bins and an ideal pulse: the less a ping costs to trace, the more the rest
counts. All calls take turns in one process, beside the tracer's own time; the floor only reads a ping's heights and
writes its bins. Commands begin with kernels compiled before and with none.
"""

import os
from statistics import median
from time import monotonic

import numpy as np
import pytest

from commands import output_of, run_python
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


def viewer(simulation, pings):
    """Call of what the viewer's worker does with pings, as many at a time as it sends to the window."""
    level, size = LevelBed(simulation), simulation.pings_within(BLOCK_TIME)
    blocks = [np.arange(first, min(first + size, pings)) for first in range(0, pings, size)]
    return lambda: [None for block in blocks if level.amplitudes(block) is None]


def fresh(path, write, *given, **named):
    """Write a file that is not there yet: to replace one, file systems first put the new one on the disk."""
    path.unlink(missing_ok=True)
    write(*given, **named)


@pytest.mark.parametrize("pings", [512, 20_000])
@pytest.mark.parametrize("threads", THREADS)
def test_from_call_to_dataset_and_file(say, tmp_path, pings, threads):
    scene = edit(BARE, {"track.pings": pings})
    simulation = prepare(scene, threads=threads)
    traced = {"poses": simulation.poses(np.arange(pings)), "threads": threads, **simulation.plan.settings}
    calls = {
        "floor": floor_call(simulation, pings),
        "tracer": lambda: simulation.tracer.trace(simulation.reduced, **traced),
        "intensity": lambda: simulation.intensity(np.arange(pings)),
        "viewer": viewer(simulation, pings),
        "prepare": lambda: prepare(scene, threads=threads),
        "simulate": lambda: simulate(scene, threads=threads),
        "simulate_blocks": lambda: [None for _ in simulate_blocks(scene, threads=threads)],
    }
    for name in ("record.nc", "record.npz", "record.png"):
        calls[name] = lambda path=tmp_path / name: fresh(path, write, scene, path, DisplayOptions(), threads=threads)
    timings = time_calls(calls, rounds=9 if pings < 5000 else 7)
    own = timings["tracer"].median
    say(f"{pings} pings, {threads} threads:")
    for name, timing in timings.items():
        say(
            f"  {name:32s} {1e6 * timing.median / pings:8.2f} µs a ping ± {100 * timing.spread:3.0f} %, "
            f"{timing.median / own:6.2f} × the tracer, 1.5 × {1e3 * (timing.median - 1.5 * own):+.1f} ms",
        )


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


FIRST_PING = """
import time
from insonify.__main__ import load
load()  # all that the command loads before it knows what is wanted
import numpy as np
from insonify.scene import load_scene
from insonify.simulation import prepare
prepare(load_scene("default")).intensity(np.arange(1))
print(time.monotonic())
"""


def test_from_the_command_to_the_first_ping(say):
    pinged, ended = [], []
    for _ in range(8):
        start = monotonic()
        pinged.append(float(output_of("-c", FIRST_PING)[0]) - start)
        ended.append(monotonic() - start)
    # The first may still compile.
    say(
        f"from the command to the first ping: {median(pinged[1:]):.2f} s (best {min(pinged):.2f} s), "
        f"to its end: {median(ended[1:]):.2f} s (best {min(ended):.2f} s)"
    )


FIRST_RECORD = """
import os, sys, time
if hasattr(os, "sched_setaffinity"):
    os.sched_setaffinity(0, sorted(os.sched_getaffinity(0))[:2])
from numba.core import event
from insonify.__main__ import main
start = time.process_time()
with event.install_listener("numba:compile", event.RecordingListener()) as compiled:
    sys.argv = ["insonify", "render", "default", "-o", os.environ["PICTURE"]]
    main()
print(sum(entry.is_start for _, entry in compiled.buffer), time.process_time() - start)
"""


def test_first_record_from_an_empty_cache(tmp_path, say):
    environment = {name: value for name, value in os.environ.items() if name != "NUMBA_CACHE_DIR"}
    environment |= {"XDG_CACHE_HOME": str(tmp_path), "PICTURE": str(tmp_path / "first.png")}
    start = monotonic()
    *_, functions, seconds = run_python("-c", FIRST_RECORD, env=environment)[1].split()
    say(
        f"first record from an empty cache on two cores: {monotonic() - start:.1f} s, "
        f"{float(seconds):.1f} s of processor time, {functions} functions compiled"
    )
