"""What all tests share."""

from __future__ import annotations

import os

import pytest
from hypothesis import settings

# Workers of pytest-xdist inherit it: threads of linear algebra of several processes wait for one another in loops.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

# The same examples at every run: a change is what makes a test fail, never luck.
settings.register_profile("same", derandomize=True)
settings.load_profile("same")


def pytest_addoption(parser: pytest.Parser) -> None:
    """Let golden figures be taken anew."""
    parser.addoption("--update-golden", action="store_true", help="take the golden figures anew")
