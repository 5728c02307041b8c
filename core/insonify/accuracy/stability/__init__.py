"""Cases of numerical failure of common methods, each measured beside the method that avoids it.

Every `StabilityTheme` at the top level of a module in ``themes`` adds its cases, without being listed.
"""

from insonify.accuracy.stability.case import Outcome, StabilityCase, StabilityTheme
from insonify.plugins import modules_in

__all__ = ["CASES", "Outcome", "StabilityCase", "find_themes"]


def find_themes() -> list[StabilityTheme]:
    """Import the modules of ``themes`` and return their themes in the order of the page."""
    values = (value for module in modules_in("insonify.accuracy.stability.themes") for value in vars(module).values())
    return sorted((value for value in values if isinstance(value, StabilityTheme)), key=lambda theme: theme.place)


CASES: dict[str, list[StabilityCase]] = {theme.title: theme.cases for theme in find_themes()}
