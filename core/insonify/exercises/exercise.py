"""An exercise: what its specification draws, and the file that holds it with the truth sealed."""

import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple, Self

import numpy as np
import tomli_w
from pydantic import model_validator

from insonify.arrays import Booleans, Floats
from insonify.errors import SceneError
from insonify.io.atomic import write_text
from insonify.io.file_access import LARGEST_TOML, FileFault, parse_toml, read_text
from insonify.io.georeference import to_degrees
from insonify.io.sealed import SUFFIX, seal, unseal
from insonify.scene import PLAIN_SCENE, Scene, edit, load_scene, plain
from insonify.scene.base import Coordinate, Declaration, FilePath, Words, parameter
from insonify.scene.edit import build
from insonify.scene.volumes import VOLUMES, Volume
from insonify.surveys.datasets.scenes import Draws
from insonify.surveys.datasets.specification import TargetGroup
from insonify.surveys.distributions import Drawn
from insonify.surveys.specification import read_specification

ATTEMPTS = 500  # to place a target clear of the others
CLEARANCE, EDGE = 6.0, 4.0  # m, between targets, and from the edge of the area's rectangle
SHALLOWEST, DEEPEST = 0.3, 0.7  # of the depth, between which schools of fish swim
MOST = 1000  # targets of a group


class HiddenGroup(TargetGroup):
    """Targets of one class, or schools of fish, somewhere in the area."""

    wanted: bool = parameter(False, "whether they are to be found; others are mistaken for them")


class ExerciseSpecification(Declaration):
    """What an exercise is drawn from."""

    title: Words = parameter("Untitled", "what it is", max_length=200)
    task: Words = parameter("", "what the student is told", max_length=5000)
    seed: int = parameter(1, "seed of what is drawn", ge=0)
    minutes: float = parameter(30.0, "time for the survey", "min", gt=0.0)
    base: FilePath = parameter(PLAIN_SCENE, "bundled scene, or TOML file")
    set: dict[str, Drawn] = parameter({}, "fields of the scene by their paths: values or distributions")
    area: tuple[tuple[Coordinate, Coordinate], ...] = parameter(unit="m", description="its corners", min_length=3)
    tolerance: float = parameter(3.0, "distance up to which a contact is that of a target", "m", gt=0.0)
    current: tuple[Drawn, Drawn] = parameter((0.0, 0.0), "drift along x and y: values or distributions", "m/s")
    targets: tuple[HiddenGroup, ...] = parameter(description="what is hidden", min_length=1)

    @model_validator(mode="after")
    def _has_a_task(self) -> Self:
        if not any(group.wanted for group in self.targets):
            raise ValueError("targets: none is wanted; set wanted = true in one of them")
        return self


class Hidden(NamedTuple):
    """A target of an exercise."""

    name: str  # its class
    wanted: bool
    x: float
    y: float
    height: float  # above the bed


@dataclass(frozen=True, eq=False)
class Exercise:
    """An exercise with its truth."""

    title: str
    task: str
    minutes: float
    area: Floats  # (n, 2) corners in metres of the scene
    tolerance: float
    scene: Scene
    hidden: tuple[Hidden, ...]
    current: tuple[float, float]

    @property
    def bare(self) -> Scene:
        """The scene as the student may see it: without what is to be found."""
        return edit(self.scene, {"targets": [], "volumes": []})

    def hide_in(self, scene: Scene) -> Scene:
        """Return a scene, such as the bare one with another range, with what is to be found."""
        return edit(scene, {name: plain(self.scene).get(name, []) for name in ("targets", "volumes")})


def make_exercise(name: str, seed: int | None = None) -> dict[str, Any]:
    """Draw an exercise from a specification: the content of its file."""
    changes = {} if seed is None else {"seed": seed}
    wanted = read_specification(name, ExerciseSpecification, "exercises", **changes)
    draws, corners = Draws(wanted.seed, 0), np.array(wanted.area)
    drawn = {path: draws.value(path, value) for path, value in wanted.set.items()}
    drawn |= {"seed": draws.seed("seed"), "title": wanted.title, "description": wanted.task, "targets": []}
    scene, places = edit(load_scene(wanted.base), drawn), list[tuple[float, float]]()
    groups, found = [], {"targets": list[dict[str, Any]](), "volumes": list[dict[str, Any]]()}
    for group in wanted.targets:
        count = draws.value(f"targets.{group.name}.count", group.count)
        if not (isinstance(count, int) and 0 <= count <= MOST):
            raise SceneError(f"targets.{group.name}.count: {count!r} is not a number; give 0 to {MOST}")
        for path in (f"targets.{group.name}.{number}" for number in range(count)):
            shape = draws.value(f"{path}.of", group.of[int(draws.share(f"{path}.of") * len(group.of))])
            shape = {"kind": "mesh", "path": shape} if isinstance(shape, str) else dict(shape)
            shape |= {field: draws.value(f"{path}.{field}", value) for field, value in group.set.items()}
            places.append(_place(draws, path, corners, places))
            if shape["kind"] in VOLUMES.models(Volume):
                z = -scene.seabed.depth * (SHALLOWEST + (DEEPEST - SHALLOWEST) * draws.share(f"{path}.z"))
                found["volumes"].append(shape | {"position": [*places[-1], z]})
            else:
                found["targets"].append(shape | {"position": list(places[-1])})
                groups.append((group, places[-1]))
    scene = edit(scene, found)
    heights = [2.0 * each.outline.extent((0.0, 0.0, 1.0)) + float(getattr(each, "gap", 0.0)) for each in scene.targets]
    hidden = [Hidden(each.name, each.wanted, *place, height) for (each, place), height in zip(groups, heights)]
    current = [float(draws.value(f"current.{axis}", value)) for axis, value in enumerate(wanted.current)]
    content = {name: getattr(wanted, name) for name in ("title", "task", "minutes", "tolerance")}
    content["area"], place = corners.tolist(), scene.georeference
    if place is not None and place.crs:  # for survey programs
        content["area_on_earth"] = np.round(np.stack(to_degrees(place, *corners.T), axis=1), 7).tolist()
    return content | seal({"scene": plain(scene), "hidden": hidden, "current": current})


def write_exercise(path: Path, content: dict[str, Any]) -> None:
    """Write the file of an exercise."""
    write_text(path, tomli_w.dumps(content, multiline_strings=True))


def read_exercise(path: str | Path) -> Exercise:
    """Read the file of an exercise, with its truth."""
    try:
        if Path(path).suffix.lower() != SUFFIX:
            raise FileFault("is not an exercise", f"give a file that ends in {SUFFIX}")
        table = parse_toml(read_text(path, largest=LARGEST_TOML))
        values, known = unseal(table), {name: table[name] for name in ("title", "task", "minutes", "tolerance")}
        known["area"], known["scene"] = np.array(table["area"], dtype=np.float64), build(values["scene"])
        return Exercise(**known, hidden=tuple(Hidden(*each) for each in values["hidden"]), current=values["current"])
    except (FileFault, OSError) as fault:
        raise SceneError(f"{Path(path).name}: {fault}") from None
    except (KeyError, TypeError, ValueError) as error:
        raise SceneError(f"{Path(path).name}: lacks a part ({error}); make it again") from None


def lie_within(corners: Floats, points: Floats) -> Booleans:
    """Whether points, (n, 2), lie within the area of some corners."""
    # lazy: slow to import
    from skimage.measure import points_in_poly

    return np.asarray(points_in_poly(points, corners), np.bool_)  # type: ignore[no-untyped-call]


def _place(draws: Draws, path: str, corners: Floats, taken: list[tuple[float, float]]) -> tuple[float, float]:
    """Place within an area, clear of others."""
    low, high = corners.min(axis=0) + EDGE, corners.max(axis=0) - EDGE
    for attempt in range(ATTEMPTS):
        shares = [draws.share(f"{path}.{attempt}.{axis}") for axis in "xy"]
        x, y = (round(float(value), 3) for value in low + (high - low) * shares)
        if lie_within(corners, np.array([[x, y]]))[0] and all(math.dist((x, y), each) > CLEARANCE for each in taken):
            return x, y
    raise SceneError(f"{path}: finds no free place in the area; make it larger or lower count")
