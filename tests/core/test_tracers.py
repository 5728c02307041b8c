"""The registry of tracers: each traces a scene's pings, and coherent speckle has a tracer of its own."""

from __future__ import annotations

import numpy as np
import pytest

from insonify.scene import edit, load_scene
from insonify.simulation import prepare
from insonify.tracers.registry import TRACERS, make_tracer
from insonify.tracers.scatterers import ScattererTracer

SCENE = edit(load_scene("default"), {"sonar.bins": 100, "sonar.beam": "knife", "track.pings": 4})
COHERENT = edit(
    SCENE, {"receiver.speckle": {"kind": "coherent", "density": 1.0}, "sonar.beam": {"kind": "fan", "width": 2.0}}
)


@pytest.mark.parametrize("name", TRACERS)
def test_every_tracer_traces_pings_by_themselves(name):
    simulation = prepare(COHERENT if name == "scatterers" else SCENE)
    tracer = TRACERS[name](simulation.scene, simulation.arrays)
    poses = simulation.poses(np.arange(3))
    record = tracer.trace(simulation.reduced, poses)
    assert record.shape == (3, 2, 100)
    assert record.dtype == np.float32
    assert record.any()
    alone = tracer.trace(simulation.reduced, simulation.poses(np.array([1])), threads=1)
    np.testing.assert_array_equal(alone[0], record[1])


def test_coherent_speckle_is_traced_scatterer_by_scatterer_whatever_the_method():
    arrays = prepare(COHERENT).arrays
    for method in ("sweep", "rays"):
        assert isinstance(make_tracer(method, COHERENT, arrays), ScattererTracer)
        assert make_tracer(method, SCENE, arrays).bins_beyond == 0
