"""Nothing is written that another system could not take, and text is the same on all of them."""

import ast
import os
import sys
from pathlib import Path

import pytest

from commands import refused, run_python
from insonify import operating_system
from insonify.commands.options import check_output
from insonify.io.atomic import write_text
from insonify.operating_system import is_portable
from insonify.scene import SceneError
from small_sets import SET

ROOT = Path(__file__).parents[2]
CHECKS = ROOT / "tests" / "imitated" / "checks.py"
MODES, OPENERS = {"r", "w", "a", "x", "w+"}, ("open", "fdopen", "TemporaryFile")
OTHERS = ("archive", "rasterio", "tarfile", "RECORDS")  # what these open is no text


def opened_texts(tree: ast.Module):
    """Calls that open text: line, whether it is written, and the names of arguments."""
    for node in ast.walk(tree):
        called = getattr(node, "func", None)
        name = getattr(called, "attr", getattr(called, "id", None))
        if name not in (*OPENERS, "read_text", "write_text"):
            continue
        owner = ast.unparse(called.value) if isinstance(called, ast.Attribute) else ""
        opens = name in OPENERS and owner not in OTHERS
        given = [argument.value for argument in node.args if isinstance(argument, ast.Constant)]
        mode = next((mode for mode in given if opens and mode in MODES), None)
        if mode or (owner and name in ("read_text", "write_text")):
            yield node.lineno, name == "write_text" or mode not in (None, "r"), {each.arg for each in node.keywords}


def test_text_is_utf8_with_the_same_ends_of_lines_on_every_system_and_is_written_as_it_is(tmp_path):
    faults = [
        f"{path.relative_to(ROOT)}:{line}"
        for path in [*(ROOT / "core").rglob("*.py"), *(ROOT / "app").rglob("*.py")]
        for line, is_written, named in opened_texts(ast.parse(path.read_text(encoding="utf-8")))
        if "encoding" not in named or (is_written and "newline" not in named)
    ]
    assert faults == []
    write_text(tmp_path / "text", "α\nβ\r\n")
    assert (tmp_path / "text").read_bytes() == "α\nβ\r\n".encode()


@pytest.mark.parametrize(
    ("splits", "fault"),
    [("{ con = 1.0 }", "takes for a device"), ("{ train = 1.0, Train = 1.0 }", "differ in the case of letters alone"),
     ("{ Jobs = 1.0 }", "may not be named 'jobs'")],
)  # fmt: skip
def test_a_split_is_a_folder_on_every_system(splits, fault, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    Path("set.toml").write_text(f"splits = {splits}\n{SET}", encoding="utf-8")
    assert fault in refused(capsys, "dataset", "set.toml", "-o", "set")


def test_windows_reserves_names_and_an_output_of_no_possible_name_is_refused_before_the_work(tmp_path, monkeypatch):
    """A colon would write into a stream beside a file, a device would take the picture, and a long path exists not."""
    portable = ["record.nc", "console.png", "α β.png", ".hidden"]
    reserved = ["con.png", "Nul", "com7.a.b", "a:b", "what?.png", "end.", ""]
    assert [*filter(is_portable, portable + reserved)] == portable
    monkeypatch.setattr(operating_system.sys, "platform", "win32")
    long = 220 * "x" + ".png"
    for name, fault in {"a:b.png": "not a name of a file", "aux.png": "not a name of a file", long: "too many"}.items():
        with pytest.raises(SceneError, match=fault):
            check_output(str(tmp_path / name), (".png",))
    assert check_output(str(tmp_path / "record.png"), (".png",)) == tmp_path / "record.png"


@pytest.mark.skipif(sys.platform != "linux", reason="other systems are imitated on Linux")
@pytest.mark.parametrize("system", ["windows", "macos"])
def test_an_imitated_system_lacks_what_it_lacks(system):
    """The plugin under which the quick tests run as on another system."""
    words = ["-m", "pytest", "-q", "-p", "other_systems", "-p", "no:cacheprovider", str(CHECKS)]
    environment = os.environ | {"INSONIFY_SYSTEM": system, "PYTHONPATH": str(ROOT / "tests")}
    code, *told = run_python(*words, cwd=ROOT, env=environment)
    assert code == 0, told
