"""What all tests share."""

import gc
import itertools
import os
import sys
from collections.abc import Callable
from pathlib import Path

import pytest
from hypothesis import settings

# Workers of pytest-xdist inherit it: threads of linear algebra of several processes wait for one another in loops.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

# Tests of some seconds of processor time, by their functions. They begin first, so that none of them is the last that
# others wait for.
LONG = frozenset(Path(__file__).with_name("long.txt").read_text(encoding="utf-8").split())

# The same examples at every run: a change is what makes a test fail, never luck.
settings.register_profile("same", derandomize=True)
settings.load_profile("same")


def pytest_addoption(parser: pytest.Parser) -> None:
    """Let golden figures be taken anew."""
    parser.addoption("--update-golden", action="store_true", help="take the golden figures anew")


@pytest.hookimpl(tryfirst=True)  # before tests are chosen by their marks
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Begin with the long tests; of several workers each takes an equal share of them and of the others in turn."""
    workers = int(os.environ.get("PYTEST_XDIST_WORKER_COUNT", "1"))
    long, short = [], []
    for item in items:
        if item.nodeid.partition("[")[0] in LONG:
            item.add_marker("long")
            long.append(item)
        else:
            short.append(item)
    edges = [len(short) * k // workers for k in range(workers + 1)]
    shares = (long[k::workers] + short[first:last] for k, (first, last) in enumerate(itertools.pairwise(edges)))
    items[:] = itertools.chain.from_iterable(shares)


def pytest_collection_finish() -> None:
    """Leave tests and libraries, which live to the end, out of garbage collections: each would take 0.2 s."""
    gc.freeze()


@pytest.fixture
def say(capsys: pytest.CaptureFixture[str]) -> Callable[[str], None]:
    """Print a line at once, beside what is captured."""

    def say_at_once(text: str) -> None:
        with capsys.disabled():
            sys.stdout.write(f"\n{text}")

    return say_at_once
