"""What is collected while a window is open, and after."""

import gc
import time
import weakref
from pathlib import Path

import pytest

from insonify_viewer.work.gc_policy import collected_by_hand, leave_out_libraries


class Node:
    """An object that refers to itself."""

    def __init__(self):
        self.own = self


def test_what_is_left_out_is_not_gone_through_and_is_collected_in_the_end():
    with collected_by_hand():
        kept = weakref.ref(Node())
        before = len(gc.get_objects())
        leave_out_libraries()
        assert len(gc.get_objects()) < 0.1 * before + 1000
        gc.collect()
        assert kept() is not None
    assert kept() is None
    assert gc.isenabled()


def test_what_comes_later_is_collected_as_ever():
    with collected_by_hand():
        leave_out_libraries()
        gone = weakref.ref(Node())
        gc.collect()
        assert gone() is None


@pytest.mark.parametrize("function", ["get_objects", "get_referrers"])
def test_no_source_asks_for_all_objects(function):
    """A tuple that another thread makes from a generator would have a second owner, which ends its making."""
    sources = [path for folder in ("app", "core") for path in Path(folder).rglob("*.py")]
    assert len(sources) > 100
    assert [path for path in sources if f"gc.{function}(" in path.read_text(encoding="utf-8")] == []


def test_cycles_are_collected_in_a_small_share_of_the_time():
    with collected_by_hand() as policy:
        gone = weakref.ref(Node())
        kept = [[number] for number in range(200_000)]
        until = time.perf_counter() + 120.0
        while gone() is not None and time.perf_counter() < until:
            kept.extend([number] for number in range(10_000))
            policy.collect()
    assert gone() is None
