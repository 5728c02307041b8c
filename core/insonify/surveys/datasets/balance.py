"""Balance of classes, as a picture."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

SIZE = (9.0, 3.6)  # inches
TINTS = ("#1f7a8c", "#b3561d", "#9aa5b1", "#6a4c93", "#4f772d")


def draw_balance(
    path: Path,
    targets: Mapping[tuple[str, str], int],
    tiles: Mapping[str, int],
    empty: Mapping[str, int],
    classes: Sequence[str],
    splits: Sequence[str],
) -> None:
    """Draw how many targets of each class, and how many tiles with and without targets, each split has."""
    import matplotlib as mpl
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=SIZE, layout="constrained")
    FigureCanvasAgg(figure)
    left, right = figure.subplots(1, 2, width_ratios=[max(len(classes), 1), 2])
    width = 0.8 / len(splits)
    for number, split in enumerate(splits):
        tint = TINTS[number % len(TINTS)]
        shift = (number - 0.5 * (len(splits) - 1)) * width
        counts = [targets.get((name, split), 0) for name in classes]
        left.bar_label(left.bar(np.arange(len(classes)) + shift, counts, width, color=tint, label=split), fontsize=8)
        counts = [tiles.get(split, 0) - empty.get(split, 0), empty.get(split, 0)]
        right.bar_label(right.bar(np.arange(2) + shift, counts, width, color=tint), fontsize=8)
    left.set_xticks(range(len(classes)), classes)
    left.set(ylabel="annotated targets")
    right.set_xticks(range(2), ["with targets", "without"])
    right.set(ylabel="tiles")
    left.legend(frameon=False, fontsize=9)
    for axes in (left, right):
        axes.spines[["top", "right"]].set_visible(False)
        axes.margins(y=0.12)
    figure.savefig(path, dpi=110, metadata={"Software": f"Matplotlib {mpl.__version__}"})
