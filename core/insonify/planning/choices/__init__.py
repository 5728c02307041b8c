"""Choices of a plan, one file a group, each listed in its file's ``CHOICES``."""

from insonify.planning.choices.base import Choice
from insonify.plugins import modules_in

_FOUND: list[Choice] = [choice for module in modules_in(__name__, without=("base",)) for choice in module.CHOICES]
CHOICES = tuple(sorted(_FOUND, key=lambda choice: choice.rank))
