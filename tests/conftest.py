"""What all tests share."""

import gc
import itertools
import os
import sys
from collections.abc import Callable

import pytest
from hypothesis import settings

# Workers of pytest-xdist inherit it: threads of linear algebra of several processes wait for one another in loops.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

# Tests of 8 s of processor time and more. They begin first, so that none of them is the last that others wait for.
LONG = (
    "test_plans_keep_to_their_tolerances[wide]",
    "test_a_real_recording_is_learned",
    "test_any_mistake_is_one_sentence",
    "test_a_narrow_fan_in_water_that_refracts_is_near_exact_rays[thermocline-400]",
    "test_what_is_done_before_a_full_disk_a_kill_and_an_interrupt_is_kept_and_completed",
    "test_any_scene_makes_a_record_or_says_why_not",
    "test_the_main_thread_never_sums_the_relief",
    "test_a_recording_is_drawn_beside_the_scene",
)

# The same examples at every run: a change is what makes a test fail, never luck.
settings.register_profile("same", derandomize=True)
settings.load_profile("same")


def pytest_addoption(parser: pytest.Parser) -> None:
    """Let golden figures be taken anew."""
    parser.addoption("--update-golden", action="store_true", help="take the golden figures anew")


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Begin with the long tests; of several workers each takes an equal share of them and of the others in turn."""
    workers = int(os.environ.get("PYTEST_XDIST_WORKER_COUNT", "1"))
    long = [item for item in items if item.name in LONG]
    short = [item for item in items if item.name not in LONG]
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
