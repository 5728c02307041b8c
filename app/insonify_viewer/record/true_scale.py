"""The part of a view in which a metre along the track is as long as a metre across."""

from __future__ import annotations

from PySide6.QtCore import QRect

LEAST_FILLED = 0.55  # share of the room that a plot at true scale fills; else the plot fills the room
ALIKE = 0.02  # deviation of two scales that counts as none
MANY = 10.0  # ratio that is told in whole numbers


def plot_at_true_scale(room: QRect, along: float, across: float, *, always: bool = False) -> QRect:
    """Largest plot at true scale in the upper left of a room, or the whole room where too little would be filled."""
    scale = min(room.width() / across, room.height() / along)
    plot = QRect(room.left(), room.top(), max(round(across * scale), 1), max(round(along * scale), 1))
    filled = plot.width() * plot.height() / max(room.width() * room.height(), 1)
    return plot if always or filled >= LEAST_FILLED else room


def name_scale(plot: QRect, along: float, across: float) -> str:
    """Say whether a plot is at true scale, and by how much the track is drawn out or compressed else."""
    ratio = (plot.height() / along) / max(plot.width() / across, 1e-9)
    if abs(ratio - 1.0) < ALIKE:
        return "1 : 1"
    sign, by = ("×", ratio) if ratio > 1.0 else ("÷", 1.0 / ratio)
    return f"track {sign} {by:.2g}" if by < MANY else f"track {sign} {by:.0f}"
