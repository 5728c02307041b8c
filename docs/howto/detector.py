"""Train a detector of ships and aircraft on simulated chips, and test it on pictures of one's own.

``python detector.py SET … --test FOLDER -o detector.joblib``: each SET is a folder that ``insonify dataset`` made;
FOLDER has a sub-folder for each class, named as in the sets, and ``seabed``. Needs NumPy, SciPy, Pillow, scikit-image
and scikit-learn; no GPU and no downloads.
"""

import argparse
import json
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

import numpy as np
from PIL import Image
from scipy import ndimage
from skimage.feature import local_binary_pattern

BED, SIDE, DRAWS = "seabed", 128, 1000
SCALES, ANGLES = 4, 6  # of the wavelets: octaves, and directions over half a turn


def describe(picture: Image.Image) -> np.ndarray:
    """Features of greys, texture, edges, outline and scattering; they change little as a picture is turned."""
    size = [max(round(SIDE * side / max(picture.size)), 16) for side in picture.size]
    image = np.asarray(picture.convert("L").resize(size, Image.Resampling.BOX), float) / 255.0
    image = (image - np.median(image)) / (image.std() + 1e-3)
    found = [*np.percentile(image, [1, 5, 25, 75, 95, 99]), float((image**3).mean())]
    for scale in (1, 2, 4, 8, 16):
        soft = ndimage.gaussian_filter(image, scale)
        found += [soft.std(), *np.percentile(soft, [1, 99]), float(((soft - soft.mean()) ** 3).mean())]
        found.append(ndimage.gaussian_gradient_magnitude(image, scale).std())
    greys = (255 * (image - image.min()) / np.ptp(image)).astype(np.uint8)
    for radius in (1, 3):
        found += [*np.histogram(local_binary_pattern(greys, 8, radius, "uniform"), np.arange(11), density=True)[0]]
    for scale in (1.5, 3.0):
        soft = ndimage.gaussian_filter(image, scale)
        found += [*_edges(soft)]
        for part in (soft, -soft, np.abs(soft)):
            for share in (96.0, 88.0):
                found += _outline(part[::2, ::2], share)
    return np.array([*found, *scatter(image)])


def _edges(image: np.ndarray) -> np.ndarray:
    """Angular harmonics of the directions of edges: one direction of ribs and rims, several of wings and bodies."""
    dy, dx = np.gradient(image)
    strength, angle = np.hypot(dy, dx) ** 2, np.arctan2(dy, dx)
    total = strength.sum() + 1e-9
    return np.array([abs((strength * np.exp(1j * m * angle)).sum()) / total for m in (1, 2, 3, 4, 6, 8)])


def _outline(image: np.ndarray, share: float) -> list[float]:
    """Size and elongation of the brightest part of a picture, and its angular harmonics in rings about the middle."""
    bright = image > np.percentile(image, share)
    parts, count = ndimage.label(bright)
    sizes = np.bincount(parts.ravel())[1:] if count else np.ones(1)
    is_large = np.concatenate([[False], sizes > 0.1 * sizes.max()])  # no specks
    y, x = (place / max(image.shape) for place in np.nonzero(is_large[parts] if count else bright))
    if len(y) < 2:
        y = x = np.array([0.0, 1.0])
    dy, dx = y - y.mean(), x - x.mean()
    minor, major = np.sqrt(np.maximum(np.linalg.eigvalsh(np.cov(dy, dx)), 1e-6))
    # In units of the larger spread, outlines of all sizes are alike.
    radius, turn = np.hypot(dy, dx) / major, np.exp(1j * np.arctan2(dy, dx))
    found = [major, minor / major, len(y) / image.size, len(y) / image.size / (major * minor)]
    for inner, outer in ((0.0, 0.5), (0.5, 1.0), (1.0, 1.6), (1.6, 2.6)):
        ring = turn[(radius >= inner) & (radius < outer)]
        found += [len(ring) / len(y), *(abs((ring**m).sum()) / max(len(ring), 1) for m in range(1, 7))]
    return [*found, float(count), float(sizes.max() / image.size), float(sizes.max() / max(sizes.sum(), 1))]


def wavelets(side: int) -> np.ndarray:
    """Morlet wavelets in the Fourier domain, (scales, angles, side, side)."""
    f = np.fft.fftfreq(side)
    bank = np.empty((SCALES, ANGLES, side, side))
    for j, turn in np.ndindex(SCALES, ANGLES):
        angle, middle = np.pi * turn / ANGLES, 0.35 * 2.0**-j
        along = np.cos(angle) * f + np.sin(angle) * f[:, None]
        beside = np.cos(angle) * f[:, None] - np.sin(angle) * f
        wave = np.exp(-0.5 * (((along - middle) / (0.35 * middle)) ** 2 + (beside / (0.5 * middle)) ** 2))
        bank[j, turn] = wave * (1.0 - np.exp(-0.5 * (f**2 + f[:, None] ** 2) / (0.2 * middle) ** 2))
    return bank


BANK, COARSE = wavelets(SIDE), wavelets(SIDE // 2)


def scatter(image: np.ndarray) -> np.ndarray:
    """Logarithms of scattering coefficients of two orders (Mallat 2012), by scale and by angle between wavelets."""
    square = np.pad(image, [(0, SIDE - size) for size in image.shape], mode="reflect")
    first = np.abs(np.fft.ifft2(np.fft.fft2(square) * BANK))
    means = first.mean(axis=(2, 3)) + 1e-6
    turns = np.exp(2j * np.pi * np.arange(ANGLES) / ANGLES)
    found = [np.log(means.mean(axis=1)), np.abs((means * turns).sum(axis=1)) / means.sum(axis=1)]
    # Sparse echoes: strongest twentieth, and the middle of the picture, over the mean.
    middle = first[:, :, SIDE // 4 : -SIDE // 4, SIDE // 4 : -SIDE // 4]
    found += [np.log(part.mean(axis=1) / means.mean(axis=1)) for part in (
        np.percentile(first, 95, axis=(2, 3)), np.percentile(first, 99, axis=(2, 3)), middle.mean(axis=(2, 3)),
    )]  # fmt: skip
    halved = first.reshape(SCALES, ANGLES, SIDE // 2, 2, SIDE // 2, 2).mean(axis=(3, 5))
    for j in range(SCALES - 1):
        spectra = np.fft.fft2(halved[j])
        for k in range(j, SCALES - 1):  # wavelets of the coarse grid lie an octave lower
            pairs = np.abs(np.fft.ifft2(spectra[:, None] * COARSE[k])).mean(axis=(2, 3)) / means[j][:, None]
            # Mean over all directions of the first wavelet, by the angle to the second.
            between = [np.mean([pairs[a, (a + d) % ANGLES] for a in range(ANGLES)]) for d in range(ANGLES)]
            found.append(
                np.log([between[0], between[ANGLES // 2], *(0.5 * (between[d] + between[-d]) for d in (1, 2))])
            )
    return np.concatenate(found)


def cropped(picture: Image.Image, box: list[int], rng: np.random.Generator) -> Image.Image:
    """Window about the box of an echo and its shadow, wider by up to 0.3 of it on each side, as archives crop."""
    x, y, wide, high = box
    left, up, right, down = rng.uniform(0.03, 0.3, 4)
    ends = min(x + wide + right * wide, picture.width), min(y + high + down * high, picture.height)
    return picture.crop((int(max(x - left * wide, 0)), int(max(y - up * high, 0)), int(ends[0]), int(ends[1])))


def read_sets(folders: list[Path]) -> tuple[list[Image.Image], list[str]]:
    """Chips of sets and their classes by name, each chip as it is and cropped; beds get the boxes of objects."""
    rng, chips = np.random.default_rng(1), []
    for folder in folders:
        for line in map(json.loads, (folder / "metadata.jsonl").read_text(encoding="utf-8").splitlines()):
            box = next((found["both"] for found in line["targets"]), None)
            chips.append((Image.open(folder / line["file_name"]).convert("L"), box, line["class"] or BED))
    # Shares of the picture, so that a box fits one of any size.
    boxes = [np.divide(box, 2 * picture.size) for picture, box, _ in chips if box]
    pictures, names = [], []
    for picture, box, name in chips:
        box = box or (boxes[rng.integers(len(boxes))] * np.array(2 * picture.size)).tolist()
        pictures += [picture, cropped(picture, box, rng)]
        names += [name, name]
    return pictures, names


class Detector:
    """Mean of the chances by a forest of random trees and by a logistic regression, of several seeds."""

    def fit(self, features: np.ndarray, names: list[str], seeds: int = 3) -> "Detector":
        """Learn from features of pictures and names of their classes; the bed comes first."""
        from sklearn.ensemble import ExtraTreesClassifier
        from sklearn.linear_model import LogisticRegression
        from sklearn.pipeline import make_pipeline
        from sklearn.preprocessing import QuantileTransformer

        self.classes = [BED, *sorted(set(names) - {BED})]
        numbers = np.array([self.classes.index(name) for name in names])
        trees = {"min_samples_leaf": 2, "class_weight": "balanced", "n_jobs": 2}
        self.forests = [ExtraTreesClassifier(600, random_state=seed, **trees) for seed in range(seeds)]
        greys = QuantileTransformer(n_quantiles=200, output_distribution="normal", random_state=0)
        self.lines = make_pipeline(greys, LogisticRegression(C=0.003, class_weight="balanced", max_iter=500))
        for model in (*self.forests, self.lines):
            model.fit(features, numbers)
        return self

    def chances(self, features: np.ndarray) -> dict[str, np.ndarray]:
        """Chances of the classes by the forest, by the regression and by both."""
        forest = np.mean([model.predict_proba(features) for model in self.forests], axis=0)
        lines = self.lines.predict_proba(features)
        return {"forest": forest, "regression": lines, "both": 0.5 * (forest + lines)}


def measures(chance: np.ndarray, truth: np.ndarray) -> dict[str, float]:
    """Columns of the table, from chances; class 0 is the bed."""
    from sklearn.metrics import balanced_accuracy_score, roc_auc_score

    decided, objects = chance.argmax(axis=1), truth > 0
    found = {
        "AUC object": roc_auc_score(objects, 1.0 - chance[:, 0]),
        "accuracy, object": float(((decided > 0) == objects).mean()),
        "all classes": float((decided == truth).mean()),
        "balanced": balanced_accuracy_score(truth, decided),
    }
    for number in range(1, chance.shape[1] - 1):  # of two classes of objects, one against the other
        share = chance[objects, number] / (chance[objects, 1:].sum(axis=1) + 1e-12)
        if 0 < (truth[objects] == number).sum() < objects.sum():
            found[f"AUC class {number}"] = roc_auc_score(truth[objects] == number, share)
    return found


def draw_mistakes(path: Path, pictures: list[Image.Image], words: list[str], side: int = 160) -> None:
    """Pictures with their true and their found class."""
    from PIL import ImageDraw

    rows = max(-(-len(pictures) // 8), 1)
    sheet = Image.new("L", (8 * side, rows * (side + 14)))
    draw = ImageDraw.Draw(sheet)
    for number, (picture, word) in enumerate(zip(pictures, words)):
        x, y = number % 8 * side, number // 8 * (side + 14)
        sheet.paste(picture.resize((side - 4, side - 4)), (x, y + 12))
        draw.text((x, y), word, fill=255)
    sheet.save(path)


def main() -> None:
    """Learn, test, print the table and draw the mistakes."""
    import joblib

    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("sets", nargs="+", type=Path)
    parser.add_argument("--test", type=Path, metavar="FOLDER", help="pictures in a sub-folder for each class")
    parser.add_argument("-o", "--output", type=Path, default=Path("detector.joblib"))
    given = parser.parse_args()
    with ProcessPoolExecutor(2) as pool:
        pictures, names = read_sets(given.sets)
        detector = Detector().fit(np.array(list(pool.map(describe, pictures, chunksize=16))), names)
        joblib.dump(detector, given.output)
        print(f"{given.output}: learned from {len(names) // 2} chips of {', '.join(detector.classes)}")
        if given.test is None:
            return
        paths = [(path, name) for name in detector.classes for path in sorted((given.test / name).glob("*.*"))]
        pictures = [Image.open(path).convert("L") for path, _ in paths]
        truth = np.array([detector.classes.index(name) for _, name in paths])
        chances = detector.chances(np.array(list(pool.map(describe, pictures, chunksize=16))))
    draws = np.random.default_rng(1).integers(0, len(truth), (DRAWS, len(truth)))
    for name, chance in chances.items():
        found, drawn = measures(chance, truth), [measures(chance[draw], truth[draw]) for draw in draws]
        for measure, value in found.items():
            low, high = np.percentile([one.get(measure, np.nan) for one in drawn], [2.5, 97.5])
            print(f"{name:12s}{measure:20s}{value:.3f}  ({low:.3f} to {high:.3f})")
    decided = chances["both"].argmax(axis=1)
    wrong = np.flatnonzero(decided != truth)
    words = [f"{detector.classes[truth[n]]} as {detector.classes[decided[n]]}" for n in wrong]
    draw_mistakes(given.output.with_suffix(".png"), [pictures[n] for n in wrong], words)


if __name__ == "__main__":
    main()
