"""Text of files in widgets that obey some characters: HTML in labels, tips and questions, & and tabs in menus."""

import html

from insonify.errors import plain_text


def literal(text: str) -> str:
    """Return text for a widget that takes some for HTML, so that it shows every character as it is."""
    text = plain_text(text)
    return f"<span>{html.escape(text)}</span>".replace("\n", "<br>") if "<" in text else text


def entry_name(text: str) -> str:
    """Return text for a menu or a button: no character becomes a shortcut or a column."""
    return one_line(text).replace("&", "&&")


def window_title(text: str) -> str:
    """Return text for the title of a window, where ``[*]`` marks unsaved changes unless it is written twice."""
    return one_line(text).replace("[*]", "[*][*]")


def one_line(text: str) -> str:
    """Return text without control characters and on one line."""
    return plain_text(" ".join(text.split()))
