"""PyVista without Matplotlib, which it imports for charts and named colour maps: 50 MB, and a third of its time."""

import sys
from collections.abc import Callable
from importlib import import_module
from types import ModuleType
from typing import Any

COLOURS, CHARTS = "matplotlib.colors", "matplotlib.backends"
LATER = (COLOURS, CHARTS, f"{CHARTS}.backend_agg", "matplotlib.pyplot", "matplotlib")
UNUSED = ("mypy",)  # what PyVista looks up for types where it is installed: 25 MB


class Later:
    """An object of a module that is imported when it is first called; until then nothing is an instance of it."""

    def __init__(self, find: Callable[[], Any]) -> None:
        self._find = find

    def __getattr__(self, name: str) -> Any:
        return Later(lambda: getattr(self._find(), name))

    def __getitem__(self, key: Any) -> Any:
        return Later(lambda: self._find()[key])

    def __call__(self, *arguments: Any, **named: Any) -> Any:
        """Call the object."""
        return self._find()(*arguments, **named)

    def __instancecheck__(self, instance: object) -> bool:
        imported = not isinstance(sys.modules.get(COLOURS), _Module | None)
        return imported and isinstance(instance, self._find())

    def __ror__(self, other: Any) -> Any:
        return other  # of a list of types


class _Module(ModuleType):
    """A module of which everything is found `Later`."""

    __path__: list[str] = []  # noqa: RUF012  # as of a package

    def __getattr__(self, name: str) -> Any:
        if name.startswith("__"):
            raise AttributeError(name)
        return Later(lambda: getattr(import_module(self.__name__), name))


def _import_lean(name: str) -> Any:
    """Import a module of PyVista; what it takes of Matplotlib is imported when that is called."""
    stand_ins: dict[str, Any] = {} if "matplotlib" in sys.modules else {each: _Module(each) for each in LATER}
    stand_ins |= {each: None for each in UNUSED if each not in sys.modules}
    sys.modules.update(stand_ins)
    try:
        return import_module(name)
    finally:
        for each in stand_ins:
            sys.modules.pop(each, None)


pv: Any = _import_lean("pyvista")  # untyped
_import_lean("pyvista.plotting")
