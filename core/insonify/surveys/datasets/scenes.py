"""Scenes of a data set: the base scene with values and targets drawn for each number."""

from __future__ import annotations

import hashlib
import math
from collections.abc import Iterator, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from insonify.scene import Scene, SceneError, edit, scene_to_toml
from insonify.surveys.datasets.specification import DatasetSpecification, TargetGroup
from insonify.surveys.distributions import DistributionKind
from insonify.surveys.distributions.uniform import Uniform
from insonify.tow.line import tow_line_at

SEED_BITS = 53  # of a drawn seed: every reader of JSON keeps it exactly
GOLDEN = 0.5 * (math.sqrt(5.0) - 1.0)
FARTHEST = 0.85  # of the ground range of the last bin, up to which targets lie
ATTEMPTS = 200  # to find a place clear of the other targets
DIGITS = 3  # of places, in metres


def hash_share(seed: int, number: int, path: str) -> float:
    """Hash a seed, a number and a path to a uniform number inside (0, 1)."""
    digest = hashlib.blake2b(f"{seed}\n{number}\n{path}".encode(), digest_size=8).digest()
    return ((int.from_bytes(digest, "big") >> 12) + 0.5) * 2.0**-52


class Draws:
    """Values of one scene, and a record of them."""

    def __init__(self, seed: int, number: int) -> None:
        self._seed, self._number = seed, number
        self.drawn: dict[str, Any] = {}

    def share(self, path: str) -> float:
        """Draw a number inside (0, 1) that is not recorded."""
        return hash_share(self._seed, self._number, path)

    def value(self, path: str, declared: Any) -> Any:
        """Draw a value from a distribution; return any other value as it is."""
        if not isinstance(declared, DistributionKind):
            return declared
        self.drawn[path] = declared.quantile(self.share(path))
        return self.drawn[path]

    def seed(self, path: str) -> int:
        """Draw the seed of a scene's random numbers."""
        self.drawn[path] = int(self.share(path) * 2**SEED_BITS)
        return int(self.drawn[path])


class DrawnScene(NamedTuple):
    """One scene of a data set."""

    number: int  # from 0
    scene: Scene
    split: str
    classes: dict[int, str]  # class of each drawn target by its index in the scene
    drawn: dict[str, Any]  # every value that was drawn, by its path

    @property
    def digest(self) -> str:
        """Hash of the scene."""
        return hashlib.sha256(scene_to_toml(self.scene).encode()).hexdigest()[:16]


def split_of(splits: Mapping[str, float], number: int) -> str:
    """Return the split of a job by its number: any run of numbers has nearly the specified shares."""
    place = ((number + 1) * GOLDEN) % 1.0 * sum(splits.values())
    for name, share in splits.items():
        place -= share
        if place < 0.0:
            return name
    return name


def draw_scene(specification: DatasetSpecification, base: Scene, number: int) -> DrawnScene:
    """Draw one scene of a data set."""
    draws = Draws(specification.seed, number)
    try:
        changes: dict[str, Any] = {"seed": draws.seed("seed")}
        changes |= {path: draws.value(path, declared) for path, declared in specification.set.items()}
        scene = edit(base, changes)
        is_negative = draws.share("negatives") < specification.negatives
        groups = () if is_negative else specification.targets
        scene, classes = _put_targets(scene, groups, draws)
    except SceneError as error:
        raise SceneError(f"scene {number}: {error}") from None
    split = split_of(specification.splits, number // specification.storage.scenes)
    return DrawnScene(number, scene, split, classes, draws.drawn)


class _Wanted(NamedTuple):
    """A target to be put into a scene."""

    group: TargetGroup
    path: str  # that begins the paths of its draws
    shape: dict[str, Any]


def _put_targets(scene: Scene, groups: Sequence[TargetGroup], draws: Draws) -> tuple[Scene, dict[int, str]]:
    """Put the targets of all groups into a scene; return their classes too."""
    wanted = [one for group in groups for one in _wanted(group, draws)]
    if not wanted:
        return scene, {}
    first = len(scene.targets)
    bare = [{**one.shape, "position": [0.0, 0.0]} for one in wanted]
    changes: dict[str, Any] = {
        f"targets.{first + n}.{path}": draws.value(f"{one.path}.{path}", declared)
        for n, one in enumerate(wanted)
        for path, declared in one.group.set.items()
    }
    own = [target.model_dump(mode="json", exclude_none=True) for target in scene.targets]
    scene = edit(scene, {"targets": own + bare, **changes})
    radii = [target.outline.radius for target in scene.targets[first:]]
    places = _places(scene, wanted, radii, draws)
    scene = edit(scene, {f"targets.{first + n}.position": place for n, place in enumerate(places)})
    return scene, {first + n: one.group.name for n, one in enumerate(wanted)}


def _wanted(group: TargetGroup, draws: Draws) -> Iterator[_Wanted]:
    """Targets of one group."""
    count = draws.value(f"targets.{group.name}.count", group.count)
    if not (isinstance(count, int) and 0 <= count <= 1000):
        raise SceneError(f"targets.{group.name}.count: {count!r} is no number of targets; give whole numbers to 1000")
    for number in range(count):
        path = f"targets.{group.name}.{number}"
        shape = group.of[int(draws.share(f"{path}.of") * len(group.of))]
        draws.drawn[f"{path}.of"] = shape
        yield _Wanted(group, path, {"kind": "mesh", "path": shape} if isinstance(shape, str) else dict(shape))


def _places(scene: Scene, wanted: Sequence[_Wanted], radii: Sequence[float], draws: Draws) -> list[list[float]]:
    """Places of targets on the bed, clear of one another."""
    taken: list[list[float]] = []
    for one, radius in zip(wanted, radii):
        tries = (_place(scene, one, f"{one.path}.{attempt}", draws) for attempt in range(ATTEMPTS))
        place = next((place for place in tries if _is_clear(place, radius, taken, radii)), None)
        if place is None:
            raise SceneError(
                f"targets.{one.group.name}: {len(wanted)} targets find no room beside one another; lower count, or "
                "widen along and ground_range"
            )
        draws.drawn[f"{one.path}.position"] = place
        taken.append(place)
    return taken


def _is_clear(place: list[float], radius: float, taken: Sequence[list[float]], radii: Sequence[float]) -> bool:
    """Whether a target of some radius touches none of those that have their places."""
    return all(math.dist(place, other) > radius + beside for other, beside in zip(taken, radii))


def _place(scene: Scene, wanted: _Wanted, path: str, draws: Draws) -> list[float]:
    """Place abeam of the tow, to port or to starboard."""
    along = float(_quantile(wanted.group.along, draws.share(f"{path}.along")))
    beside = wanted.group.ground_range or _anywhere(scene)
    across = float(_quantile(beside, draws.share(f"{path}.ground_range")))
    side = 1.0 if draws.share(f"{path}.side") < 0.5 else -1.0
    line = tow_line_at(scene, np.array([along * (scene.track.pings - 1)]))
    x, y, heading = (float(column[0]) for column in line)
    place = x - side * across * math.sin(heading), y + side * across * math.cos(heading)
    return [round(coordinate, DIGITS) for coordinate in place]


def _quantile(declared: Any, share: float) -> Any:
    return declared.quantile(share) if hasattr(declared, "quantile") else declared


def _anywhere(scene: Scene) -> Uniform:
    """Ground ranges from one altitude to most of the range."""
    altitude = scene.altitude
    farthest = FARTHEST * math.sqrt(max(scene.sonar.range**2 - altitude**2, 0.0))
    if farthest <= altitude:
        raise SceneError(
            f"targets: no ground range is left between the altitude of {altitude:g} m and sonar.range "
            f"{scene.sonar.range:g} m; lower track.altitude or give ground_range"
        )
    return Uniform(low=altitude, high=farthest)
