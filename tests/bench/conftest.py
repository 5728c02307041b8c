"""What all benchmarks share."""

import sys
from collections.abc import Callable

import pytest


@pytest.fixture
def say(capsys: pytest.CaptureFixture[str]) -> Callable[[str], None]:
    """Print a line at once, beside what is captured."""

    def say_at_once(text: str) -> None:
        with capsys.disabled():
            sys.stdout.write(f"\n{text}")

    return say_at_once
