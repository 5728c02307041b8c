"""Charts measured on this machine, written as a picture or as a table with the facts of the measurement."""

import csv
import json
import math
from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

from matplotlib import rc_context
from matplotlib.figure import Figure

from insonify.io.atomic import replacing
from insonify.scene import SceneError

SUFFIXES = (".png", ".svg", ".csv", ".json")
DPI = 150


class ChartTable(NamedTuple):
    """Rows of a chart, with the facts that hold for all of them."""

    facts: Mapping[str, Any]  # facts about all rows: the scene, the machine, the reference
    columns: Sequence[str]  # names of the columns
    rows: Sequence[Sequence[Any]]  # text, numbers, or None where a value is missing


class Chart(ABC):
    """Measurements of one scene that can be drawn, tabulated and saved."""

    @abstractmethod
    def tabulate(self) -> ChartTable:
        """Lay the measurements out as rows."""

    @abstractmethod
    def draw(self) -> Figure:
        """Draw the measurements on a figure with an Agg canvas."""

    def summarise(self) -> tuple[str, ...]:
        """State the main results in sentences; none by default."""
        return ()

    def save(self, path: str | Path) -> None:
        """Write the chart as a picture (.png, .svg) or as a table (.csv, .json), whole or not at all."""
        suffix = Path(path).suffix.lower()
        if suffix not in SUFFIXES:
            known = f"{', '.join(SUFFIXES[:-1])} or {SUFFIXES[-1]}"
            raise SceneError(f"output: {Path(path).name!r} has no known suffix; end the name in {known}")
        table = self.tabulate()
        with replacing(path) as partial:
            if suffix == ".csv":
                # Each fact has a column of its own, so that it survives any reader of CSV.
                facts = [_text(value) for value in table.facts.values()]
                with partial.open("w", newline="", encoding="utf-8") as file:
                    lines = csv.writer(file)
                    lines.writerow([*table.columns, *table.facts])
                    lines.writerows([*map(_text, row), *facts] for row in table.rows)
            elif suffix == ".json":
                rows = [dict(zip(table.columns, map(_finite, row))) for row in table.rows]
                text = json.dumps({**table.facts, "rows": rows}, indent=1, ensure_ascii=False)
                partial.write_text(text, encoding="utf-8", newline="")
            else:
                about = {"Description": "\n".join(f"{name}: {_text(value)}" for name, value in table.facts.items())}
                with rc_context({"svg.fonttype": "none"}):  # text stays text
                    self.draw().savefig(partial, format=suffix[1:], dpi=DPI, metadata=about)


def _finite(value: Any) -> Any:
    """Replace NaN and infinities, which JSON does not have."""
    return None if isinstance(value, float) and not math.isfinite(value) else value


def _text(value: Any) -> str:
    if isinstance(value, float):
        return f"{value:.6g}" if math.isfinite(value) else ""
    if isinstance(value, Mapping):
        return "; ".join(f"{key}: {_text(each)}" for key, each in value.items())
    return "" if value is None else str(value)
