"""What tests of the core share."""

import os
from pathlib import Path

import pytest

import insonify.simulation
from insonify.packing.packed_scene import Model
from insonify.planning import Plan
from insonify.planning.selection import keep_plan
from insonify.scene.water.surfaces import WAYS

# Everything that a scene declares, by a few planes.
WHOLE = Plan(Model(planes=4, across=4, bent=True, bounces=1, ways=frozenset(WAYS)))


@pytest.fixture
def fixed_model(monkeypatch: pytest.MonkeyPatch) -> None:
    """Simulate by one model with all effects: to plan takes most of the time, and is not what is tested."""
    monkeypatch.setattr(
        insonify.simulation,
        "choose_model",
        lambda packed, _, method, forced: keep_plan(packed, WHOLE, method, {"rays": "4000"} | forced),
    )


@pytest.fixture(scope="session")
def real_data() -> Path:
    """Folder of recordings, casts and grids made at sea, which the variable INSONIFY_REAL_DATA names."""
    if "INSONIFY_REAL_DATA" not in os.environ:
        pytest.skip("INSONIFY_REAL_DATA names no folder of real data")
    return Path(os.environ["INSONIFY_REAL_DATA"])


@pytest.fixture(scope="session")
def real_recording(real_data: Path) -> Path:
    """Recording of a wreck in XTF."""
    return real_data / "xtf" / "scotsman-iver2.xtf"
