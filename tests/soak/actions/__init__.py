"""Actions of a person in the window, and how often each is taken; a module here adds its own by `action`.

An action is a function of the window's `Viewer` and of random numbers. It yields the milliseconds until its next step.
"""

import pkgutil
from collections.abc import Callable, Iterator
from importlib import import_module

import numpy as np

from insonify_viewer.viewer import Viewer

Random = np.random.Generator
Steps = Iterator[float]
Do = Callable[[Viewer, Random], Steps]


ACTIONS: dict[Do, float] = {}  # and their weights


def action(weight: float) -> Callable[[Do], Do]:
    """Decorate a function as an action; its weight tells how often it is taken beside the others."""

    def register(do: Do) -> Do:
        ACTIONS[do] = weight
        return do

    return register


def draw_actions(random: Random) -> Iterator[Do]:
    """Draw actions by their weights, after each once: a short run too uses every part of the window."""
    actions, weights = list(ACTIONS), np.array(list(ACTIONS.values()))
    yield from (actions[k] for k in random.permutation(len(actions)))
    while True:
        yield actions[random.choice(len(actions), p=weights / weights.sum())]


for _module in sorted(module.name for module in pkgutil.iter_modules(__path__)):
    import_module(f"{__name__}.{_module}")
