"""The reference of scene fields, made from the declarations in ``insonify.scene``."""

from __future__ import annotations

import json
import re
from typing import Any

from insonify.scene import Scene
from insonify.scene.base import Nothing

HEAD = """# Scene fields

<!-- Made by `python docs/make` from the declarations in `insonify.scene`. Edit those. -->

Every field of a scene file, with its unit, default, bounds and meaning. Each table of the file has a page of its own.
The path before a field's name is its table in the TOML file and its name for `--set`: `--set sonar.beam.width=0.5`. A
field with a `kind` is written as a table, `beam = { kind = "fan", width = 1.0 }`, or as the bare name of the kind,
`beam = "fan"`, with all its defaults. Lengths are in metres, times in seconds, frequencies in hertz, angles in degrees.
Directions count counter-clockwise from +x (east). The axis z points up, with the sea surface at 0; *depth* points down.

"""
TABLE_HEAD = """# Scene fields: {name}

<!-- Made by `python docs/make` from the declarations in `insonify.scene`. Edit those. -->

{description} [How fields are written](../scene.md).

"""
TABLE = "| field | default | unit | bounds | meaning |\n|---|---|---|---|---|\n"
NOT_GIVEN = "not given"


def pages() -> dict[str, str]:
    """Return the pages by their paths below ``docs``: one of the whole scene, and one of each of its tables."""
    schema = Scene.model_json_schema()
    made = _Made(schema)
    made.fields("", schema, 1)
    texts = {"reference/scene.md": HEAD + made.taken()}
    for name, field in schema["properties"].items():
        references = _references(field)
        if references:
            made.declarations_of(name, field, 1)
            described = field if len(references) > 1 else schema["$defs"][references[0]]
            head = TABLE_HEAD.format(name=name, description=_sentence(described["description"]))
            texts[f"reference/scene/{name}.md"] = head + made.taken()
    return texts


class _Made:
    """Sections of a page in order; each declaration is printed once, at the shortest path that leads to it."""

    def __init__(self, schema: dict[str, Any]):
        self.declarations = schema["$defs"]
        self.out: list[str] = []
        self.printed: set[str] = set()
        self.homes = self._find_homes(schema)  # declaration: path and heading under which it stands

    def taken(self) -> str:
        """Return the sections made since the last page."""
        text = "".join(self.out).rstrip() + "\n"
        self.out.clear()
        return text

    def _find_homes(self, schema: dict[str, Any]) -> dict[str, tuple[str, str]]:
        """Walk the declarations breadth first."""
        homes: dict[str, tuple[str, str]] = {}
        queue = [("", schema)]
        for path, declaration in queue:
            for name, field in declaration["properties"].items():
                references = _references(field)
                shown = _path(path, name) + ("[]" if field.get("type") == "array" else "")
                for reference in references:
                    if reference not in homes:
                        kind = f": {_kind(self.declarations[reference])}" if len(references) > 1 else ""
                        homes[reference] = shown, shown + kind
                        queue.append((shown, self.declarations[reference]))
        return homes

    def fields(self, path: str, schema: dict[str, Any], level: int) -> None:
        """Print the fields of one declaration as a table, then the declarations within it."""
        fields = {name: field for name, field in schema["properties"].items() if name != "kind"}
        if not fields:
            self.out.append("No fields.\n\n")
            return
        required = schema.get("required", [])
        rows = [self._row(path, name, field, name in required) for name, field in fields.items()]
        self.out.append(TABLE + "".join(rows) + "\n")
        if path:
            for name, field in fields.items():
                self.declarations_of(_path(path, name), field, level)

    def declarations_of(self, full: str, field: dict[str, Any], level: int) -> None:
        """Print what a field may hold; the only declaration of a page stands under the page's own heading."""
        shown = full + ("[]" if field.get("type") == "array" else "")
        for reference in _references(field):
            home, title = self.homes[reference]
            if home == shown and reference not in self.printed and reference != Nothing.__name__:
                self.printed.add(reference)
                declaration = self.declarations[reference]
                if title != full or level > 1:
                    level = max(level, 2)
                    self.out.append(f"{'#' * level} {title}\n\n")
                    if declaration.get("description"):
                        self.out.append(f"{_sentence(declaration['description'])}\n\n")
                self.fields(shown, declaration, min(level + 1, 4))

    def _row(self, path: str, name: str, field: dict[str, Any], required: bool) -> str:
        references = _references(field)
        default = "required" if required else _default(field.get("default"))
        if default == NOT_GIVEN and Nothing.__name__ in references:
            default = _default("none")
        full = _path(path, name)
        shown = full + ("[]" if field.get("type") == "array" else "")
        kinds = [self._link(reference, shown) for reference in references]
        meaning = _escaped(_sentence(field.get("description", "")))
        if len(kinds) > 1:
            meaning += f" Kinds: {', '.join(kinds)}."
        elif kinds and self.homes[references[0]][0] != shown:
            heading = self.homes[references[0]][1]
            meaning += f" Fields as of [{heading}]({self._place(references[0], shown)})."
        linked = f"`{full}`" if path or not references else f"[`{full}`](scene/{name}.md)"
        return f"| {linked} | {default} | {field.get('unit', '')} | {_bounds(field)} | {meaning} |\n"

    def _link(self, reference: str, shown: str) -> str:
        """Name a kind, linked where it stands under another path."""
        name = f"`{_kind(self.declarations[reference])}`"
        near = self.homes[reference][0] == shown or reference == Nothing.__name__
        return name if near else f"[{name}]({self._place(reference, shown)})"

    def _place(self, reference: str, shown: str) -> str:
        """Return the link to a declaration from the page of a field."""
        home, heading = self.homes[reference]
        page = _table(home)
        return f"{'' if page == _table(shown) else f'{page}.md'}#{_anchor(heading)}"


def _table(shown: str) -> str:
    """Return the table of the scene that a path begins with."""
    return re.split(r"[.\[]", shown, maxsplit=1)[0]


def _path(path: str, name: str) -> str:
    return f"{path}.{name}" if path else name


def _anchor(heading: str) -> str:
    """Name of a heading in links, as Markdown's tables of contents make it."""
    return re.sub(r"[\s-]+", "-", re.sub(r"[^\w\s-]", "", heading).strip().lower())


def _references(field: dict[str, Any]) -> list[str]:
    """Names of the declarations that a field may hold."""
    inner = field.get("items", {}) if field.get("type") == "array" else field
    found = [inner, *inner.get("oneOf", []), *inner.get("anyOf", [])]
    return [entry["$ref"].rpartition("/")[2] for entry in found if "$ref" in entry]


def _kind(schema: dict[str, Any]) -> str:
    kind = schema["properties"].get("kind", {})
    return str(kind.get("const", kind.get("default", schema.get("title", ""))))


def _default(value: Any) -> str:
    if value is None:
        return NOT_GIVEN
    if isinstance(value, dict):
        if "kind" not in value and "name" not in value:
            return "see below"
        given = {key: entry for key, entry in value.items() if entry is not None}
        name = str(given.get("name", given.get("kind")))
        return f"`{json.dumps(name)}`"
    if isinstance(value, float):
        return f"`{value:g}`"
    return f"`{json.dumps(value)}`"


def _bounds(field: dict[str, Any]) -> str:
    """Say what values a field may have."""
    if "enum" in field:
        return ", ".join(f"`{json.dumps(value)}`" for value in field["enum"])
    if "const" in field:
        return f"`{json.dumps(field['const'])}`"
    texts = [_interval(entry) for entry in (field, *field.get("anyOf", []))]
    if "minItems" in field or "maxItems" in field:
        low, high = field.get("minItems", 0), field.get("maxItems", "more")
        texts.append(f"{low} entries" if low == high else f"{low} to {high} entries")
    if field.get("type") == "boolean":
        texts.append("`true`, `false`")
    return "; ".join(dict.fromkeys(text for text in texts if text))


def _interval(entry: dict[str, Any]) -> str:
    signs = {"minimum": "≥", "exclusiveMinimum": ">", "maximum": "≤", "exclusiveMaximum": "<"}
    return ", ".join(f"{sign} {_number(entry[key])}" for key, sign in signs.items() if key in entry)


def _number(value: float) -> str:
    return str(value) if isinstance(value, int) else f"{value:g}"


def _sentence(text: str) -> str:
    first = text.strip().partition("\n\n")[0].replace("\n", " ")
    word = first.partition(" ")[0]
    if word[1:].islower() or len(word) == 1:
        first = first[:1].upper() + first[1:]
    return first + ("" if first.endswith(".") or not first else ".")


def _escaped(text: str) -> str:
    return text.replace("|", "\\|").replace("[", "\\[")
