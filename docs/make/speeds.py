"""Figures of speed that pages quote: all are read from the charts and the plan that the documentation prints."""

from __future__ import annotations

import re
from functools import cache
from pathlib import Path

DOCS = Path(__file__).resolve().parents[1]
CHARTS, PLAN = DOCS / "accuracy" / "index.md", DOCS / "tutorial" / "first-record.md"
# A quoted figure is a link whose title names it: [59](accuracy/index.md "measured: ratio with targets")
QUOTED = re.compile(r'\[[^\]\n]*\](\([^)\s]+ "measured: ([\w ]+)"\))')


def quote(text: str) -> str:
    """Return a page with the quoted figures as they were measured last."""
    return QUOTED.sub(lambda match: f"[{_figures()[match[2]]}]{match[1]}", text)


@cache
def _figures() -> dict[str, str]:
    """Read the ratios of the default scene and of rough ground, and what the plan of the default scene says."""
    charts, plan = CHARTS.read_text(encoding="utf-8"), PLAN.read_text(encoding="utf-8")
    _, default, rough, *_ = re.split(r"^\$ insonify chart", charts, flags=re.MULTILINE)
    ratios = [re.findall(r"× ([\d.]+)$", chart, re.MULTILINE)[:2] for chart in (default, rough)]
    error = re.search(r"^Error +([\d.]+ %) of the record", plan, re.MULTILINE)
    cost = re.search(r"^Cost +([\d.]+ \S+) of one thread a ping", plan, re.MULTILINE)
    if error is None or cost is None or any(len(each) < 2 for each in ratios):
        raise SystemExit("the printed charts or the plan of the default scene lack a figure; see docs/make/speeds.py")
    return {
        "error of the default scene": error[1],
        "ping of the default scene": cost[1],
        "ratio without targets": ratios[0][0],
        "ratio with targets": ratios[0][1],
        "ratios on rough ground": f"{ratios[1][1]} to {ratios[1][0]}",
    }
