"""A chart as a file: a picture, or a table with what it was measured on."""

from __future__ import annotations

import csv
import json
import math
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from insonify.io.atomic import replacing
from insonify.scene import SceneError

if TYPE_CHECKING:
    from matplotlib.figure import Figure

SUFFIXES = (".png", ".svg", ".csv", ".json")
DPI = 150


class Table(NamedTuple):
    """What a chart holds, in rows.

    Attributes
    ----------
    facts : mapping
        What is true of all rows: the scene, the machine, the reference.
    columns : sequence of str
        Names of the columns.
    rows : sequence of sequences
        Text, numbers, or None where there is nothing to tell.
    """

    facts: Mapping[str, Any]
    columns: Sequence[str]
    rows: Sequence[Sequence[Any]]


def save(path: str | Path, table: Table, draw: Callable[[], Figure]) -> None:
    """Write a chart by the ending of the file's name, whole or not at all.

    Parameters
    ----------
    path : str or Path
        Ends in .png, .svg, .csv or .json.
    table : Table
        What it holds; its facts go into every kind of file.
    draw : callable
        Makes the picture.

    Raises
    ------
    SceneError
        If the name ends in anything else.
    """
    suffix = Path(path).suffix.lower()
    if suffix not in SUFFIXES:
        known = f"{', '.join(SUFFIXES[:-1])} or {SUFFIXES[-1]}"
        raise SceneError(f"output: {Path(path).name!r} names no format that is known; end it in {known}")
    with replacing(path) as beside:
        if suffix == ".csv":
            _write_csv(beside, table)
        elif suffix == ".json":
            rows = [dict(zip(table.columns, map(_finite, row))) for row in table.rows]
            beside.write_text(json.dumps({**table.facts, "rows": rows}, indent=1, ensure_ascii=False), encoding="utf-8")
        else:
            _write_picture(beside, suffix, table, draw())


def _write_csv(path: Path, table: Table) -> None:
    """Facts of all rows stand in columns of their own, so that any reader of such tables has them."""
    facts = [_text(value) for value in table.facts.values()]
    with path.open("w", newline="", encoding="utf-8") as file:
        lines = csv.writer(file)
        lines.writerow([*table.columns, *table.facts])
        lines.writerows([*map(_text, row), *facts] for row in table.rows)


def _write_picture(path: Path, suffix: str, table: Table, figure: Figure) -> None:
    from matplotlib import rc_context

    told = "\n".join(f"{name}: {_text(value)}" for name, value in table.facts.items())
    with rc_context({"svg.fonttype": "none"}):  # words stay words
        figure.savefig(path, format=suffix[1:], dpi=DPI, metadata={"Description": told})


def _finite(value: Any) -> Any:
    """JSON knows neither NaN nor infinity."""
    return None if isinstance(value, float) and not math.isfinite(value) else value


def _text(value: Any) -> str:
    if isinstance(value, float):
        return f"{value:.6g}" if math.isfinite(value) else ""
    if isinstance(value, Mapping):
        return "; ".join(f"{key}: {_text(each)}" for key, each in value.items())
    return "" if value is None else str(value)
