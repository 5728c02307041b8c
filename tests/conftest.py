"""What all tests share."""

from __future__ import annotations

from hypothesis import settings

# The same examples at every run: a change is what makes a test fail, never luck.
settings.register_profile("same", derandomize=True)
settings.load_profile("same")
