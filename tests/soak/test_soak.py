"""The window used at random for two minutes: no exception, no message of Qt or OpenGL, no thread left."""

from pathlib import Path

import pytest

from commands import run_python


@pytest.mark.soak
@pytest.mark.parametrize("seed", ["1", "2"])
def test_a_window_used_at_random_keeps_in_order(seed):
    words, tests = ("-X", "faulthandler", "-m", "soak", "2", seed), Path(__file__).parents[1]
    code, printed, complaint = run_python(*words, cwd=tests, timeout=900)
    print(printed)  # noqa: T201
    assert code == 0, printed + complaint
