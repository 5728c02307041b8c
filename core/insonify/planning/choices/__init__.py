"""Choices of a plan, one file a group, each listed in its file's ``CHOICES``."""

from importlib import import_module
from pkgutil import iter_modules

from insonify.planning.choices.base import Choice

_FILES = sorted(found.name for found in iter_modules(__path__) if found.name != "base")
CHOICES: tuple[Choice, ...] = tuple(
    sorted(
        (choice for name in _FILES for choice in import_module(f"{__name__}.{name}").CHOICES),
        key=lambda choice: choice.rank,
    )
)
