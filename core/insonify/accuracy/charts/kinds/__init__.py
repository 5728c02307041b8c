"""Kinds of charts, one module each, found by their names.

A module of this package is a kind of chart. It defines ``measure_chart(scene, *, progress=None)``, which returns a
`Chart`; the first line of its docstring names the measured quantities.
"""

import pkgutil
from collections.abc import Callable
from importlib import import_module
from typing import Any


def list_chart_kinds() -> tuple[str, ...]:
    """Names of the kinds of charts, found without importing them."""
    return tuple(sorted(module.name for module in pkgutil.iter_modules(__path__)))


def load_chart_kind(name: str) -> Callable[..., Any]:
    """Import a kind of chart and return its ``measure_chart``."""
    measure: Callable[..., Any] = import_module(f"{__name__}.{name}").measure_chart
    return measure
