"""Cards of HTML for notebooks: a title, facts, and what folds out; escaped, with nothing from outside."""

from collections.abc import Iterable
from html import escape


def make_card(title: str, rows: Iterable[tuple[str, str]], more: str = "") -> str:
    """Return a card.

    Parameters
    ----------
    title
        Its heading, in plain text.
    rows
        Name and value of each fact, in plain text.
    more
        HTML that folds out below.
    """
    facts = "".join(
        f"<tr><th style='text-align:left'>{escape(name)}</th><td style='text-align:left'>{escape(value)}</td></tr>"
        for name, value in rows
    )
    folded = f"<details><summary>more</summary>{more}</details>" if more else ""
    return f"<div><strong>{escape(title)}</strong><table>{facts}</table>{folded}</div>"


def quote_text(text: str) -> str:
    """Return lines of plain text as HTML."""
    return f"<pre>{escape(text)}</pre>"
