"""Moving pictures of a tow."""

import argparse

import numpy as np
import pytest
from PIL import Image

from insonify.cli import main
from insonify.scene import SceneError
from insonify_viewer.commands import _size
from insonify_viewer.movie import RATE, View, draw_views, tow_views, write_movie

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


def test_a_video_is_written_where_the_package_is(tmp_path):
    pytest.importorskip("imageio_ffmpeg")
    write_movie(tmp_path / "tow.mp4", (np.full((320, 480, 3), grey, np.uint8) for grey in (0, 100, 200)))
    assert (tmp_path / "tow.mp4").read_bytes()[4:8] == b"ftyp"


def test_views_end_at_the_last_ping(small):
    views = tow_views(small, 2.0)
    assert len(views) == 2 * RATE
    assert views[-1] == View(small.track.pings - 1)


@pytest.mark.parametrize("given", ["7x7", "761x420", "760", "760x", "x420", "99999x420", "-760x420"])
def test_a_size_that_no_video_has_is_refused(given):
    with pytest.raises(argparse.ArgumentTypeError, match=given):
        _size(given)


def test_other_endings_are_refused_before_the_work(tmp_path, capsys):
    assert main(["movie", "default", "-o", str(tmp_path / "tow.png")]) == 2
    assert ".webp or .gif or .mp4" in capsys.readouterr().err


def test_what_memory_cannot_hold_is_refused_before_the_work(tmp_path, capsys):
    words = ["movie", "default", "--seconds", "300", "--size", "1280x720"]
    assert main([*words, "-o", str(tmp_path / "tow.webp")]) == 2
    told = capsys.readouterr().err
    assert "write .mp4, or at most --seconds 60" in told
    assert not list(tmp_path.iterdir())


def test_a_change_that_no_scene_can_have_is_an_error(qapp, small):
    with pytest.raises(SceneError, match="altitude"):
        list(draw_views(small, SIZE, [View(10, {"track.altitude": -3.0})]))
