"""Actions of a person in the window, and how often each is taken; a module here adds its own by `action`.

An action is a function of the window's `Viewer` and of random numbers. It yields the milliseconds until its next step.
"""

import pkgutil
from collections.abc import Callable, Iterator
from importlib import import_module
from typing import NamedTuple

import numpy as np

from insonify_viewer.viewer import Viewer

Random = np.random.Generator
Steps = Iterator[float]
Do = Callable[[Viewer, Random], Steps]


class Action(NamedTuple):
    """An action, and how often it is taken beside the others."""

    do: Do
    weight: float


ACTIONS: list[Action] = []


def action(weight: float) -> Callable[[Do], Do]:
    """Decorate a function as an action; its weight tells how often it is taken beside the others."""

    def register(do: Do) -> Do:
        ACTIONS.append(Action(do, weight))
        return do

    return register


def draw_action(random: Random) -> Action:
    """Draw an action by the weights."""
    weights = np.array([action.weight for action in ACTIONS])
    return ACTIONS[random.choice(len(ACTIONS), p=weights / weights.sum())]


for _module in sorted(module.name for module in pkgutil.iter_modules(__path__)):
    import_module(f"{__name__}.{_module}")
