"""Sub-commands are found: a file in the package is enough, and installed packages announce theirs."""

import sys
from importlib.metadata import EntryPoint

import pytest

import insonify.commands
from insonify import cli

GREET = '''
"""``insonify greet``: say hello."""

from insonify.commands.options import say


def register(subparsers):
    parser = subparsers.add_parser("greet", help="say hello")
    parser.add_argument("name")
    parser.set_defaults(run=run)


def run(arguments):
    say(f"hello {arguments.name}")
    return 0
'''


@pytest.fixture
def folder(tmp_path, monkeypatch):
    yield tmp_path
    for module in [name for name in sys.modules if name.endswith("greet")]:
        monkeypatch.delitem(sys.modules, module)


def test_one_new_file_adds_a_sub_command(folder, monkeypatch, capsys):
    (folder / "greet.py").write_text(GREET)
    monkeypatch.setattr(insonify.commands, "__path__", [*insonify.commands.__path__, str(folder)])
    assert cli.main(["greet", "world"]) == 0
    assert capsys.readouterr().out == "hello world\n"


def test_an_installed_package_adds_a_sub_command(folder, monkeypatch, capsys):
    (folder / "stranger_greet.py").write_text(GREET)
    monkeypatch.syspath_prepend(folder)
    entries = [EntryPoint("greet", "stranger_greet:register", cli.COMMANDS)]
    monkeypatch.setattr(cli, "announced", lambda group: entries)
    assert cli.main(["greet", "world"]) == 0
    assert capsys.readouterr().out == "hello world\n"


def test_a_package_that_cannot_be_loaded_stops_no_other_command(monkeypatch, capsys):
    entries = [EntryPoint("greet", "no_such_package:register", cli.COMMANDS)]
    monkeypatch.setattr(cli, "announced", lambda group: entries)
    assert cli.main(["scenes"]) == 0
    written = capsys.readouterr()
    assert written.out.startswith("breaks-beats")
    assert written.err == (
        "insonify: the command 'greet' of no_such_package cannot be loaded (No module named 'no_such_package')\n"
    )


def test_every_module_of_a_command_is_named_after_it():
    commands = cli.build_parser()[1]
    modules = {module.__name__.rpartition(".")[2] for module in cli.modules_in(cli.COMMANDS)}
    assert modules - set(commands) == {"options"}
