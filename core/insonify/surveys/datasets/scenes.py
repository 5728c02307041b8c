"""Scenes of a data set: the base scene with values and targets drawn for each number."""

import hashlib
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np
from pydantic import ValidationError

from insonify.errors import located
from insonify.scene import Scene, SceneError, edit, plain
from insonify.scene.base import Model, is_field
from insonify.scene.faults import describe_fault
from insonify.scene.targets.shape import Outline
from insonify.surveys.datasets.specification import Chips, DatasetSpecification, Picture, Sampling, TargetGroup
from insonify.surveys.distributions import DistributionKind, OneOf, Uniform
from insonify.tow.line import tow_line_at

_Placed = tuple[list[float], "View"]
SEED_BITS = 53  # of a drawn seed: every reader of JSON keeps it exactly
GOLDEN = 0.5 * (math.sqrt(5.0) - 1.0)
FARTHEST_SHARE = 0.85  # of the ground range of the last bin, up to which targets lie
PARTS = 9  # of the values of every distribution, from which scenes are drawn to check a specification
ATTEMPTS = 200  # to find a place clear of the other targets
DIGITS = 3  # of places, in metres


def hash_share(seed: int, number: int, path: str) -> float:
    """Hash a seed, a number and a path to a uniform number inside (0, 1)."""
    digest = hashlib.blake2b(f"{seed}\n{number}\n{path}".encode(), digest_size=8).digest()
    return ((int.from_bytes(digest, "big") >> 12) + 0.5) * 2.0**-52


@dataclass
class Draws:
    """Values of one scene, and a record of them."""

    _seed: int
    _number: int
    _share_of_values: float | None = None  # that takes the place of those drawn for values
    drawn: dict[str, Any] = field(default_factory=dict)  # every value that was drawn, by its path

    def share(self, path: str) -> float:
        """Draw a number inside (0, 1) that is not recorded."""
        return hash_share(self._seed, self._number, path)

    def value(self, path: str, declared: Any) -> Any:
        """Draw a value from a distribution, and those within a table or a list; return any other value as it is."""
        if isinstance(declared, DistributionKind):
            chosen = declared.quantile(self._share_of_values or self.share(path))
            value = self.drawn[path] = self.value(f"{path}.of", chosen)
            return value
        if isinstance(declared, dict):
            return {name: self.value(f"{path}.{name}", part) for name, part in declared.items()}
        if isinstance(declared, list | tuple):
            return [self.value(f"{path}.{number}", part) for number, part in enumerate(declared)]
        return declared

    def table(self, model: type[Model], path: str, declared: Mapping[str, Any]) -> Model:
        """Draw the fields of a declaration."""
        try:
            return model.model_validate({name: self.value(f"{path}.{name}", part) for name, part in declared.items()})
        except ValidationError as error:
            raise SceneError(f"{path.partition('.')[0]}.{describe_fault(error, model)}") from None

    def seed(self, path: str) -> int:
        """Draw the seed of a scene's random numbers."""
        seed = self.drawn[path] = int(self.share(path) * 2**SEED_BITS)
        return seed


class View(NamedTuple):
    """Where a record of a straight tow shows a target, or would show it."""

    target: int | None  # index in the scene; None of a target that was left out
    along: float  # share of the tow
    channel: int  # side of the record, 0 to port and 1 to starboard
    ground_range: float  # m
    length: float  # m, of the target, or its breadth where that is more


class DrawnScene(NamedTuple):
    """One scene of a data set."""

    number: int  # from 0
    scene: Scene
    split: str
    classes: dict[int, str]  # class of each drawn target by its index in the scene
    draws: Draws  # by which it was drawn
    views: tuple[View, ...] = ()  # of the targets


def split_of(splits: Mapping[str, float], number: int) -> str:
    """Return the split of a job by its number: any run of numbers has nearly the specified shares."""
    place = ((number + 1) * GOLDEN) % 1.0 * sum(splits.values())
    for name, share in splits.items():
        place -= share
        if place < 0.0:
            return name
    return name


def check_draws(specification: DatasetSpecification, base: Scene) -> None:
    """Refuse misspelt fields, draws of chips and pictures out of bounds, and values of which no scene can be made.

    A scene that only some of the values make impossible is left to its job.
    """
    groups = [("targets.0.", f"targets.{group.name}.", group.set) for group in specification.targets]
    for place, written, table in [("", "", specification.set), *groups]:
        names = (name for path, declared in table.items() for name in _paths(path, declared))
        strange = next((name for name in names if not is_field(Scene, f"{place}{name}")), None)
        if strange is not None:
            raise SceneError(f"set: {written}{strange} is not a field of a scene; correct its name")
    faults = []
    # The first scene without targets of a class, 0 if there is none among the first hundred.
    shares = (hash_share(specification.seed, number, "negatives") for number in range(100))
    negative = next((number for number, share in enumerate(shares) if share < specification.negatives), 0)
    for part in range(PARTS):
        share = (part + 0.5) / PARTS
        for name, model in (("chips", Chips), ("picture", Picture)):
            Draws(specification.seed, part, share).table(model, name, getattr(specification, name) or {})
        try:
            draw_scene(specification, base, negative if part % 2 else 0, share)
        except SceneError as fault:
            faults.append(fault)
    if len(faults) == PARTS:
        raise faults[0]


def _paths(path: str, declared: Any) -> Iterator[str]:
    """Paths of all fields that a value sets, in whatever part of a choice."""
    if isinstance(declared, OneOf):
        for part in declared.of:
            yield from _paths(path, part)
    elif isinstance(declared, dict):
        for name, part in declared.items():
            yield from _paths(f"{path}.{name}", part)
    elif isinstance(declared, list | tuple):
        for number, part in enumerate(declared):
            yield from _paths(f"{path}.{number}", part)
    else:
        yield path


def draw_scene(
    specification: DatasetSpecification, base: Scene, number: int, share_of_values: float | None = None
) -> DrawnScene:
    """Draw one scene of a data set; a given share takes the place of those that are drawn for its values."""
    draws = Draws(specification.seed, number, share_of_values)
    with located(f"scene {number}: "):
        changes: dict[str, Any] = {"seed": draws.seed("seed")}
        changes |= {path: draws.value(path, declared) for path, declared in specification.set.items()}
        scene = edit(base, changes)
        is_negative = draws.share("negatives") < specification.negatives
        # Chips of a bed are cut as those of a target on it, which is drawn and left out.
        groups = () if is_negative and specification.chips is None else _groups(specification, draws)
        scene, classes, views = _put_targets(scene, specification, groups, draws)
        if is_negative and classes:
            kept = plain(scene)["targets"][: len(scene.targets) - len(classes)]
            scene, classes, views = edit(scene, {"targets": kept}), {}, [view._replace(target=None) for view in views]
    split = split_of(specification.splits, number // specification.storage.scenes)
    return DrawnScene(number, scene, split, classes, draws, tuple(views))


def _groups(specification: DatasetSpecification, draws: Draws) -> Sequence[TargetGroup]:
    """Return the groups of which a scene has targets."""
    groups = specification.targets
    if specification.groups == "all" or not groups:
        return groups
    weights = OneOf(of=tuple(range(len(groups))), weights=tuple(group.weight for group in groups))
    return (groups[weights.quantile(draws.share("groups"))],)


class _Wanted(NamedTuple):
    """A target to be put into a scene."""

    group: TargetGroup
    path: str  # that begins the paths of its draws
    shape: dict[str, Any]


def _put_targets(
    scene: Scene, specification: DatasetSpecification, groups: Sequence[TargetGroup], draws: Draws
) -> tuple[Scene, dict[int, str], list[View]]:
    """Put the targets of all groups into a scene; return their classes and views too."""
    wanted = [one for group in groups for one in _wanted(group, draws)]
    sampling = None if specification.sampling is None else draws.table(Sampling, "sampling", specification.sampling)
    if not wanted:
        scene = scene if sampling is None else edit(scene, sampling.changes(scene, None))
        if specification.chips is None:
            return scene, {}, []
        length = (sampling or Sampling()).length * scene.sonar.range / scene.sonar.bins
        bed = TargetGroup(name="bed", of=("drum",))
        view = _place(scene, _Wanted(bed, "bed", {}), "bed", draws)[1]
        return scene, {}, [view._replace(length=length)]
    first = len(scene.targets)
    bare = [{**one.shape, "position": [0.0, 0.0]} for one in wanted]
    changes: dict[str, Any] = {
        f"targets.{first + n}.{path}": draws.value(f"{one.path}.{path}", declared)
        for n, one in enumerate(wanted)
        for path, declared in one.group.set.items()
    }
    own = [target.model_dump(mode="json", exclude_none=True) for target in scene.targets]
    scene = edit(scene, {"targets": own + bare, **changes})
    outlines = [target.outline for target in scene.targets[first:]]
    if sampling is not None:
        height = outlines[0].extent((0.0, 0.0, 1.0))
        scene = edit(scene, sampling.changes(scene, _length(outlines[0]), height))
    placed = _places(scene, wanted, [outline.radius for outline in outlines], draws)
    scene = edit(scene, {f"targets.{first + n}.position": place for n, (place, _) in enumerate(placed)})
    views = [
        view._replace(target=first + n, length=_length(outline))
        for n, (outline, (_, view)) in enumerate(zip(outlines, placed))
    ]
    return scene, {first + n: one.group.name for n, one in enumerate(wanted)}, views


def _length(outline: Outline) -> float:
    """Length of a target on the bed, or its breadth where that is more, as of the wings of an aircraft; in metres."""
    return 2.0 * max(outline.extent((1.0, 0.0, 0.0)), outline.extent((0.0, 1.0, 0.0)))


def _wanted(group: TargetGroup, draws: Draws) -> Iterator[_Wanted]:
    """Targets of one group."""
    count = draws.value(f"targets.{group.name}.count", group.count)
    if not (isinstance(count, int) and 0 <= count <= 1000):
        raise SceneError(f"targets.{group.name}.count: {count!r} is not a number of targets; give 0 to 1000")
    for number in range(count):
        path = f"targets.{group.name}.{number}"
        shape = draws.value(f"{path}.of", group.of[int(draws.share(f"{path}.of") * len(group.of))])
        draws.drawn[f"{path}.of"] = shape
        yield _Wanted(group, path, {"kind": "mesh", "path": shape} if isinstance(shape, str) else dict(shape))


def _places(scene: Scene, wanted: Sequence[_Wanted], radii: Sequence[float], draws: Draws) -> list[_Placed]:
    """Places of targets on the bed, clear of one another."""
    taken: list[_Placed] = []
    for one, radius in zip(wanted, radii):
        for attempt in range(ATTEMPTS):
            placed = _place(scene, one, f"{one.path}.{attempt}", draws)
            if all(math.dist(placed[0], other) > radius + beside for (other, _), beside in zip(taken, radii)):
                break
        else:
            raise SceneError(
                f"targets.{one.group.name}: {len(wanted)} targets do not fit side by side; lower count, or "
                "widen along and ground_range"
            )
        draws.drawn[f"{one.path}.position"] = placed[0]
        taken.append(placed)
    return taken


def _place(scene: Scene, wanted: _Wanted, path: str, draws: Draws) -> _Placed:
    """Place abeam of the tow, to port or to starboard, and its view."""
    along = float(_quantile(wanted.group.along, draws.share(f"{path}.along")))
    beside = wanted.group.ground_range or _anywhere(scene)
    across = float(_quantile(beside, draws.share(f"{path}.ground_range")))
    side = 1.0 if draws.share(f"{path}.side") < 0.5 else -1.0
    line = tow_line_at(scene, np.array([along * (scene.track.pings - 1)]))
    x, y, heading = (float(column[0]) for column in line)
    place = x - side * across * math.sin(heading), y + side * across * math.cos(heading)
    return [round(coordinate, DIGITS) for coordinate in place], View(None, along, int(side < 0.0), across, 0.0)


def _quantile(declared: Any, share: float) -> Any:
    return declared.quantile(share) if hasattr(declared, "quantile") else declared


def _anywhere(scene: Scene) -> Uniform:
    """Ground ranges from one altitude to most of the range."""
    altitude = scene.altitude
    farthest = FARTHEST_SHARE * math.sqrt(max(scene.sonar.range**2 - altitude**2, 0.0))
    if farthest <= altitude:
        raise SceneError(
            f"targets: no ground range is left between the altitude of {altitude:g} m and sonar.range "
            f"{scene.sonar.range:g} m; lower track.altitude or give ground_range"
        )
    return Uniform(low=altitude, high=farthest)
