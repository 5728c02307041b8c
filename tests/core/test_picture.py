"""What a picture must be: mirrored about nadir, newest on top, dark where silent; and its options as texts."""

from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from hypothesis import given, settings
from hypothesis import strategies as st
from PIL import Image

from insonify.cli import main
from insonify.display import display_options, normalisation
from insonify.display import sheet as module
from insonify.display.display_options import PALETTES, DisplayOptions, display_settings, read_display, side_factors
from insonify.display.normalisation import LevelBed, estimate_median_curve, extend_to_water_column, normalise
from insonify.display.page import caption_scene, place_decibel_ticks, write_page
from insonify.display.picture import (
    average_columns,
    choose_contrast,
    colour_amplitudes,
    colour_rows,
    compute_column_edges,
    load_palette,
    map_tones,
    mirror_channels,
    place_columns,
)
from insonify.display.range_axis import RangeAxis, make_range_axis
from insonify.display.sheet import SheetPings, resample_rows
from insonify.kernels.display.rows import average_bins
from insonify.scene import SceneError, edit, load_scene
from insonify.simulation import prepare
from level_records import level_record

BINS = 200
REACH = 50.0
ALTITUDE = 10.0


def record(intensity: np.ndarray, altitude: float = ALTITUDE) -> xr.Dataset:
    return level_record(intensity, REACH / intensity.shape[2], altitude, 0.2)


def gather_sheet(blocks, relative, pings, look):
    parts = (
        SheetPings(
            block.intensity.values.swapaxes(0, 1), block.platform_x.values, block.platform_y.values,
            block.platform_altitude.values, 2.0 * float(block.slant_range[0]),
        )
        for block in blocks
    )  # fmt: skip
    return module.gather_sheet(parts, relative, pings, look)


def even(level=1.0, bins: int = BINS):
    """Divide every ping by the same."""
    return lambda intensity, pings: normalise(intensity, np.broadcast_to(level, (len(pings), 1, bins)))


def test_a_flat_and_a_recorded_lambert_bed_are_even_and_the_curve_of_one_is_held_before_the_first_return():
    curve = np.geomspace(1e-2, 1e-9, BINS)
    np.testing.assert_allclose(normalise((0.25 * curve).astype(np.float32), curve), 0.5, rtol=1e-6)  # √ of its albedo
    assert extend_to_water_column(np.array([0.0, 0.0, 1.0, 3.0, 2.0])).tolist() == [3.0, 3.0, 3.0, 3.0, 2.0]
    assert extend_to_water_column(np.zeros(3)).tolist() == [1.0, 1.0, 1.0]
    r = (np.arange(BINS) + 0.5) * REACH / BINS
    altitude = np.linspace(4.0, 12.0, 30)
    gain = 1e6 * np.exp(-r / 20.0)  # whatever the recorder does with range
    bed = gain * (altitude[:, None] / r) ** 2 * (r >= altitude[:, None])
    intensity = np.stack([bed, bed]).astype(np.float32)
    curve = estimate_median_curve(intensity, altitude, REACH / BINS).at(altitude)[:, None]
    shown = normalise(np.moveaxis(intensity, 0, 1), curve)[:, :, 20:-10]
    np.testing.assert_allclose(shown[shown > 0.0], 1.0, atol=0.05)
    assert (shown > 0.0).mean() > 0.7


@pytest.mark.parametrize("altitude", [0.0, 5e-324, 1e-200, 1e-9])
def test_a_recording_of_hardly_any_altitude_or_without_echoes_has_a_curve(altitude):
    level = np.full((2, 3, BINS), 4.0, dtype=np.float32)
    curve = estimate_median_curve(level, np.full(3, altitude), 0.25).at(np.full(3, altitude))[:, None]
    assert (np.isfinite(curve) & (curve > 0.0)).all()
    assert altitude > 0.0 or np.allclose(curve, 4.0, rtol=1e-7)
    np.testing.assert_allclose(normalise(np.moveaxis(level, 0, 1), curve), 1.0, rtol=1e-5)
    silent = estimate_median_curve(0.0 * level, np.full(3, 5.0), 0.25)
    np.testing.assert_array_equal(silent.at(np.full(3, 5.0)), 1.0)


def test_contrast_of_silence_and_of_even_beds_and_strong_materials_and_targets():
    for shape in ((0,), (0, 5), (3, 4)):
        silent = np.zeros(shape, dtype=np.float32)
        assert choose_contrast(silent) == (0.0, 1.0)
        assert (map_tones(silent, choose_contrast(silent)) == 0).all()
    bed = np.full((10, 10), 0.3, dtype=np.float32)
    bed[5, 5] = 0.0
    shown = map_tones(bed, choose_contrast(bed))
    assert shown[5, 5] == 0  # a shadow
    assert 80 < shown[0, 0] < 200
    silt, sand, rock = (np.full(400, level, dtype=np.float32) for level in (0.1, 0.3, 0.7))
    bed = np.concatenate([silt, silt, sand, rock])
    shown = map_tones(bed, choose_contrast(bed))
    assert 0 < shown[0] < shown[900] < shown[-1] < 230
    target = np.full(20, 50.0, dtype=np.float32)
    assert choose_contrast(np.concatenate([silt, target]))[1] < 0.3


def test_port_lies_left_starboard_right_newest_on_top():
    sides = np.zeros((2, 2, 4), dtype=np.float32)
    sides[0, 0, 1] = 1.0  # oldest ping, port, second bin
    sides[1, 1, 3] = 2.0  # newest ping, starboard, last bin
    edges = compute_column_edges(np.full(2, ALTITUDE), RangeAxis("slant", 4, 0.1, 0.4), 4)
    assert mirror_channels(sides, edges).tolist() == [[0, 0, 0, 0, 0, 0, 0, 2], [0, 0, 1, 0, 0, 0, 0, 0]]
    assert mirror_channels(sides, edges, "port").tolist() == [[0, 0, 0, 0], [0, 1, 0, 0]]
    assert mirror_channels(sides, edges, "starboard").tolist() == [[0, 0, 0, 2], [0, 0, 0, 0]]
    # Swapped channels mirror the picture.
    sides = np.random.default_rng(1).random((5, 2, BINS), dtype=np.float32)
    edges = compute_column_edges(np.full(5, ALTITUDE), RangeAxis("slant", BINS, REACH / BINS, REACH), 60)
    np.testing.assert_array_equal(mirror_channels(sides[:, ::-1], edges), mirror_channels(sides, edges)[:, ::-1])


@settings(max_examples=30, deadline=None)
@given(st.integers(1, 40), st.integers(1, 90))
def test_columns_keep_the_mean(bins, columns):
    rows = np.random.default_rng(bins).random((2, bins), dtype=np.float32)
    shown = average_columns(rows, np.broadcast_to(np.linspace(0, bins, columns + 1), (2, columns + 1)))
    np.testing.assert_allclose(shown.mean(axis=1), rows.mean(axis=1), rtol=1e-5)
    assert shown.max() <= rows.max() * (1 + 1e-6)


def test_one_kernel_averages_picked_rows_from_near_to_far_and_edges_that_rows_share_and_drops_no_narrow_echo():
    rng = np.random.default_rng(3)
    rows, picked = rng.random((7, 60), dtype=np.float32), np.array([5, 0, 5, 3])
    edges = np.sort(rng.uniform(0.0, 30.0, (4, 12)), axis=1)
    for bins, held in ((range(29, -1, -1), rows[:, 29::-1]), (range(30, 60), rows[:, 30:])):
        expected = average_columns(np.ascontiguousarray(held[picked]), edges)
        np.testing.assert_array_equal(average_columns(rows, edges, picked=picked, bins=bins), expected)
    rows = np.zeros((6, 1000), dtype=np.float32)
    rows[0, 517] = 10.0
    edges = np.linspace(0, 1000, 101)
    assert average_columns(rows[:1], edges[None]).max() == pytest.approx(1.0)
    known = set(average_bins.entry.signatures)
    average_columns(rows, np.broadcast_to(edges, (3, 101)), picked=np.arange(6)[::2], bins=range(999, -1, -1))
    assert set(average_bins.entry.signatures) == known


def test_a_sheet_does_not_depend_on_the_blocks_and_is_bounded_by_rows_that_stretch_and_average():
    whole = record(np.random.default_rng(2).random((2, 50, BINS)))
    curve = np.linspace(2.0, 1.0, BINS)
    parts = [whole.isel(ping_time=slice(a, b)) for a, b in ((0, 7), (7, 8), (8, 50))]
    at_once, in_parts = (gather_sheet(blocks, even(curve), 50, DisplayOptions()) for blocks in ([whole], parts))
    np.testing.assert_array_equal(at_once.amplitude, in_parts.amplitude)
    assert (at_once.along, in_parts.along, at_once.reach) == pytest.approx((10.0, 10.0, REACH))
    block = record(np.ones((2, 1000, 8)))
    sheet = gather_sheet((block for _ in range(9)), even(bins=8), 9000, DisplayOptions(side="port"))
    assert sheet.pings == 9000
    assert sheet.amplitude.shape == (1800, 900)
    np.testing.assert_allclose(sheet.amplitude, 1.0, rtol=1e-5)
    rows = np.array([[1.0], [3.0]], dtype=np.float32)
    assert resample_rows(rows, 4).ravel().tolist() == [1, 1, 3, 3]
    assert resample_rows(rows, 1).ravel().tolist() == [2]


def test_ground_range_puts_an_echo_where_the_bed_is_without_water_column_and_needs_a_bed_within_range():
    sides = np.zeros((3, 2, 5000), dtype=np.float32)
    altitudes = np.array([8.0, 10.0, 12.0])
    for ping, altitude in enumerate(altitudes):
        sides[ping, 1, int(np.hypot(30.05, altitude) / 0.01)] = 1.0
    edges = compute_column_edges(altitudes, RangeAxis("ground", 5000, 0.01, 48.0), 480)
    assert mirror_channels(sides, edges, "starboard").argmax(axis=1).tolist() == [300, 300, 300]
    bins = np.arange(BINS) * REACH / BINS
    record_ = record(np.broadcast_to((bins >= ALTITUDE).astype(float), (2, 4, BINS)))
    slant = gather_sheet([record_], even(), 4, DisplayOptions(side="port"))
    ground = gather_sheet([record_], even(), 4, DisplayOptions(side="port", ground_range=True))
    assert slant.amplitude[0, 0] == 0.0
    assert ground.amplitude.min() > 0.9
    assert ground.reach == pytest.approx(np.sqrt(REACH**2 - ALTITUDE**2))
    said = r"--ground-range: the record ends at a slant range of 50 m, before the bed 60 m beneath; leave"
    with pytest.raises(SceneError, match=said):
        gather_sheet([record(np.ones((2, 4, BINS)), altitude=60.0)], even(), 4, DisplayOptions(ground_range=True))


LOOKS = {"side": "starboard", "palette": "pen", "gain": 3.0}, {"ground_range": True, "palette": "viridis"}


@pytest.mark.parametrize("look", [DisplayOptions(), *(DisplayOptions(**changes) for changes in LOOKS)])
def test_a_page_shows_the_sheet_pixel_for_pixel(tmp_path, look):
    sheet = gather_sheet([record(np.random.default_rng(3).random((2, 30, BINS)))], even(), 30, look)
    write_page(tmp_path / "page.png", sheet, look, caption_scene(load_scene("default"), look))
    with Image.open(tmp_path / "page.png") as picture:
        pixels = np.asarray(picture.convert("RGB"))
    shown = colour_amplitudes(sheet.amplitude, look)
    top, left = 92 + 20, 86 + 20
    np.testing.assert_array_equal(pixels[top : top + 40, left : left + 300], shown[20:60, 20:320])
    assert (pixels.shape[:2] > np.array(sheet.amplitude.shape)).all()


@pytest.mark.parametrize("title", ["a $b_c and $ more", "深海 ∑", "x" * 200, ""])
def test_any_title_can_be_drawn(tmp_path, title):
    scene = edit(load_scene("default"), {"title": title})
    sheet = gather_sheet([record(np.zeros((2, 1, 3)))], even(bins=3), 1, DisplayOptions())
    write_page(tmp_path / "page.png", sheet, DisplayOptions(), caption_scene(scene, DisplayOptions()))
    assert (tmp_path / "page.png").stat().st_size > 1000


def test_the_summary_names_what_was_set_and_ticks_lie_where_the_bar_has_their_amplitude():
    scene = edit(load_scene("default"), {"sonar.beam": "knife", "sonar.law": "light", "track.altitude": 12})
    line = caption_scene(scene, DisplayOptions(gain=6.0)).line
    assert all(said in line for said in ("altitude 12 m", "knife-edge beam", "law light", "gain +6 dB"))
    assert "vertical" not in line
    tilted = edit(scene, {"sonar.vertical": {"kind": "gaussian", "width": 45.0, "tilt": 20.0}})
    assert "vertical gaussian 45° tilted 20°" in caption_scene(tilted, DisplayOptions()).line
    for place, text in place_decibel_ticks((0.1, 2.0), gain=6.0):
        assert 20 * np.log10(0.1 + place * 1.9) - 6.0 == pytest.approx(float(text.replace("−", "-")))
    for place, text in place_decibel_ticks((0.1, 1.0), gain=0.0, decibels=True):
        assert place == pytest.approx(1.0 + float(text.replace("−", "-")) / 20.0)


def test_palettes_run_one_way_in_lightness_and_another_is_one_new_file(tmp_path, monkeypatch):
    for name in PALETTES:
        lightness = load_palette(name).astype(float) @ np.array([0.2126, 0.7152, 0.0722])
        assert lightness.shape == (256,)
        # A pen marks strong echoes dark.
        assert (np.diff(lightness) < 0.5).all() if name == "pen" else (np.diff(lightness) > -0.5).all()
        assert name != "pen" or (lightness[0] > 220 and lightness[-1] < 40)
    with pytest.raises(SceneError, match="'jet' is not known; choose one of copper, grey, pen"):
        load_palette("jet")
    (tmp_path / "palettes").mkdir()
    for name in PALETTES:
        (tmp_path / "palettes" / f"{name}.txt").write_bytes(display_options.find_palettes()[name].read_bytes())
    (tmp_path / "palettes" / "reds.txt").write_text("# From black to red.\n#000000\n#ff0000\n")
    monkeypatch.setattr(display_options, "resources", lambda: tmp_path)
    assert set(display_options.find_palettes()) == {*PALETTES, "reds"}
    np.testing.assert_array_equal(load_palette("reds")[[0, 255]], [[0, 0, 0], [255, 0, 0]])


@pytest.mark.parametrize("kind", ["slant", "bed", "ground"])
def test_distances_lead_to_bins_and_back(kind: str) -> None:
    axis = make_range_axis(kind, 500, 0.1, 8.0)
    altitude = np.array([8.0, 10.0, 14.0])[:, None]
    distance = np.array([0.5, 3.0, 20.0, 34.0])[None, :]
    back = axis.distance_of(axis.bins_at(distance, altitude), altitude)
    np.testing.assert_allclose(back, np.broadcast_to(distance, back.shape), rtol=1e-12)
    assert axis.bins_at(np.array([axis.reach]), np.array([8.0])) == pytest.approx(500)
    assert np.isnan(axis.distance_of(np.array([20.0]), np.array([10.0]))).all() == (kind != "slant")
    assert make_range_axis(kind, 500, 0.1, 60.0) is None or kind == "slant"
    # Over a measured bed that rises above the depth of the tow, by more than the range too.
    for below in (-10.0, -60.0):
        assert kind != "ground" or make_range_axis(kind, 500, 0.1, below).reach == 50.0


def test_without_water_a_picture_begins_at_the_first_echo_of_each_ping() -> None:
    intensity = np.zeros((2, 3, BINS), np.float32)
    altitudes = np.array([8.0, 10.0, 12.0])
    for ping, altitude in enumerate(altitudes):
        intensity[:, ping, int(altitude / (REACH / BINS)) + 1] = 1.0
    block = record(intensity).assign(platform_altitude=("ping_time", altitudes))
    sheet = gather_sheet([block], even(), 3, DisplayOptions(side="starboard", water_column=False))
    assert sheet.reach == pytest.approx(REACH - 8.0)
    loudest = sheet.amplitude.argmax(axis=1) * sheet.reach / sheet.amplitude.shape[1]
    assert (loudest < 2.5 * REACH / BINS).all()
    turned = gather_sheet([block], even(), 3, DisplayOptions(side="starboard", newest_on_top=False))
    upright = gather_sheet([block], even(), 3, DisplayOptions(side="starboard"))
    np.testing.assert_array_equal(turned.amplitude, upright.amplitude[::-1])


def test_tones_by_gains_of_a_side_and_over_range_of_palettes_linear_in_decibels_and_turned_round() -> None:
    factors = side_factors(DisplayOptions(side_gains=(6.0, 0.0), side_slopes=(0.0, 20.0)), 1000)
    np.testing.assert_allclose(factors[0], 10.0**0.3, rtol=1e-6)
    np.testing.assert_allclose(20.0 * np.log10(factors[1, [49, 499, 999]]), [-20.0, 0.0, 6.02], atol=0.1)
    assert side_factors(DisplayOptions(), 1000) is None
    amplitude = np.array([0.25, np.nan], dtype=np.float32)
    assert (map_tones(amplitude, (0.0, 1.0), gain=20 * np.log10(2)) == map_tones(2 * amplitude, (0.0, 1.0))).all()
    assert map_tones(amplitude, (0.0, 1.0), gain=60.0).tolist() == [255, 0], "not a number is silence"
    tones = map_tones(np.array([0.0, 0.01, 0.1, 1.0, 9.0], np.float32), (0.0, 1.0), decibels=True)
    assert tones.tolist() == [0, 0, 128, 255, 255], "40 dB below the upper end at most"
    assert map_tones(np.array([0.1, 0.316, 1.0], np.float32), (0.1, 1.0), decibels=True).tolist() == [0, 127, 255]
    steps = np.eye(2, dtype=np.float32)
    upright, turned = (colour_amplitudes(steps, DisplayOptions(reverse=r), (0.0, 1.0)) for r in (False, True))
    assert (upright == turned[::-1]).all()


@pytest.mark.parametrize("colours", [2, 256, 6121])
def test_colours_are_looked_up_by_the_place_between_both_levels(colours):
    rng = np.random.default_rng(colours)
    low, high, table = 0.3, 1.7, rng.integers(0, 2**32, colours, dtype=np.uint32)
    values = rng.rayleigh(2.0, (40, 50)).astype(np.float32)
    values[0, :5] = -1.0, low, high, np.inf, -np.inf
    place = (values - np.float32(low)) * np.float32(255.0 / (high - low))
    expected = table[np.clip(place, 0.0, colours - 1.0).astype(np.int64)]
    np.testing.assert_array_equal(colour_rows(values, low, high, table), expected)
    assert colour_rows(np.full((1, 1), np.nan, np.float32), low, high, table) == table[0]
    assert colour_rows(values[:0], low, high, table).shape == (0, 50)
    assert colour_rows(values[:, :0], low, high, table).shape == (len(values), 0)


@pytest.mark.parametrize("altitude", [-1.0, -1e5, -1e9, -1e300])
@pytest.mark.parametrize("kind", ["slant", "bed", "ground"])
def test_an_altitude_below_the_bed_leads_to_no_bin_outside_its_row(kind: str, altitude: float) -> None:
    axis = make_range_axis(kind, 64, 0.1, 1.0)
    position = place_columns(np.linspace(0.0, axis.reach, 33), np.array([1.0, altitude, 1.0]), axis)
    assert position.min() >= 0.0
    assert position.max() <= 64.0
    rows = np.repeat(np.array([[3.0], [1.0], [3.0]], np.float32), 64, axis=1)  # its neighbours differ
    found = average_columns(rows, position, bins=range(63, -1, -1))
    assert set(found[1].tolist()) <= {0.0, 1.0}


@pytest.mark.filterwarnings("error")
def test_a_bed_without_a_finite_height_has_the_curve_of_the_least_or_greatest_altitude(monkeypatch):
    simulation = prepare(edit(load_scene("default"), {"sonar.bins": 50, "targets": []}))
    beneath = np.array([np.nan, np.inf, -np.inf, 0.0])
    monkeypatch.setattr(normalisation, "interpolate_bed_beneath", lambda *_: beneath)
    found = LevelBed(simulation).curves(np.arange(4))
    assert np.isfinite(found).all()
    assert found.min() > 0.0
    np.testing.assert_array_equal(found[0], found[1])


def test_every_option_is_read_back_and_a_mistake_names_option_and_value() -> None:
    usual = DisplayOptions()
    switched = {name: not value for name, value in usual._asdict().items() if isinstance(value, bool)}
    names = {"side": "port", "palette": "grey", "scale": "true"}
    numbers = {"gain": -3.5, "levels": (0.1, 4.0), "side_gains": (0.0, 6.0), "side_slopes": (-2.0, 3.0)}
    changed = DisplayOptions(**switched, **names, **numbers)
    assert all(one != other for one, other in zip(changed, usual))
    assert DisplayOptions(**read_display(display_settings(changed))) == changed
    assert display_settings(usual) == []
    assert read_display(["gain=6", "levels=[0, 4]"]) == {"gain": 6.0, "levels": (0.0, 4.0)}  # whole numbers
    mistakes = ("colour=red", 'palette="mauve"', "reverse=1", "gain=true", "gain=nan", "levels=[1]", "water_column")
    for setting in (*mistakes, 'side_gains=[0, "a"]'):
        with pytest.raises(SceneError, match=f"--display .*{setting.split('=')[0]}"):
            read_display([setting])


def test_the_command_draws_by_the_options(tmp_path: Path) -> None:
    for name, more in (("usual", []), ("shown", ["--display", "reverse=true", "--display", "water_column=false"])):
        words = ["render", "figure-4a", "--set", "track.pings=64", "-o", str(tmp_path / f"{name}.png")]
        assert main([*words, *more]) == 0
    usual, shown = (np.asarray(Image.open(tmp_path / f"{name}.png").convert("L")) for name in ("usual", "shown"))
    assert usual.shape != shown.shape or not np.array_equal(usual, shown)
