"""Figures of speed that pages quote: all of them are read from the charts on the page of accuracy."""

from __future__ import annotations

import re
from functools import cache
from pathlib import Path

PAGE = Path(__file__).resolve().parents[1] / "accuracy" / "index.md"
# A quoted figure is a link whose title names it: [59](accuracy/index.md "measured: ratio with targets")
QUOTED = re.compile(r'\[[^\]\n]*\](\([^)\s]+ "measured: ([\w ]+)"\))')


def quote(text: str) -> str:
    """Return a page with the quoted figures as they were measured last."""
    return QUOTED.sub(lambda match: f"[{_figures()[match[2]]}]{match[1]}", text)


@cache
def _figures() -> dict[str, str]:
    """Read the figures from what the charts of the default scene and of rough ground printed."""
    _, default, rough, *_ = re.split(r"^\$ insonify chart", PAGE.read_text(encoding="utf-8"), flags=re.MULTILINE)
    ratios = [re.findall(r"× ([\d.]+)$", chart, re.MULTILINE)[:2] for chart in (default, rough)]
    found = re.search(r"^default plan.*?: ([\d.]+ %) in ([\d.]+ \S+?),", default, re.MULTILINE)
    if found is None or any(len(each) < 2 for each in ratios):
        raise SystemExit(f"{PAGE.name}: the printed charts lack a ratio or the default plan; see docs/make/speeds.py")
    return {
        "error of the default scene": found[1],
        "ping of the default scene": found[2],
        "ratio without targets": ratios[0][0],
        "ratio with targets": ratios[0][1],
        "ratios on rough ground": f"{ratios[1][1]} to {ratios[1][0]}",
    }
