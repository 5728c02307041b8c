"""Textures of images, and what tells two sets of them apart."""

import sys

import numpy as np
import pytest
from PIL import Image
from scipy import ndimage

from commands import refused
from insonify import cli
from insonify.accuracy import realism
from insonify.accuracy.realism import UNKNOWN, _differ, compare_textures
from insonify.statistics.image_textures import measure_texture

realism.TREES = 20
RNG = np.random.default_rng(5)


def speckled(width=(0.0, 0.0), count=14):
    """Images of Rayleigh amplitudes, blurred along and across."""
    fields = [ndimage.gaussian_filter(RNG.rayleigh(1.0, (48, 56)), width) for _ in range(count)]
    return [np.clip(80.0 * field, 0.0, 255.0).astype(np.uint8) for field in fields]


def test_quantities_of_known_textures():
    image = np.clip(60.0 * RNG.rayleigh(1.0, (256, 200)), 0.0, 255.0).astype(np.uint8)
    found = measure_texture(image)
    greys, correlation = found["greys"], found["correlation"]
    assert greys["amplitude variation"] == pytest.approx(np.sqrt(4.0 / np.pi - 1.0), abs=0.01)
    assert greys["skewness"] == pytest.approx(0.63, abs=0.06)
    assert greys["percentile 50"] == pytest.approx(60.0 * np.sqrt(2.0 * np.log(2.0)) / 255.0, abs=0.005)
    # Mean and variance of samples correlate by the skewness over the root of the kurtosis less 1.
    assert greys["mean against deviation"] == pytest.approx(0.631 / np.sqrt(2.245), abs=0.1)
    # White noise falls from 1 to 0 in one pixel, by linear interpolation to 1/e at 0.632 px.
    assert correlation["correlation length along"] == pytest.approx(1.0 - np.exp(-1.0), abs=0.02)
    assert found["spectrum"]["spectral slope across"] == pytest.approx(0.0, abs=0.1)
    assert sum(share for name, share in found["patterns"].items() if name.endswith("1 px")) == pytest.approx(1.0)
    soft = measure_texture(ndimage.gaussian_filter(image, (0.0, 2.0)))["correlation"]
    # A Gaussian of deviation s correlates as exp(-lag²/4s²).
    assert soft["correlation length across"] == pytest.approx(4.0, abs=0.3)
    assert soft["anisotropy"] < -1.5


def test_alike_sets_are_not_told_apart_and_different_ones_are():
    pytest.importorskip("sklearn")
    first, alike, other = speckled(), speckled(), speckled((0.0, 0.7))
    assert compare_textures(first, alike).separations[0].auc < 0.85
    found = compare_textures(first, other)
    assert found.separations[0].auc > 0.95
    distances = {one.quantity: one.distance for one in found.differences}
    assert distances["correlation length across"] == 1.0
    assert distances["correlation length along"] < 0.7


def test_distances_of_distributions_are_those_of_their_formulas():
    first, second = RNG.normal(0.0, 2.0, 40000), RNG.normal(1.0, 2.0, 40000)
    found = _differ("x", first, second)
    assert found.emd == pytest.approx(0.5, abs=0.02)
    assert found.auc == pytest.approx(0.638, abs=0.01)  # Φ(1/(2√2))
    assert found.kl == pytest.approx(0.125 / np.log(2.0), rel=0.1)  # half of the squared shift, in deviations
    assert 0.0 < found.js < found.kl / 3.0
    alike = _differ("x", first, first)
    assert (alike.auc, alike.kl, alike.js, alike.emd) == (0.5, 0.0, 0.0, 0.0)


def test_parts_of_one_record_do_not_vouch_for_one_another():
    pytest.importorskip("sklearn")
    # Twenty pictures of each set come from two records of a scatter of their own.
    first, second = ([i for w in widths for i in speckled((w, w), 10)] for widths in ((0.2, 1.0), (0.6, 1.6)))
    apart = {one.by: one.auc for one in compare_textures(first, second).separations}
    assert apart["all, runs apart"] < apart["all"]


@pytest.mark.parametrize("with_classifier", [True, False])
def test_the_command_prints_a_table_and_draws_a_picture(tmp_path, capsys, monkeypatch, with_classifier):
    if with_classifier:
        pytest.importorskip("sklearn")
    else:
        monkeypatch.setitem(sys.modules, "sklearn.ensemble", None)
    for name, images in (("a", speckled()), ("b", speckled((0.7, 0.0)))):
        (tmp_path / name / "masks").mkdir(parents=True)
        for number, image in enumerate(images):
            Image.fromarray(image).save(tmp_path / name / f"{number}.png")
        Image.fromarray(images[0]).save(tmp_path / name / "masks" / "0.png")
    folders = [str(tmp_path / name) for name in "ab"]
    assert cli.main(["realism", *folders, "-o", str(tmp_path / "out.png")]) == 0
    printed = capsys.readouterr().out
    assert printed.count("14 images") == 2
    assert "correlation length along" in printed
    assert ("AUC by all" in printed) == with_classifier
    assert (UNKNOWN in printed) != with_classifier
    with Image.open(tmp_path / "out.png") as picture:
        assert picture.size == (1320, 770)


def test_a_folder_without_images_is_refused_in_one_sentence(tmp_path, capsys):
    assert "0 images" in refused(capsys, "realism", str(tmp_path), str(tmp_path))
