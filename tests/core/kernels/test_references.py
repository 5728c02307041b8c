"""Kernels give back every array that they are handed or make: none is counted twice and kept for ever."""

import gc
from collections.abc import Callable

import numpy as np
import pytest
from numba.core.runtime import _nrt_python, rtsys

from insonify.explanation.pixel import explain_pixel
from insonify.scene import edit, load_scene
from insonify.simulation import prepare

SMALL = {"sonar.bins": 100}
SEA = {"water.surface": {"kind": "flat"}}
SCENES = {
    "targets": {},
    "ghosts": SMALL,
    "rough-ground": SMALL,
    "thermocline": SMALL,
    "wreck": SMALL,
    "raw-record": SMALL,
    "figure-3": SMALL,
    "endless": SMALL | {"track.pings": 12},
}


@pytest.fixture(scope="module", autouse=True)
def counted():
    """Count what is allocated and freed, as Numba does on request; collections pass over what other tests have made."""
    _nrt_python.memsys_enable_stats()
    gc.collect()
    gc.freeze()
    yield
    gc.unfreeze()
    _nrt_python.memsys_disable_stats()


def left(call: Callable[[], object]) -> int:
    """Allocations of a call that outlive it; what it keeps for the next call was made by one before.

    Allocations of all threads are counted. A call that leaves something does so every time, which tells it from a
    thread of an earlier test that works or ends meanwhile.
    """
    call()
    for _ in range(4):
        gc.collect()
        before = rtsys.get_allocation_stats()
        call()
        gc.collect()
        after = rtsys.get_allocation_stats()
        if not (found := (after.alloc - after.free) - (before.alloc - before.free)):
            break
    return found


@pytest.mark.usefixtures("fixed_model")
@pytest.mark.parametrize("name", SCENES)
def test_nothing_is_left_of_a_record_its_labels_and_an_explanation(name):
    simulation, pings = prepare(edit(load_scene(name), SCENES[name])), np.arange(5)
    assert left(lambda: simulation.intensity(pings)) == 0
    assert left(lambda: simulation.truth(pings)) == 0
    assert left(lambda: explain_pixel(simulation, 4, 1, 60)) == 0


@pytest.mark.parametrize("method", ["march", "rays"])
def test_nothing_is_left_of_other_methods(method):
    simulation = prepare(edit(load_scene("targets"), SMALL | SEA), method=method, tolerance=0.3)
    assert left(lambda: simulation.intensity(np.arange(3))) == 0
