"""Pages in HTML, each of which contains all that it shows, by the templates in ``resources/pages``."""

import base64
from typing import Any

from insonify.files import resources


def fill_page(name: str, **values: Any) -> str:
    """Fill the template of a name; text is escaped."""
    from jinja2 import Environment, FileSystemLoader, StrictUndefined  # lazy: only pages need it

    loader = FileSystemLoader(resources() / "pages")
    pages = Environment(
        loader=loader, autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True,
        keep_trailing_newline=True,
    )  # fmt: skip
    return pages.get_template(f"{name}.html").render(values)


def picture_url(picture: bytes) -> str:
    """Address of a PNG picture that contains the picture itself; empty without one."""
    return f"data:image/png;base64,{base64.b64encode(picture).decode('ascii')}" if picture else ""
