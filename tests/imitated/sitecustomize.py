"""Imported by Python at its start: the system that `other_systems` imitates is imitated in child processes too."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))
import other_systems  # noqa: F401

sys.path.pop(0)
