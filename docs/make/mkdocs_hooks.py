"""MkDocs hooks: formulas become MathML when the site is built, and each package gets an API page."""

from __future__ import annotations

import ast
import html
import re
from pathlib import Path
from typing import Any

from latex2mathml.converter import convert
from mkdocs.structure.files import File

ROOT = Path(__file__).resolve().parents[2]
FORMULA = re.compile(r'<(span|div) class="arithmatex">\\(?:\(|\[)(.*?)\\(?:\)|\])</\1>', re.DOTALL)
PACKAGES = {"insonify": ROOT / "core" / "insonify", "insonify_viewer": ROOT / "app" / "insonify_viewer"}


def on_config(config: Any) -> Any:
    """Add the API pages to the navigation, below the reference."""
    reference = next(section["Reference"] for section in config.nav if "Reference" in section)
    if not any("Packages" in entry for entry in reference):
        reference.append({"Packages": [{title: path} for title, path, _ in _api_pages()]})
    return config


def on_files(files: Any, config: Any) -> Any:
    """Add the API pages, which are made from the sources and stand in no file."""
    for _, path, text in _api_pages():
        files.append(File.generated(config, path, content=text))
    return files


def on_page_content(page_html: str, **_: Any) -> str:
    """Replace the TeX of a page by MathML, which browsers draw without a script."""

    def mathml(match: re.Match[str]) -> str:
        display = "block" if match[1] == "div" else "inline"
        return str(convert(html.unescape(match[2].strip()), display=display))

    return FORMULA.sub(mathml, page_html)


def _api_pages() -> list[tuple[str, str, str]]:
    """List title, path and text of the page of each package; the modules of a package stand on one page."""
    pages = []
    for name, folder in PACKAGES.items():
        groups: dict[str, list[Path]] = {}
        for path in sorted(folder.rglob("*.py")):
            parts = path.relative_to(folder).with_suffix("").parts
            depth = 2 if parts[0] == "kernels" and len(parts) > 2 else 1
            groups.setdefault(".".join(parts[:depth] if len(parts) > 1 else ()), []).append(path)
        for group, paths in groups.items():
            title = f"{name}.{group}" if group else name
            pages.append((title, f"reference/api/{title}.md", _api_page(title, folder.parent, paths)))
    return pages


def _api_page(title: str, source: Path, paths: list[Path]) -> str:
    """List the modules of one package with their first docstring lines, then their contents."""
    names = {path: _module_name(path.relative_to(source)) for path in paths}
    table = [f"| [`{names[path]}`][{names[path]}] | {_first_line(path)} |" for path in paths]
    head = [f"# {title}", "", "| module | what it holds |", "|---|---|", *table]
    # The public names have a page of their own.
    bodies = [f"::: {name}\n" + ("    options: { members: false }\n" * (name == "insonify")) for name in names.values()]
    return "\n".join([*head, "", *bodies])


def _module_name(path: Path) -> str:
    parts = path.with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


def _first_line(path: Path) -> str:
    docstring = ast.get_docstring(ast.parse(path.read_text(encoding="utf-8"))) or ""
    return docstring.partition("\n")[0].replace("|", "\\|")
