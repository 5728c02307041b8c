"""What is collected while a window is open, and after."""

from __future__ import annotations

import gc
import weakref

from insonify_viewer.gc_policy import collected_by_hand, leave_out_libraries


class Node:
    """An object that refers to itself."""

    def __init__(self) -> None:
        self.own = self


def test_what_is_left_out_is_not_gone_through_and_is_collected_in_the_end() -> None:
    with collected_by_hand():
        kept = weakref.ref(Node())
        before = len(gc.get_objects())
        leave_out_libraries()
        assert len(gc.get_objects()) < 0.1 * before + 1000
        gc.collect()
        assert kept() is not None
    assert kept() is None
    assert gc.isenabled()


def test_what_comes_later_is_collected_as_ever() -> None:
    with collected_by_hand():
        leave_out_libraries()
        gone = weakref.ref(Node())
        gc.collect()
        assert gone() is None
