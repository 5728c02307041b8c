"""Links in descriptions to a field and a value to try: ``[lower the fish](track.altitude=5)``."""

import re
from typing import Any, NamedTuple

from insonify.io.file_access import FileFault, parse_toml

_LINK = re.compile(r"\[(?P<words>[^\]]+)\]\((?P<path>[a-z_][\w.]*)=(?P<literal>[^()]*)\)")


class Link(NamedTuple):
    """A value to try."""

    words: str  # the words that are linked
    path: str  # dotted path of the field
    value: Any  # value to try


def split_description(text: str) -> tuple[str | Link, ...]:
    """Split a description into its plain words and its links, in order, with single spaces."""
    text = " ".join(text.split())
    parts: list[str | Link] = []
    end = 0
    for match in _LINK.finditer(text):
        parts += [text[end : match.start()], Link(match["words"], match["path"], read_literal(match["literal"]))]
        end = match.end()
    parts.append(text[end:])
    return tuple(part for part in parts if part)


def read_literal(literal: str) -> Any:
    """Read a value in TOML; anything else is taken as text."""
    try:
        return parse_toml(f"value = {literal}")["value"]
    except FileFault:
        return literal.strip()
