"""All stability cases: every module in ``themes`` that defines a ``THEME``, found without being listed."""

from __future__ import annotations

from insonify.accuracy.stability.case import StabilityCase, StabilityTheme
from insonify.plugins import modules_in


def find_themes() -> list[StabilityTheme]:
    """Import the modules of ``themes`` and return their themes in the order of the page."""
    modules = modules_in("insonify.accuracy.stability.themes")
    return sorted((module.THEME for module in modules), key=lambda theme: theme.place)


CASES: dict[str, tuple[StabilityCase, ...]] = {theme.title: theme.cases for theme in find_themes()}
