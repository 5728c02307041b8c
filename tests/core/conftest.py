"""What tests of the core share."""

import os
from pathlib import Path

import pytest


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
