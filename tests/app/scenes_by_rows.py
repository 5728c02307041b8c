"""Bundled scenes as cases of tests that look at every row of the parameters."""

import re

import pytest

from insonify.scene import bundled_scenes, load_scene
from insonify_viewer.state.sections import sections_of


def scenes_by_rows() -> list:
    """Every bundled scene; slow are those whose rows, by path and label, all stand in scenes before them."""
    cases, known = [], set()
    for name in sorted(bundled_scenes()):
        rows = [row for section in sections_of(load_scene(name)) for row in section.parameters]
        kinds = {re.sub(r"\d+", "0", f"{row.path} {row.label}") for row in rows}
        cases.append(pytest.param(name, marks=[pytest.mark.slow] * (kinds <= known)))
        known |= kinds
    return cases
