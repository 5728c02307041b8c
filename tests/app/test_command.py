"""The commands as people run them, without a screen: the window, and moving pictures of a tow."""

import argparse
import os
import sys
from importlib.metadata import version
from types import SimpleNamespace

import numpy as np
import pytest
from PIL import Image

from commands import PATIENCE, refused, run_python
from insonify.cli import main
from insonify.compiler.progress import report_progress
from insonify.scene import SceneError, edit, load_scene
from insonify_viewer import application, commands
from insonify_viewer.commands import _size
from insonify_viewer.movie import RATE, View, draw_views, tow_views, write_movie
from insonify_viewer.state.inspection import Mark
from insonify_viewer.viewer import Viewer

SMALL = ("--set", "track.pings=64", "--set", "sonar.bins=200")


def run(*words: str, cwd, **environment: str) -> tuple[int, str, str]:
    inherited = {k: v for k, v in os.environ.items() if k not in ("DISPLAY", "WAYLAND_DISPLAY", "QT_QPA_PLATFORM")}
    return run_python("-m", "insonify_viewer", *words, cwd=cwd, env=inherited | environment, timeout=PATIENCE)


def test_snapshot_without_a_display(tmp_path):
    code, _, errors = run("default", *SMALL, "--snapshot", "window.png", cwd=tmp_path, QT_QPA_PLATFORM="offscreen")
    assert (code, errors) == (0, "")
    picture = np.asarray(Image.open(tmp_path / "window.png").convert("RGB")).astype(int)
    assert picture.shape == (1000, 1600, 3)
    seabed, record = picture[200:900, 50:600], picture[100:900, 720:1250]
    sand = (seabed[..., 0] > seabed[..., 2] + 20).mean()
    water = (seabed[..., 2] > seabed[..., 0] + 20).mean()
    assert sand > 0.2
    assert water > 0.1
    assert record.std() > 15.0
    assert [p.name for p in tmp_path.iterdir()] == ["window.png"]


def test_a_lesson_begins_in_the_picture(tmp_path, monkeypatch):
    drawn = []
    monkeypatch.setattr(application, "draw_window", lambda *given: drawn.append(given))
    assert main(["view", "--lesson", "target-height", "--snapshot", str(tmp_path / "window.png")]) == 0
    ((scene, _, pin, lesson, recording, *_),) = drawn
    assert (scene.title, pin, lesson.name, recording) == ("A block and its shadow", None, "target-height", "")


def test_a_pinned_pixel_is_explained_in_the_picture(tmp_path, qapp):
    scene = edit(load_scene("pipe-on-bed"), {"track.pings": 64, "sonar.bins": 500})
    for name, pin in (("plain.png", None), ("pinned.png", Mark(40, 1, 330))):
        application.draw_window(scene, tmp_path / name, pin)
    plain, pinned = (np.asarray(Image.open(tmp_path / name).convert("RGB")) for name in ("plain.png", "pinned.png"))
    assert (plain != pinned).any(axis=2)[700:].mean() > 0.05, "the panel stands below"


def test_a_fault_in_a_slot_ends_a_snapshot_at_once(tmp_path, monkeypatch, qapp, small):
    def fail(*_):
        raise ZeroDivisionError("no such row")

    monkeypatch.setattr(Viewer, "_take", fail)
    monkeypatch.setattr(application, "PATIENCE", 3600.0)
    with pytest.raises(SceneError, match=r"ZeroDivisionError: no such row.*bug in insonify$"):
        application.draw_window(small, tmp_path / "window.png")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("compiling", [True, False])
def test_a_snapshot_waits_as_long_as_kernels_are_compiled(compiling, monkeypatch, qapp):
    class Slow(SimpleNamespace):
        """A viewer whose picture is complete after 500 s."""

        @property
        def complete(self):
            self.clock += 100.0
            if compiling:
                report_progress(None)
            return self.clock > 500.0

    viewer = Slow(clock=0.0, failure="", panels=SimpleNamespace(at_rest=True), recordings=SimpleNamespace(failure=""))
    monkeypatch.setattr(application, "time", SimpleNamespace(monotonic=lambda: viewer.clock, sleep=lambda _: None))
    refused = application._wait_for_scene(qapp, viewer, [], 0.1)
    assert refused == ("" if compiling else "no picture after 240 s; try a smaller scene")


@pytest.mark.skipif(sys.platform != "linux", reason="other systems always have a display")
def test_no_display_draws_the_window_and_says_so(tmp_path):
    (tmp_path / "insonify.png").write_text("somebody's")
    code, written, errors = run("figure-4a", *SMALL, cwd=tmp_path)
    assert (code, written, errors.count("\n")) == (3, "", 1)
    assert "there is no display" in errors
    assert (tmp_path / "insonify.png").read_text() == "somebody's"
    assert (tmp_path / "insonify-2.png").stat().st_size > 20_000


def test_mistakes_are_one_sentence_before_any_work(tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for words, part in (
        ("view nowhere", "no such file"),
        ("view default --snapshot w.jpg", "end the name in .png"),
        ("view default --snapshot nowhere/w.png", "no folder"),
        ("view default --set sonar.range=-1", "sonar.range"),
        ("view nowhere.xtf", "does not exist"),
        ("view default --recording pipe.toml", "does not have the suffix of a record"),
        ("view default --pin 5000 port 20", "ping 5000"),
        ("view pipe-span --lesson target-height", "leave out SCENE"),
        ("view --lesson nowhere", "lesson 'nowhere': no such file"),
        ("view default --pin 5 left 20", "side 'left'"),
        ("view default --pin 5 port far", "--pin 5 port far"),
        ("view default --panel sauna --snapshot w.png", "--panel sauna: is not a panel; choose one of"),
        ("movie default -o tow.png", ".webp or .gif or .mp4"),
        ("movie default --seconds 300 --size 1280x720 -o tow.webp", "write .mp4, or at most --seconds 60"),
    ):
        assert part in refused(capsys, *words.split()), words
    for size in ("7x7", "761x420", "760", "760x", "x420", "99999x420", "-760x420"):
        with pytest.raises(argparse.ArgumentTypeError, match=size):
            _size(size)
    assert not list(tmp_path.iterdir())


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="other systems always have a screen")
def test_why_no_window(monkeypatch):
    monkeypatch.delenv("QT_QPA_PLATFORM", raising=False)
    monkeypatch.delenv("WAYLAND_DISPLAY", raising=False)
    assert commands.why_no_window() == ""
    monkeypatch.setattr(commands, "WINDOW_LIBRARIES", (commands.WINDOW_LIBRARIES[0], "libnowhere.so.1"))
    advice = "the system lacks libnowhere.so.1; install it with: apt-get install libegl1"
    assert commands.why_no_window().startswith(advice)
    monkeypatch.setattr(commands, "WINDOW_LIBRARIES", commands.WINDOW_LIBRARIES[:1])
    monkeypatch.setenv("DISPLAY", ":4711")
    assert commands.why_no_window() == "display :4711 does not answer"
    monkeypatch.delenv("DISPLAY")
    assert commands.why_no_window() == "there is no display"


def test_qt_does_not_abort_on_this_python():
    qt = tuple(int(part) for part in version("PySide6-Essentials").split(".")[:2])
    assert sys.version_info >= (3, 12) or qt < (6, 12), "PySide6 6.12 aborts on Python 3.11 and older"


def test_a_recording_is_drawn_beside_the_scene(tmp_path, capsys):
    record, window = str(tmp_path / "record.xtf"), str(tmp_path / "window.png")
    assert main(["render", "default", *SMALL, "-o", record]) == 0
    assert main(["view", "default", *SMALL, "--recording", record, "--snapshot", window]) == 0
    picture = np.asarray(Image.open(tmp_path / "window.png").convert("RGB")).astype(int)
    assert picture[100:700, 400:760].std() > 15.0, "the simulated record"
    assert picture[100:700, 880:1230].std() > 15.0, "the recording"
    (tmp_path / "broken.xtf").write_bytes(b"no recording" * 200)
    capsys.readouterr()
    words = "view", str(tmp_path / "broken.xtf"), "--snapshot", str(tmp_path / "broken.png")
    assert "not an XTF file" in refused(capsys, *words)
    assert not (tmp_path / "broken.png").exists()


SIZE = (760, 420)


def test_the_record_grows_with_the_views_and_follows_changes(qapp, small, tmp_path):
    changed = View(100, {"track.altitude": 20.0})
    pictures = list(draw_views(small, SIZE, [View(30), View(100), changed]))
    assert {picture.shape for picture in pictures} == {(SIZE[1], SIZE[0], 3)}
    record = [picture[40:300, 440:720].astype(int) for picture in pictures]
    filled = [(part[..., 0] > part[..., 2] + 30).mean() for part in record]
    assert filled[1] > 1.5 * filled[0] > 0.0
    assert filled[2] < filled[1], "the water column is wider from twice the altitude"
    for name in ("tow.webp", "tow.gif"):
        write_movie(tmp_path / name, iter(pictures))
        with Image.open(tmp_path / name) as movie:
            assert (movie.n_frames, movie.size) == (3, SIZE)
            assert movie.info["loop"] == 0
    views = tow_views(small, 2.0)
    assert (len(views), views[-1]) == (2 * RATE, View(small.track.pings - 1)), "they end at the last ping"
    with pytest.raises(SceneError, match="altitude"):
        list(draw_views(small, SIZE, [View(10, {"track.altitude": -3.0})]))


def test_a_video_is_written_where_the_package_is(tmp_path):
    pytest.importorskip("imageio_ffmpeg")
    write_movie(tmp_path / "tow.mp4", (np.full((320, 480, 3), grey, np.uint8) for grey in (0, 100, 200)))
    assert (tmp_path / "tow.mp4").read_bytes()[4:8] == b"ftyp"
