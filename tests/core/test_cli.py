"""The command: exit codes, one sentence for every mistake, no half-written file."""

import os
import subprocess
import sys
from pathlib import Path
from unittest.mock import Mock

import numpy as np
import pytest
import xarray as xr
from PIL import Image

from commands import LONG, PATIENCE, refused, run_python
from insonify import __main__ as process
from insonify.cli import main
from insonify.io.records import read_record
from insonify.scene import bundled_scenes, edit, load_scene
from insonify.simulation import simulate

SMALL = ["pipe-span", "--set", "track.pings=3", "--set", "sonar.bins=100"]


@pytest.mark.parametrize(
    ("command", "expected"),
    [
        ("render atlantis -o x.png", "no such file; give a TOML file or one of breaks-beats"),
        (
            "render default -o x.jpg",
            "'.jpg' is not written by this command; end the name in .png or .nc or .npz",
        ),
        ("render default -o x", "'' is not written by this command"),
        ("render default -o nowhere/x.png", "there is no folder 'nowhere'; create it"),
        ("render default -o .", "is a folder; give the name of a file in it"),
        (f"render default -o {os.devnull}", "is a device, not a file; give another name"),
        ("render default -o x.nc --gain 3", "--gain applies to pictures, not to x.nc"),
        ("render default -o x.npz --ground-range", "--ground-range applies to pictures"),
        ("render default -o x.png --palette jet", "invalid choice: 'jet'"),
        ("render default -o x.png --gain nan", "give decibels from -200 to 200"),
        ("render default -o x.png --gain loud", "'loud' is not a number; give a plain number"),
        ("render default -o x.png --tolerance 0", "give a number above 0"),
        ("render default -o x.png --method magic", "invalid choice: 'magic'"),
        ("render default -o x.png --set sonar.range=-1", "sonar.range: -1 is out of bounds; give a value above 0 m"),
        ("render default -o x.png --set sonar.range", "write for example sonar.range=75"),
        ("render default -o x.png --seed -4", "seed: -4 is out of bounds"),
        ("render default -o x.png --seed two", "seed: 'two' is not a whole number"),
        ("render default", "arguments are required: -o/--output"),
        ("plan default --set sonar.beam=laser", "choose one of knife, fan"),
        ("render default -o x.nc --threads 0", "'0' is not a number of threads; give a whole number from 1"),
        ("plan default --model planes", "write SUBJECT=CHOICE, such as planes=16"),
        ("plan default --model plane=4", "'plane' is not a choice of a plan; choose one of method, planes"),
        ("chart -o x.pdf", "'.pdf' is not written by this command; end the name in .png or .svg or .csv or .json"),
        ("relief default -o x.nc", "end the name in .png"),
        ("render default -o x.xtf --truth", "--truth applies to .nc, .npz, .zarr, not to x.xtf"),
        ("render default -o x.png --truth", "leave it out or end the name in one of them"),
        ("render default -o x.xtf --error", "--error applies to .nc, .npz, .zarr, not to x.xtf"),
        ("rendre default", "did you mean 'insonify render'?"),
        ("describe a.png", "'describe' is neither a command nor a scene; 'insonify --help' lists the commands"),
        ("info a.png", "a.png: is no cast or navigation by its suffix; give a file that ends in one of"),
        ("info nowhere.cnv", "'nowhere.cnv' does not exist"),
        ("info nowhere.csv", "'nowhere.csv' does not exist, and track.motion.path: 'nowhere.csv' does not exist; give"),
        ("plan defualt", "scene 'defualt': no such file; did you mean 'default'? Otherwise give a TOML file"),
        (f"plan default --set seed={'9' * 5000}", "seed: '999"),
        (f"plan default --set targets.{'9' * 5000}.radius=1", "the list has 3, numbered from 0"),
        ("plan default --set track.speed=3furlongs", "track.speed: '3furlongs' is not a number"),
        ("plan default --set sonar.beam.taper=cosine", "it belongs to kind 'array', not to 'fan'"),
        *((f"{words}atlantis", "no such file") for words in ("view ", "scenes ", "")),
        ("compare atlantis default -o x.png", "no such file"),
        ("compare a.xtf default -o x.png", "does not exist"),
        ("compare a.nc default -o x.png", "does not exist; give the path of a record"),
        ("compare default default -o x.nc", "end the name in .png"),
        ("light nowhere -o x.png", "no such file"),
        ("light default -o x.jpg", ".png"),
        ("light default -o x.png --set sonar.range=-1", "sonar.range"),
        ("explain default --ping 1 --range 1e4", "range 10000 m"),
        ("explain default --ping 9999 --range 20", "ping 9999"),
        ("rays default -o x.csv --target 30 60", "target"),
        ("lesson check nowhere.md", "lesson 'nowhere.md': no such file; give a Markdown file"),
        ("lesson check apertur", "lesson 'apertur': no such file; did you mean 'aperture'? Otherwise give a"),
        ("dataset minez -o m", "specification 'minez': no such file; did you mean 'mines'? Otherwise"),
        ("view a.xtf", "a.xtf: does not exist; give the path of a record"),
        ("plan a.xtf", "a.xtf: this is a record, not a scene; draw it with 'insonify render a.xtf"),
        ("chart -o x.png a.xtf", "a.xtf: this is a record, not a scene; draw it with"),
        ("render default -o x.nc --bits 8", "--bits is not an option of .nc files such as x.nc; leave"),
        ("render default -o x.png --frequency 4e5", "--frequency applies to recordings; write --set"),
        ("render default -o x.npz --display gain=3", "--display applies to pictures"),
    ],
)
def test_a_mistake_is_one_sentence(capsys, monkeypatch, tmp_path, command, expected):
    monkeypatch.chdir(tmp_path)
    assert expected in refused(capsys, *command.split())
    assert list(tmp_path.iterdir()) == []


def test_scenes_lists_names_and_titles_and_says_what_some_of_them_show(capsys, tmp_path):
    assert main(["scenes"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert [line.split()[0] for line in lines] == list(bundled_scenes())
    assert load_scene("pipe-span").title in lines[list(bundled_scenes()).index("pipe-span")]
    assert main(["scenes", "figure-2a", "wreck"]) == 0
    said = capsys.readouterr().out
    assert max(map(len, said.splitlines())) <= 96
    for scene in map(load_scene, ("figure-2a", "wreck")):
        assert scene.title in said.splitlines()
        assert scene.about in " ".join(said.split())
    # Escape, bell, an operating-system command, and a mark that turns text to the left give a terminal no commands.
    path = tmp_path / "evil.toml"
    path.write_text('title = "a\\u001b]0;owned\\u0007\\u202eb"\n[track]\npings = 1\n', encoding="utf-8")
    assert main(["scenes", str(path)]) == 0
    assert capsys.readouterr().out == "a]0;ownedb\n"
    record = tmp_path / "a\x1b]0;owned\x07.npz"
    assert main(["render", *SMALL, "-o", str(record)]) == 0
    assert main(["render", *SMALL, "-o", str(record / "b.npz")]) == 2
    said = "".join(capsys.readouterr())
    assert said.count("/a]0;owned.npz") == 2
    assert {"\x1b", "\x07"}.isdisjoint(said)


def test_plan_names_the_method(capsys):
    assert main(["plan", "default"]) == 0
    page = capsys.readouterr().out
    assert [line.split()[0] for line in page.splitlines()[:4]] == ["Tolerance", "Error", "Planes", "Cost"]
    assert page.partition("\nModelled")[2].splitlines()[1].split()[0] == "sweep"
    assert main(["plan", "default", "--method", "rays", "--model", "targets=off", "--set", "track.pings=9"]) == 0
    modelled, left_out = capsys.readouterr().out.partition("\nModelled")[2].split("\nLeft out", 1)
    assert modelled.splitlines()[1].split()[0] == "rays"
    assert left_out.splitlines()[1].split()[:2] == ["3", "targets"]


@pytest.mark.parametrize(("truth", "suffix"), [(False, ".nc"), (True, ".nc"), (True, ".npz"), (True, ".zarr")])
def test_a_file_holds_what_simulate_returns(tmp_path, capsys, suffix, truth):
    path = tmp_path / f"record{suffix}"
    options = ["--truth"] if truth else []
    assert main(["render", *SMALL, "-o", str(path), *options]) == 0
    expected = simulate(edit(load_scene("pipe-span"), {"track.pings": 3, "sonar.bins": 100}), truth=truth)
    read = read_record(path)
    xr.testing.assert_equal(read, expected)
    assert read.attrs.items() >= expected.attrs.items()
    assert read.intensity.dtype == np.float32
    if truth:
        capsys.readouterr()
        assert "--truth" in refused(capsys, "render", str(path), "-o", str(tmp_path / "again.nc"), "--truth")


@pytest.mark.parametrize("options", [[], ["--side", "port"], ["--ground-range", "--palette", "pen", "--gain", "-3"]])
def test_pictures(tmp_path, capsys, options):
    path = tmp_path / "record.png"
    assert main(["render", *SMALL, "-o", str(path), *options]) == 0
    assert str(path) in capsys.readouterr().out
    with Image.open(path) as picture:
        assert min(picture.size) > 400


def test_the_seed_changes_the_bed(tmp_path):
    for seed in ("1", "2"):
        assert main(["relief", "default", "--seed", seed, "-o", str(tmp_path / f"{seed}.png")]) == 0
    a, b = (np.asarray(Image.open(tmp_path / f"{seed}.png")) for seed in "12")
    assert a.shape == b.shape == (1024, 1024)
    assert (a.min(), a.max()) == (0, 255)
    assert (a != b).any()


@pytest.mark.parametrize("protected", ["x.png", "."])
def test_what_is_write_protected_is_left_alone(tmp_path, capsys, monkeypatch, protected):
    monkeypatch.chdir(tmp_path)
    Path("x.png").write_bytes(b"old")
    monkeypatch.setattr(os, "access", lambda path, mode: Path(path) != Path(protected))
    assert f"-o x.png: {protected!r} is write-protected; allow" in refused(capsys, "relief", "default", "-o", "x.png")
    assert Path("x.png").read_bytes() == b"old"


@pytest.mark.skipif(not hasattr(os, "geteuid") or os.geteuid() == 0, reason="root may write anywhere")
def test_a_folder_without_rights_is_a_sentence(tmp_path, capsys):
    tmp_path.chmod(0o500)
    assert str(tmp_path) in refused(capsys, "relief", "default", "-o", str(tmp_path / "x.png"))


def test_without_the_viewer_the_remedy_is_said_and_without_libraries_a_record_written(capsys, monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path)
    run = Mock(__module__="insonify_viewer.commands")
    monkeypatch.setattr("insonify_viewer.commands.run", run)
    run.side_effect = ModuleNotFoundError("No module named 'PySide6'", name="PySide6")
    assert "pip install 'insonify[viewer]'" in refused(capsys, "default")
    run.side_effect = ImportError("libGL.so.1: cannot open shared object file: No such file or directory")
    Path("insonify.png").write_text("somebody's")
    assert main(SMALL) == 3
    message = capsys.readouterr().err
    assert "apt-get install -y libegl1 libgl1" in message
    assert message.count("\n") == 1
    assert Path("insonify.png").read_text() == "somebody's"
    assert Path("insonify-2.png").stat().st_size > 1000


def test_commands_import_no_more_than_they_use(tmp_path):
    """Scenes are listed without any library of windows or arrays, records and pictures made without tables.

    Where Dask is installed xarray imports its arrays, a quarter of a second, to find out whether arrays are in memory:
    datasets are made without them.
    """
    code = (
        "import sys; from insonify.cli import main; code = main(['scenes']);"
        "slow = {'PySide6', 'pyvista', 'vtkmodules', 'numba', 'matplotlib', 'scipy', 'xarray', 'netCDF4'};"
        "loaded = slow & set(sys.modules);"
        "render = lambda *all: any([main(['render', *sys.argv[2:], '-o', sys.argv[1] + suffix]) for suffix in all]);"
        "code = code or render('.png', '.nc', '.npz', '.xtf', '.jsf');"
        "loaded |= {'xarray', 'pandas', 'dask'} & set(sys.modules);"
        "import insonify; from insonify.io.records import read_record; from insonify.scene import edit, load_scene;"
        "scene = edit(load_scene('default'), {'track.pings': 3, 'sonar.bins': 40});"
        "record = insonify.simulate(scene, truth=True); record.intensity.values;"
        "code = code or render('.nc', '.npz', '.xtf');"
        "[read_record(sys.argv[1] + suffix) for suffix in ('.npz', '.xtf')];"
        "loaded |= {'dask.array'} & set(sys.modules);"
        "sys.exit(f'loaded {loaded}' if loaded else code)"
    )
    assert run_python("-c", code, str(tmp_path / "record"), *SMALL)[::2] == (0, "")


def test_help_shows_choices_and_examples(capsys):
    example = "insonify learn recording.xtf -o scene.toml"
    for command, shown in {"render": "--bits {16,8,32,float}", "learn": example}.items():
        with pytest.raises(SystemExit):
            main([command, "--help"])
        assert shown in " ".join(capsys.readouterr().out.split())


@pytest.mark.parametrize(("words", "loaded"), [(("--help",), []), (("plan", "--help"), ["options", "plan"])])
def test_help_loads_only_the_command_that_it_is_about(words, loaded):
    code = (
        "import sys; from insonify.__main__ import load\n"
        "try: load()()\n"
        "finally: print(sorted({*sys.modules} & {'numba', 'numpy', 'pydantic'}));"
        "print([name for name in sorted(sys.modules) if name.startswith(('insonify.commands.', 'insonify_viewer'))])"
    )
    ended, printed, complaint = run_python("-c", code, *words)
    assert (ended, complaint) == (0, "")
    *_, libraries, commands = printed.splitlines()
    assert commands == str([f"insonify.commands.{name}" for name in loaded])
    assert (libraries == "[]") == (not loaded)


def test_the_first_pings_of_a_picture_wait_for_no_library_that_draws_it(tmp_path):
    """Matplotlib and SciPy take longer to import than the pings take to trace."""
    code = (
        "import sys; from pathlib import Path; from insonify.commands.render import write;"
        "from insonify.display.display_options import DisplayOptions; from insonify.scene import edit, load_scene;"
        "loaded = [];"
        "note = lambda block: loaded.extend({'matplotlib', 'scipy.ndimage'} & set(sys.modules)) or block;"
        "track = lambda blocks, pings, count: map(note, blocks);"
        "write(edit(load_scene('default'), {'track.pings': 8}), Path(sys.argv[1]), DisplayOptions(), track=track);"
        "sys.exit(f'loaded {loaded}' if loaded else 0)"
    )
    path = tmp_path / "record.png"
    assert run_python("-c", code, str(path))[::2] == (0, "")
    assert path.stat().st_size > 1000


def test_what_an_encoding_lacks_is_escaped():
    """A plan's costs are in microseconds."""
    encoding = os.environ | {"PYTHONIOENCODING": "ascii", "PYTHONUTF8": "0"}
    code, printed, complaint = run_python("-m", "insonify", "plan", "default", env=encoding)
    assert (code, complaint) == (0, "")
    assert r"\xb5s" in printed


@pytest.mark.parametrize(("words", "code"), [(["scenes"], 0), (["plan", "nowhere"], 2), (["plan", "--nothing"], 2)])
@pytest.mark.parametrize("streams", ["1", "2", "0, 1, 2"])
def test_closed_streams_leave_the_exit_code(streams, words, code):
    closed = f"import os, subprocess, sys; [os.close(k) for k in ({streams},)]; os._exit(subprocess.call(sys.argv[1:]))"
    ended, _, complaint = run_python("-c", closed, sys.executable, "-m", "insonify", *words)
    assert (ended, bool(complaint)) == (code, code == 2 and streams == "1")


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="no device that is always full")
@pytest.mark.parametrize("words", [["scenes"], ["plan", "nowhere"]])
def test_streams_on_a_full_disk_are_told_as_far_as_they_can_be(words):
    with open("/dev/full", "w", encoding="utf-8") as full:
        command = [sys.executable, "-m", "insonify", *words]
        told = subprocess.run(command, stdout=full, stderr=subprocess.PIPE, text=True, check=False)
        silent = subprocess.run(command, stdout=full, stderr=full, check=False)
    assert (told.returncode, silent.returncode) == (2, 2)
    assert told.stderr.count("\n") == 1
    assert told.stderr.startswith("insonify: output: No space" if words == ["scenes"] else "insonify: scene 'nowhere'")


def test_an_interrupt_while_the_command_loads_is_one_sentence(monkeypatch, capsys):
    monkeypatch.setattr(process, "load", Mock(side_effect=KeyboardInterrupt))
    assert process.main() == 130
    assert capsys.readouterr().err == "insonify: interrupted; no file was touched\n"


@pytest.mark.parametrize("code", [0, 2])
def test_a_command_ends_while_a_thread_is_at_work_in_a_library(code):
    """A thread that compiles would go on while the compiler is taken down with the interpreter."""
    driver = f"""
import atexit, sys, threading, time
import insonify.__main__ as process
atexit.register(print, "last words")
threading.Thread(target=time.sleep, args=({LONG},), daemon=True).start()
class Teardown:
    def __del__(self):
        print("taken down")
kept = Teardown()
process.end({code})
"""
    assert run_python("-c", driver, timeout=PATIENCE) == (code, "last words\n", "")


def test_a_reader_that_leaves_is_no_trouble():
    reading, writing = os.pipe()
    os.close(reading)
    command = [sys.executable, "-m", "insonify", "scenes"]
    done = subprocess.run(command, stdout=writing, stderr=subprocess.PIPE, text=True, check=False)
    os.close(writing)
    assert (done.returncode, done.stderr) == (0, "")
