"""How long it takes to explain a pixel, to cut a cross-section, and to find the pixels that hear a place.

Run with `pytest -m bench -s tests/bench/test_pixel_speed.py`.
"""

from statistics import median
from time import perf_counter

import numpy as np
import pytest

from insonify.explanation.cross_section import cut_cross_section
from insonify.explanation.listeners import find_listeners
from insonify.explanation.pixel import explain_pixel
from insonify.scene import load_scene
from insonify.simulation import prepare

pytestmark = pytest.mark.bench
SCENES = ("default", "targets", "wreck", "thermocline", "ghosts", "raw-record", "rough-tow", "double-image")


def milliseconds(work):
    start = perf_counter()
    work()
    return 1e3 * (perf_counter() - start)


@pytest.mark.parametrize("name", SCENES)
def test_time_of_an_explanation(name, say):
    simulation = prepare(load_scene(name))
    bins = np.linspace(0.25, 0.95, 12) * simulation.reduced.bins
    explain_pixel(simulation, 60, 0, int(bins[0]))
    times = [milliseconds(lambda k=k: explain_pixel(simulation, 60, 0, int(k))) for k in bins]
    cut_cross_section(simulation, 60, 0)
    cut = milliseconds(lambda: cut_cross_section(simulation, 60, 0))
    place = np.array([float(simulation.poses(np.array([60])).x[0]), 20.0, 0.0])
    find_listeners(simulation, place, np.arange(0, 120))
    heard = milliseconds(lambda: find_listeners(simulation, place, np.arange(0, 120)))
    say(
        f"{name}: pixel {median(times):.1f} ms (most {max(times):.1f}), cross-section {cut:.1f} ms, "
        f"pixels of a place {heard:.1f} ms\n"
    )
