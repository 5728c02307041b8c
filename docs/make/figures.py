"""Draw the figures of the theory and architecture pages."""

from pathlib import Path


def draw(folder: Path) -> None:
    """Draw all figures."""
