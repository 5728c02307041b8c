"""Distances between the textures of two sets of images, and a classifier that tries to tell them apart."""

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from insonify.arrays import Bytes, Floats
from insonify.errors import SceneError
from insonify.statistics.image_textures import LEAST, measure_texture

Images = Sequence[Bytes]
SUFFIXES = (".png", ".jpg", ".jpeg", ".tif", ".tiff", ".bmp")
MOST_IMAGES = 2000  # images of a folder, evenly chosen
FEWEST = 10
FOLDS, TREES = 5, 200
CLASSES = 12  # of a quantity, for divergences
RUN = 10  # files that follow one another by name and are often parts of one record
SHOWN = 8  # images of each set on the picture
UNKNOWN = "install scikit-learn for a classifier that tells the sets apart: pip install 'insonify[learning]'"


class Difference(NamedTuple):
    """One quantity of the texture in both sets."""

    quantity: str
    medians: tuple[float, float]
    distance: float  # Kolmogorov and Smirnov's: largest difference of the two distributions, 0 to 1
    auc: float  # of this quantity alone, by the side of a threshold: 0.5 if it tells nothing
    kl: float  # divergence of Kullback and Leibler of the second distribution from the first, in bits
    js: float  # divergence of Jensen and Shannon, 0 to 1 bit
    emd: float  # earth mover's distance, in standard deviations of the first set


class Separation(NamedTuple):
    """How well a classifier tells two sets apart by some quantities."""

    by: str
    auc: float  # chance that it ranks an image of one set above one of the other: 0.5 if they are alike


@dataclass(frozen=True)
class Realism:
    """Comparison of the textures of two sets of images."""

    counts: tuple[int, int]
    differences: tuple[Difference, ...]  # the largest first
    separations: tuple[Separation, ...]  # by all quantities, then by each group; none without scikit-learn

    def lines(self) -> list[str]:
        """Lay both tables out as lines."""
        width = max(len(one.quantity) for one in self.differences)
        found = [f"{'':{width}}  {'first':>8}  {'second':>8}  distance     AUC      KL      JS     EMD"]
        for one in self.differences:
            first, second = one.medians
            numbers = "".join(f"{number:8.3f}" for number in (one.auc, one.kl, one.js, one.emd))
            found.append(f"{one.quantity:{width}}  {first:8.3f}  {second:8.3f}  {one.distance:8.3f}{numbers}")
        found += [f"AUC by {one.by:{width - 7}}  {one.auc:28.3f}" for one in self.separations]
        return found if self.separations else [*found, UNKNOWN]


def read_images(folder: Path) -> Images:
    """Read the images below a folder in grey levels; of a data set its `images`, and none that is too small."""
    from PIL import Image

    paths = [path for path in sorted(folder.rglob("*"), key=_by_number) if path.suffix.lower() in SUFFIXES]
    paths = [path for path in paths if path.is_file() and "masks" not in path.relative_to(folder).parts]
    own = [path for path in paths if "images" in path.relative_to(folder).parts]
    paths = own or paths
    if len(paths) > MOST_IMAGES:
        paths = [paths[number] for number in np.linspace(0, len(paths) - 1, MOST_IMAGES).astype(int)]
    images = []
    for path in paths:
        try:
            with Image.open(path) as picture:
                images.append(np.asarray(picture.convert("L")))
        except OSError as fault:
            raise SceneError(f"{path}: cannot be read as an image ({fault}); remove it from the folder") from None
    images = [image for image in images if min(image.shape) >= LEAST]
    if len(images) < FEWEST:
        raise SceneError(f"{folder}: {len(images)} images of at least {LEAST} pixels a side; give at least {FEWEST}")
    return images


def _by_number(path: Path) -> list[str]:
    """Key that sorts the numbers in names by their value."""
    return [part.zfill(20) if part.isdigit() else part for part in re.split(r"(\d+)", str(path))]


def compare_textures(first: Images, second: Images) -> Realism:
    """Compare two sets of images quantity by quantity, and by a classifier where scikit-learn is installed."""
    measured = [[measure_texture(image) for image in images] for images in (first, second)]
    groups = {group: list(found) for group, found in measured[0][0].items()}
    tables = {
        group: [np.array([[one[group][name] for name in names] for one in many]) for many in measured]
        for group, names in groups.items()
    }
    differences = [
        _differ(name, a, b)
        for group, (one, other) in tables.items()
        for name, a, b in zip(groups[group], one.T, other.T)
    ]
    differences.sort(key=lambda one: -one.distance)
    return Realism((len(first), len(second)), tuple(differences), tuple(_separations(tables)))


def _differ(name: str, first: Floats, second: Floats) -> Difference:
    """Distances of the distributions of one quantity; divergences by classes of equal shares of both sets together."""
    # lazy: slow to import
    from scipy.stats import ks_2samp, mannwhitneyu, wasserstein_distance

    edges = np.unique(np.quantile(np.concatenate([first, second]), np.linspace(0.0, 1.0, CLASSES + 1)[1:-1]))
    # Half a count in every class, so that an empty one is not infinitely far (Krichevsky and Trofimov 1981).
    counts = [np.bincount(np.searchsorted(edges, each), minlength=edges.size + 1) + 0.5 for each in (first, second)]
    p, q = (count / count.sum() for count in counts)

    def divergence(one: Floats, other: Floats) -> float:
        return float((one * np.log2(one / other)).sum())

    rank = mannwhitneyu(first, second).statistic / (first.size * second.size)
    return Difference(
        name,
        (float(np.median(first)), float(np.median(second))),
        float(ks_2samp(first, second, method="asymp").statistic),
        float(max(rank, 1.0 - rank)),
        divergence(p, q),
        0.5 * (divergence(p, 0.5 * (p + q)) + divergence(q, 0.5 * (p + q))),
        float(wasserstein_distance(first, second) / max(first.std(), 1e-12)),
    )


def _separations(tables: dict[str, list[Floats]]) -> Iterator[Separation]:
    """Areas under the curve of a forest that is trained on some images and tested on others."""
    try:
        from sklearn.ensemble import ExtraTreesClassifier
        from sklearn.metrics import roc_auc_score
        from sklearn.model_selection import StratifiedGroupKFold, StratifiedKFold, cross_val_predict
    except ImportError:
        return
    counts = [len(table) for table in next(iter(tables.values()))]
    is_second = np.repeat([0, 1], counts)
    runs = np.concatenate([np.arange(counts[0]) // RUN, counts[0] + np.arange(counts[1]) // RUN])
    whole = np.concatenate([np.concatenate(pair) for pair in tables.values()], axis=1)
    groups = {group: np.concatenate(pair) for group, pair in tables.items()}
    for by, values in {"all": whole, "all, runs apart": whole, **groups}.items():
        forest = ExtraTreesClassifier(TREES, min_samples_leaf=2, class_weight="balanced", random_state=0)
        folds, kept = StratifiedKFold(FOLDS, shuffle=True, random_state=0), None
        if "runs" in by:
            number = min(FOLDS, *(-(-count // RUN) for count in counts))
            if number < 2:
                continue
            folds, kept = StratifiedGroupKFold(number, shuffle=True, random_state=0), runs
        chance = cross_val_predict(forest, values, is_second, groups=kept, cv=folds, method="predict_proba")[:, 1]
        yield Separation(by, float(roc_auc_score(is_second, chance)))


def draw_realism(path: Path, found: Realism, sets: tuple[Images, Images], names: tuple[str, str]) -> None:
    """Draw the distances as bars beside some images of both sets: a PNG picture."""
    # lazy: slow to import
    from insonify.display.style import BLUE, INK, ORANGE, label_axes, make_figure, style_axes

    figure = make_figure(12.0, 7.0, layout="constrained")
    parts: Any = figure.subfigures(1, 2, width_ratios=[1.0, 1.6])
    left, right = parts
    axes = left.subplots()
    shown = found.differences[:16][::-1]
    axes.barh([one.quantity for one in shown], [one.distance for one in shown], color=BLUE)
    axes.set_xlim(0.0, 1.0)
    style_axes(axes, 9.0)
    label_axes(axes, x="distance of the distributions")
    if found.separations:
        axes.set_title(f"AUC of a classifier: {found.separations[0].auc:.3f}", fontsize=10.0, color=INK)
    tiles: Any = right.subplots(4, SHOWN // 2)
    for half, (images, name, colour) in enumerate(zip(sets, names, (BLUE, ORANGE))):
        picked = np.linspace(0, len(images) - 1, SHOWN).astype(int)
        for place, (number, tile) in enumerate(zip(picked, tiles[2 * half : 2 * half + 2].flat)):
            tile.imshow(images[number], cmap="gray", vmin=0, vmax=255)
            tile.set_axis_off()
            if place == 0:
                tile.set_title(name, loc="left", fontsize=10.0, color=colour)
    figure.savefig(path, dpi=110, metadata={"Software": None})
