"""The references of the command line and of the public Python names, and the list of how-to pages."""

from __future__ import annotations

import argparse
import inspect
import re
from pathlib import Path

import insonify
from insonify.cli import build_parser

DOCS = Path(__file__).resolve().parents[1]
COMMAND_HEAD = """# Command line

<!-- Made by `python docs/make` from the parsers in `insonify.commands`. Edit those. -->

`insonify [SCENE]` without a command opens the viewer. Under uv, put `uv run` before each command. A mistake in a scene
file, an option or an input file is answered by one sentence that names the field, the value and the remedy; the exit
code is then 2.

"""
PYTHON_HEAD = """# Python

<!-- Made by `python docs/make` from `insonify.__all__`. -->

The public names of the package `insonify`. Each is imported on first use, so `import insonify` is quick. The
[tutorial](../tutorial/python.md) shows them at work. The pages under *Packages* list every module.

"""
HOWTO_HEAD = """# How to

Each page answers one question. The [reference](../reference/cli.md) lists every option and every
[scene field](../reference/scene.md).

"""
HOWTO_TABLE = "## {group}\n\n| page | what it shows |\n|---|---|\n{rows}\n"


def command_page() -> str:
    """Return the page of the command line."""
    _, commands = build_parser()
    rows = [f"| [`insonify {name}`](#insonify-{name}) | {_help(parser)} |" for name, parser in commands.items()]
    sections = [_command(name, parser) for name, parser in commands.items()]
    return COMMAND_HEAD + "\n".join(["| command | purpose |", "|---|---|", *rows, "", *sections])


def _help(parser: argparse.ArgumentParser) -> str:
    return _sentence((parser.description or "").partition("\n\n")[0])


def _command(name: str, parser: argparse.ArgumentParser) -> str:
    """Describe one command and its arguments."""
    actions: list[argparse.Action] = []
    for action in parser._actions:
        if isinstance(action, argparse._SubParsersAction):
            actions += [_branch(each, action.choices[each.dest]) for each in action._choices_actions]
        elif not isinstance(action, argparse._HelpAction):
            actions.append(action)
    rows = [f"| {_spelling(action)} | {_default(action)} | {_meaning(action)} |" for action in actions]
    epilog = [parser.epilog.replace("%(prog)s", parser.prog), ""] if parser.epilog else []
    table = ["| argument | default | meaning |", "|---|---|---|", *rows, ""]
    return "\n".join([f"## insonify {name}", "", _help(parser), "", *table, *epilog])


def _branch(named: argparse.Action, parser: argparse.ArgumentParser) -> argparse.Action:
    """Describe a sub-command as one argument, with the arguments that follow it."""
    follow = [str(action.metavar) for action in parser._actions if not action.option_strings]
    return argparse.Action([], named.dest, nargs="*", metavar=" ".join([named.dest, *follow]), help=named.help)


def _spelling(action: argparse.Action) -> str:
    value = action.metavar or (f"{{{','.join(map(str, action.choices))}}}" if action.choices else action.dest.upper())
    values = " ".join(value) if isinstance(value, tuple) else value
    if not action.option_strings:
        return f"`{values}`"
    takes = "" if action.nargs == 0 else f" {values}"
    return ", ".join(f"`{option}{takes}`" for option in action.option_strings).replace("|", "\\|")


def _default(action: argparse.Action) -> str:
    if action.required and action.nargs not in ("*", "?"):
        return "required"
    return "" if action.default in (None, False, [], argparse.SUPPRESS) else f"`{action.default}`"


def _meaning(action: argparse.Action) -> str:
    choices = ", ".join(map(str, action.choices)) if action.choices else ""
    text = (action.help or "") % {**vars(action), "choices": choices}
    text = re.sub(r" \(default: [^)]*\)", "", text)
    return _sentence(text).replace("|", "\\|")


def _sentence(text: str) -> str:
    text = " ".join(text.split())
    return text[:1].upper() + text[1:] + ("" if text.endswith(".") or not text else ".")


def python_page() -> str:
    """Return the page of the public Python names."""
    entries = []
    for name in sorted(insonify.__all__, key=str.lower):
        first = _sentence((inspect.getdoc(getattr(insonify, name)) or "").partition("\n")[0])
        entries.append((f"insonify.{name}", first))
    table = [f"| [`{path}`][{path}] | {first} |" for path, first in entries]
    blocks = [f"::: {path}\n    options:\n      heading_level: 2\n" for path, _ in entries]
    return PYTHON_HEAD + "\n".join(["| name | purpose |", "|---|---|", *table, "", *blocks])


def howto_page() -> str:
    """Return the list of how-to pages in the groups of the navigation: title and first sentences of each."""
    _, _, rest = (DOCS.parent / "mkdocs.yml").read_text(encoding="utf-8").partition("howto/index.md\n")
    groups, _, _ = rest.partition("\n  - ")
    tables = []
    for group, pages in re.findall(r"^ {6}- (.+):\n((?: {10}.*\n?)+)", groups, re.MULTILINE):
        rows = []
        for path in re.findall(r"[\w/-]+\.md", pages):
            title, _, body = (DOCS / path).read_text(encoding="utf-8").partition("\n\n")
            first = " ".join(body.partition("\n\n")[0].split())
            place = Path(path).name if path.startswith("howto/") else f"../{path}"
            rows.append(f"| [{title.removeprefix('# ')}]({place}) | {first} |")
        tables.append(HOWTO_TABLE.format(group=group, rows="\n".join(rows)))
    return HOWTO_HEAD + "\n".join(tables)
