"""What targets, planes and length cost the sweep, printed: run with `pytest -m bench -s tests/bench`.

Seconds of one thread's own time, so that what else the machine does hardly counts: the least and the median of several
rounds taken in turns.
"""

import time

import numpy as np
import pytest

from beds import icosphere
from insonify.scene import edit, load_scene
from insonify.simulation import Simulation, prepare
from insonify.tracers import sweep

pytestmark = pytest.mark.bench
DEFAULT = load_scene("default")
KNIFE = {"sonar.beam": "knife"}
BARE = {"targets": []}
PINGS = np.arange(512)
ROUNDS = 15


def microseconds(**calls: tuple[Simulation, np.ndarray, int]) -> dict[str, tuple[float, float]]:
    """Least and median cost of a ping of each, which is a simulation, its pings and the planes of its beam."""
    posed = {name: simulation.poses(pings) for name, (simulation, pings, _) in calls.items()}
    taken: dict[str, list[float]] = {name: [] for name in calls}
    for turn in range(ROUNDS + 1):
        for name, (simulation, pings, planes) in calls.items():
            began = time.thread_time()
            sweep.trace(simulation.arrays, posed[name], planes=planes, threads=1)
            if turn > 0:  # the first one compiles
                taken[name].append(1e6 * (time.thread_time() - began) / pings.size)
    return {name: (min(times), float(np.median(times))) for name, times in taken.items()}


def tell(say, what, costs):
    rows = "; ".join(f"{name} {least:.1f} ({median:.1f})" for name, (least, median) in costs.items())
    say(f"{what}, µs a ping, least (median): {rows}")


def test_targets(say):
    with_targets, bare = prepare(edit(DEFAULT, KNIFE)), prepare(edit(DEFAULT, KNIFE | BARE))
    costs = microseconds(targets=(with_targets, PINGS, 1), none=(bare, PINGS, 1))
    tell(say, f"knife, default scene, targets + {costs['targets'][0] - costs['none'][0]:.1f}", costs)


def test_pings_that_cross_no_target(say):
    scene = edit(DEFAULT, KNIFE | {"track.start": (-500.0, 0.0)})
    costs = microseconds(beside=(prepare(scene), PINGS, 1), none=(prepare(edit(scene, BARE)), PINGS, 1))
    tell(say, "knife, targets far away", costs)


def test_a_mesh_of_20_000_triangles(say, tmp_path):
    vertices, faces = icosphere(5)
    rows = [f"v {x} {y} {z}" for x, y, z in vertices] + [f"f {a} {b} {c}" for a, b, c in faces + 1]
    (tmp_path / "ball.obj").write_text("\n".join(rows))
    targets = {
        "none": [],
        "pipe": [{"kind": "pipe", "position": [20.0, 20.0], "length": 8.0, "radius": 1.0}],
        "ball": [{"kind": "sphere", "position": [20.0, 20.0], "radius": 1.0}],
        "mesh": [{"kind": "mesh", "position": [20.0, 20.0], "path": str(tmp_path / "ball.obj")}],
        "wreck": [{"kind": "mesh", "position": [20.0, 20.0], "path": "wreck", "scale": 0.1}],
    }
    made = {name: prepare(edit(DEFAULT, KNIFE | {"targets": rows})) for name, rows in targets.items()}
    along = made["none"].poses(PINGS).x
    crossing = np.flatnonzero(np.abs(along - 20.0) < 0.7)
    costs = microseconds(**{name: (simulation, np.tile(crossing, 8), 1) for name, simulation in made.items()})
    pipe, mesh = costs["pipe"][0], costs["mesh"][0]
    tell(say, f"knife, {crossing.size} pings that cross a target, mesh of 20,480 / pipe × {mesh / pipe:.2f}", costs)


def test_length(say):
    bare = prepare(edit(DEFAULT, KNIFE | BARE))
    tell(say, "knife, by pings", microseconds(**{str(n): (bare, np.arange(n), 1) for n in (128, 512, 2048, 8192)}))


def test_planes(say):
    simulation = prepare(DEFAULT)
    costs = microseconds(**{str(n): (simulation, PINGS[::4], n) for n in (4, 8, 16, 32, 64)})
    tell(say, "fan of 1°, default scene, by planes", costs)
