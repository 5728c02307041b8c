"""Chips of data sets: nested draws, sampling in bins, display, and checks before the first job."""

import json
import math
import re
import time
from functools import partial
from pathlib import Path

import numpy as np
import pytest
from PIL import Image, ImageDraw

from commands import refused
from insonify import cli
from insonify.scene import SceneError, load_scene
from insonify.simulation import simulate
from insonify.surveys.datasets import chips
from insonify.surveys.datasets.chips import _displayed, _edges, _finish, _grey, _means, cut_chips
from insonify.surveys.datasets.scenes import Draws, check_draws, draw_scene
from insonify.surveys.datasets.specification import Chips, DatasetSpecification, Picture, Sampling
from insonify.surveys.datasets.tiles import FIRST_CLASS, SHADOW
from insonify.surveys.specification import read_specification
from small_sets import SET, data_set, run_here

BASE = load_scene("default")
CHIPS = """
title = "Wrecks"
scenes = 3
negatives = 0.3
chips_each = 2
tolerance = 0.2
[set]
targets = []
"seabed.relief" = { draw = "choice", of = [
    { kind = "fractal", beta = 1.6, rms = { draw = "uniform", low = 0.1, high = 0.5 }, period = 128.0 },
    { kind = "sum", of = [{ kind = "ripples", wavelength = { draw = "uniform", low = 8.0, high = 20.0 } }] },
] }
"sonar.bins" = 192
"track.pings" = 160
[sampling]
length = { draw = "uniform", low = 40.0, high = 60.0 }
step = { draw = "uniform", low = 1.0, high = 1.5 }
altitude = 0.2
pulse = 1.5
beam = 1.2
node = 2.0
relief = true
snr = 25.0
[[targets]]
name = "wreck"
of = [{ kind = "wreck", form = { draw = "choice", of = ["tug", "barge"] } }]
along = 0.5
[targets.set]
length = { draw = "uniform", low = 10.0, high = 60.0 }
heading = { draw = "uniform", low = -180.0, high = 180.0 }
[chips]
pixels = 48
margin = 1.5
turns = { draw = "integers", low = 0, high = 3 }
[picture]
scale = { draw = "choice", of = ["linear", "root", "log"] }
ground_range = { draw = "choice", of = [true, false] }
"""


specification = partial(data_set, CHIPS)


def test_draws_reach_into_choices_and_tables_and_those_of_a_chip_depend_on_its_name_alone():
    drawn = [draw_scene(specification(), BASE, number).scene for number in range(24)]
    reliefs = [scene.seabed.relief for scene in drawn]
    assert len({relief.of[0].wavelength for relief in reliefs if relief.kind == "sum"}) > 5
    assert len({relief.rms for relief in reliefs if relief.kind == "fractal"}) > 5
    assert {target.form for scene in drawn for target in scene.targets} == {"tug", "barge"}
    one, other, chip = Draws(1, 2), Draws(1, 2), (Chips, "chips.0", specification().chips)
    other.value("else", 1.0)
    assert one.table(*chip) == other.table(*chip)


def test_a_scene_is_sampled_as_declared():
    for number in range(12):
        drawn = draw_scene(specification(negatives=0.0), BASE, number)
        scene, bin_length = drawn.scene, drawn.scene.sonar.range / 192
        step, length = scene.track.speed / scene.sonar.ping_rate, 2.0 * scene.targets[0].outline.half[0]
        assert length / bin_length == pytest.approx(drawn.draws.drawn["sampling.length"], 1e-6)
        assert step / bin_length == pytest.approx(drawn.draws.drawn["sampling.step"])
        assert scene.altitude == pytest.approx(0.2 * scene.sonar.range)
        assert 750.0 * scene.sonar.pulse.duration == pytest.approx(1.5 * bin_length)
        half = math.radians(scene.sonar.beam.width)
        assert math.tan(half) * 0.5 * scene.sonar.range == pytest.approx(1.2 * step)
        assert scene.seabed.spacing == pytest.approx(2.0 * bin_length)
        periods = [part.period for part in getattr(scene.seabed.relief, "of", [scene.seabed.relief])]
        assert periods in (pytest.approx([128.0 * bin_length]), pytest.approx([102.4 * bin_length]))
        assert scene.sonar.ping_rate <= 750.0 / scene.sonar.range


def test_every_class_has_its_beds():
    with_, without = (draw_scene(specification(negatives=share), BASE, 4) for share in (0.0, 1.0))
    assert not without.scene.targets
    assert without.scene.seabed == with_.scene.seabed
    assert without.views == tuple(view._replace(target=None) for view in with_.views)


def test_a_chip_shows_its_target_where_the_scene_has_it():
    wanted = specification(negatives=0.0, picture={"ground_range": True}, chips={"pixels": 64, "margin": 2.0})
    drawn = draw_scene(wanted, BASE, 1)
    tiles = list(cut_chips(drawn, simulate(drawn.scene, truth=True, tolerance=0.2), wanted))
    assert [tile.description["class"] for tile in tiles] == ["wreck", "wreck", None, None]
    for tile in tiles[:2]:
        rows, columns = np.nonzero(tile.mask == FIRST_CLASS)
        assert abs(rows.mean() - 31.5) < 10.0
        assert abs(columns.mean() - 31.5) < 12.0
        assert (tile.mask == SHADOW).any()
        x, y, wide, high = tile.description["targets"][0]["echo"]["box"]
        assert (x, y, x + wide, y + high) == (columns.min(), rows.min(), columns.max() + 1, rows.max() + 1)
        assert 16 < max(wide, high) < 52  # a window of twice its length
        bright = tile.image[tile.mask == FIRST_CLASS].mean()
        assert bright > tile.image[tile.mask == SHADOW].mean() + 30
    assert not any((tile.mask >= FIRST_CLASS).any() for tile in tiles[2:])


def test_windows_about_the_extent_have_the_proportions_of_echo_and_shadow():
    chips = {"pixels": 64, "about": "extent", "margin": 1.25, "aspect": 2.0}
    wanted = specification(negatives=0.0, chips_each=1, picture={"scale": "root"}, chips=chips)
    drawn = draw_scene(wanted, BASE, 1)
    record = simulate(drawn.scene, truth=True, tolerance=0.2)
    shown, bed = cut_chips(drawn, record, wanted)
    assert shown.image.shape == bed.image.shape == tuple(shown.description["shape"])
    first, last, near, far = record["target_box"].values[0, drawn.views[0].channel]
    step = drawn.scene.track.speed / drawn.scene.sonar.ping_rate
    size = np.array([(last + 1 - first) * step, (far + 1 - near) * drawn.scene.sonar.range / drawn.scene.sonar.bins])
    sides = (size + 0.25 * size.max()) / (2.0, 1.0)  # a border of one breadth; a pixel spans twice as much along
    assert max(shown.image.shape) == 64
    assert shown.image.shape == pytest.approx(64.0 * sides / sides.max(), abs=0.6)
    x, y, wide, high = shown.description["targets"][0]["both"]["box"]
    assert (high, wide) == pytest.approx(shown.image.shape * size / (size + 0.25 * size.max()), abs=1.5)
    assert (2 * x + wide, 2 * y + high) == pytest.approx(shown.image.shape[::-1], abs=3.0)


def test_ground_range_is_even_and_slant_range_may_begin_past_the_first_returns():
    drawn = draw_scene(specification(negatives=0.0), BASE, 0)
    scene, view = drawn.scene, drawn.views[0]._replace(ground_range=0.0)
    chip, bins, bin_length = Chips(pixels=32, margin=1.0), scene.sonar.bins, scene.sonar.range / scene.sonar.bins
    shape = scene.track.pings, bins
    _, slant = _edges(drawn, view, shape, chip, Picture(water_column=False), None)
    assert slant[0] * bin_length == pytest.approx(chips.PAST_NADIR * scene.altitude)
    _, ground = _edges(drawn, view, shape, chip, Picture(ground_range=True), None)
    ranges = np.sqrt(np.maximum((ground * bin_length) ** 2 - scene.altitude**2, 0.0))
    assert np.diff(ranges, 2) == pytest.approx(0.0, abs=1e-5)
    assert np.ptp(ranges) == pytest.approx(view.length)


def test_coarser_pictures_are_smoother_and_means_between_edges_keep_the_sum_and_interpolate_lines():
    noise = np.random.default_rng(2).rayleigh(1.0, (64, 64))
    edges = (np.linspace(0.0, 64.0, 65),) * 2
    fine, along = (_displayed(noise, edges, Picture(along=a)) for a in (1.0, 4.0))
    assert fine == pytest.approx(noise)
    assert along.std() < 0.6 * fine.std()
    steps = [np.abs(np.diff(along, axis=axis)).mean() for axis in (0, 1)]
    assert steps[0] < 0.4 * steps[1]
    values = np.random.default_rng(1).random((40, 3))
    assert _means(values, np.linspace(0.0, 40.0, 11), 0).sum() * 4.0 == pytest.approx(values.sum())
    line = np.arange(20.0)[:, None] + 0.5
    fine = _means(line, np.linspace(4.0, 12.0, 65), 0)[:, 0]
    assert fine == pytest.approx(np.linspace(4.0, 12.0, 65)[:-1] + 0.0625)


@pytest.mark.parametrize("scale", ["linear", "root", "log"])
def test_greys_keep_their_order_and_median_and_invert(scale):
    amplitude = np.random.default_rng(3).rayleigh(1.0, (50, 50))
    grey = _grey(amplitude, Picture(scale=scale, grey=0.3))
    order = np.argsort(amplitude, axis=None)
    assert (np.diff(grey.ravel()[order].astype(int)) >= 0).all()
    assert np.median(grey) == pytest.approx(0.3 * 255, abs=2)
    assert 0.01 <= np.mean(grey == 0) < 0.03  # the percentile that is black, and what rounds to it
    assert np.array_equal(_grey(amplitude, Picture(scale=scale, grey=0.3, inverted=True)), 255 - grey)
    faint = _grey(amplitude, Picture(scale=scale, darkest=0.2, brightest=0.6))
    assert (faint.min(), faint.max()) == (51, 153)


def test_a_gain_keeps_the_shape_of_the_distribution_up_to_its_knee():
    amplitude = np.random.default_rng(3).rayleigh(1.0, (200, 200))
    grey = _grey(amplitude, Picture(scale="linear", black=0.0, grey=0.3, tone="gain", knee=0.6)) / 255.0
    linear = 0.3 * amplitude / np.median(amplitude)
    low = linear < 0.6
    assert grey[low] == pytest.approx(linear[low], abs=0.005)
    assert grey[~low] == pytest.approx(np.minimum(0.6 + chips.SATURATED * (linear[~low] - 0.6), 1.0), abs=0.005)


def test_nearest_samples_keep_the_scatter_of_speckle_and_repeat():
    noise = np.random.default_rng(2).rayleigh(1.0, (60, 60))
    coarse = _displayed(noise, (np.linspace(0.0, 60.0, 31),) * 2, Picture(samples="nearest"))
    assert np.array_equal(coarse, noise[1::2, 1::2])
    fine = _displayed(noise, (np.linspace(0.0, 30.0, 61), np.linspace(0.0, 60.0, 61)), Picture(samples="nearest"))
    assert np.array_equal(fine[::2], fine[1::2])
    lines = _displayed(noise, (np.linspace(0.0, 60.0, 61),) * 2, Picture(samples="nearest", along=2.0))
    assert np.array_equal(lines[::2], lines[1::2])


def test_speckle_correlates_along_the_tow_over_the_length_that_is_given():
    wanted = {"bin": 0.1, "step": 1.0, "beam": 2.0}
    for grain in (1.0, 3.0):
        changes = Sampling(**wanted, grain=grain).changes(BASE, None)
        width = math.radians(changes["sonar.beam"]["width"])
        wavelength = 1500.0 / changes["sonar.frequency"]
        assert wavelength / (2.0 * width) == pytest.approx(0.1 * grain)


def test_jpeg_and_lines_change_a_picture_as_they_are_asked_to():
    image = np.random.default_rng(4).integers(0, 200, (64, 64)).astype(np.uint8)
    assert np.array_equal(_finish(image, Picture(), 0.0, 64.0), image)
    errors = [np.abs(_finish(image, Picture(jpeg=q), 0.0, 64.0).astype(int) - image).mean() for q in (20, 90)]
    assert errors[0] > 2.0 * errors[1] > 0.0


@pytest.mark.parametrize(
    ("lines", "near", "far", "places", "caption"),
    [
        (2, 0.0, 160.0, [0, 50, 100, 150], "50 m"),
        (2, 37.0, 53.0, [40, 45, 50], "5 m"),
        (1, 8.2, 12.9, [10, 12], "2 m"),
        (3, 0.31, 0.95, [0.4, 0.6, 0.8], "0.2 m"),
        (5, 100.0, 100.5, [100.0, 100.1, 100.2, 100.3, 100.4], "0.1 m"),
        (8, 0.0, 1700.0, [200.0 * number for number in range(9)], "200 m"),
    ],
)
def test_scale_lines_stand_at_round_distances_and_their_caption_is_their_spacing(
    monkeypatch, lines, near, far, places, caption
):
    written = []
    monkeypatch.setattr(ImageDraw.ImageDraw, "text", lambda draw, place, text, **_: written.append(text))
    ruled = _finish(np.zeros((32, 160), np.uint8), Picture(lines=lines), near, far)
    assert written == [caption]
    at = np.flatnonzero((ruled == 255).all(axis=0))
    assert at == pytest.approx((np.array(places) - near) / (far - near) * 160.0, abs=1.0)
    assert len(at) >= lines


def test_scale_lines_of_a_chip_measure_its_window(monkeypatch):
    spans, finish = [], chips._finish
    monkeypatch.setattr(chips, "_finish", lambda *given: (spans.append(given[2:]), finish(*given))[1])
    for ground_range in (True, False):
        wanted = specification(
            negatives=0.0, picture={"ground_range": ground_range}, chips={"margin": 1.2}, chips_each=1
        )
        drawn = draw_scene(wanted, BASE, 1)
        list(cut_chips(drawn, simulate(drawn.scene, truth="targets", tolerance=0.2), wanted))
        assert [far - near for near, far in spans] == pytest.approx([1.2 * drawn.views[0].length] * len(spans))
    assert len(spans) == 4


@pytest.mark.parametrize(
    ("old", "new", "fault"),
    [
        ('"track.pings" = 160', '"track.pingz" = 160', "track.pingz is not a field of a scene"),
        ("wavelength = {", "wavelenth = {", "seabed.relief.of.0.wavelenth is not a field"),
        ("heading = {", "haeding = {", "targets.wreck.haeding is not a field"),
        ("pixels = 48", "pixles = 48", "pixles: no such field"),
        ("pixels = 48", "pixels = 4", "chips.pixels"),
        ('"log"] }', '"cubic"] }', "picture.scale"),
        ("altitude = 0.2", 'altitude = { draw = "uniform", low = 2.0, high = 3.0 }', "sampling.altitude"),
    ],
)
def test_a_mistake_is_told_before_the_first_job(tmp_path, capsys, old, new, fault):
    assert old in CHIPS
    path = tmp_path / "set.toml"
    path.write_text(CHIPS.replace(old, new))
    begun = time.perf_counter()
    complaint = refused(capsys, "dataset", str(path), "-o", str(tmp_path / "set"))
    assert time.perf_counter() - begun < 10.0
    assert fault in complaint
    assert not (tmp_path / "set").exists()


def test_what_some_values_alone_make_impossible_is_left_to_the_jobs():
    check_draws(data_set(SET.replace("low = 5.0, high = 7.0", "low = 6.0, high = 40.0")), BASE)
    with pytest.raises(SceneError, match="ground range"):
        check_draws(data_set(SET.replace("low = 5.0, high = 7.0", "low = 23.0, high = 23.9"), negatives=0.0), BASE)


def test_a_specification_like_another_joins_its_tables(tmp_path, capsys):
    (tmp_path / "old.toml").write_text(CHIPS)
    group = '[[targets]]\nname = "{}"\nof = ["drum"]\nweight = {}\n'
    text = 'like = "old.toml"\ngroups = "one"\nnegatives = 0.0\n[chips]\npixels = 32\n'
    (tmp_path / "new.toml").write_text(text + group.format("drum", 3.0) + group.format("barrel", 1.0))
    paths = (str(tmp_path / name) for name in ("old.toml", "new.toml"))
    old, new = (read_specification(path, DatasetSpecification, "datasets") for path in paths)
    assert (old.chips["pixels"], new.chips["pixels"], new.chips["margin"]) == (48, 32, 1.5)
    assert (new.classes, new.sampling, new.title) == (["drum", "barrel"], old.sampling, old.title)
    drawn = [list(draw_scene(new, BASE, number).classes.values()) for number in range(40)]
    assert all(len(classes) == 1 for classes in drawn)
    assert 24 <= drawn.count(["drum"]) <= 36
    (tmp_path / "old.toml").write_text('like = "new.toml"')
    assert "refers to itself" in refused(capsys, "dataset", str(tmp_path / "old.toml"), "-o", str(tmp_path / "set"))


def test_a_set_of_chips_and_a_preview_of_it_are_made_by_the_command(tmp_path):
    path, folder, sheet = (tmp_path / name for name in ("set.toml", "set", "sheet.png"))
    path.write_text(CHIPS)
    assert cli.main(["dataset", str(path), "-o", str(sheet), "--preview", "2"]) == 0
    with Image.open(sheet) as picture:
        assert picture.size[0] > 1000
    assert {entry.name for entry in tmp_path.iterdir()} == {"set.toml", "sheet.png"}
    assert run_here("dataset", str(path), "-o", str(folder)) == 0
    lines = [json.loads(line) for line in (folder / "metadata.jsonl").read_text().splitlines()]
    assert {line["class"] for line in lines} == {"wreck", None}
    for line in lines:
        with Image.open(folder / line["file_name"]) as picture:
            assert picture.size == (48, 48)
    assert len({line["drawn"]["sampling.length"] for line in lines}) == 3


@pytest.mark.parametrize("library", ["sklearn", "torch", "keras"])
def test_loaders_of_the_documentation_load_a_set(tmp_path, library):
    pytest.importorskip(library)
    text = Path(__file__).parents[3].joinpath("docs/howto/data-sets.md").read_text(encoding="utf-8")
    blocks = dict(re.findall(r'```py title="(.+?)"\n(.+?)```', text, re.DOTALL))
    lines = []
    for number, (split, shows) in enumerate([("train", "ship"), ("train", None), ("test", "ship")]):
        Image.new("L", (20, 30 + number), 51).save(tmp_path / f"{number}.png")
        lines.append(json.dumps({"file_name": f"{number}.png", "split": split, "class": shows}))
    (tmp_path / "metadata.jsonl").write_text("\n".join(lines))
    loaders = {}
    exec(blocks["scikit-learn"], loaders)
    images, numbers = loaders["load"](tmp_path, "train", ["ship"])
    assert images.shape == (2, 64, 64)
    assert images == pytest.approx(0.2)
    assert list(numbers) == [1, 0]
    if library == "torch":
        exec(blocks["PyTorch"], loaders)
        image, number = loaders["Chips"](tmp_path, "train", ["ship"])[0]
        assert (tuple(image.shape), int(number)) == ((1, 64, 64), 1)
    if library == "keras":
        exec(blocks["Keras"], loaders)
        assert loaders["Batches"](tmp_path, "train", ["ship"])[0][0].shape == (2, 64, 64, 1)
