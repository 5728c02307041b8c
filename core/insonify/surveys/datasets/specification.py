"""Specification of a data set: what its scenes have in common, what is drawn for each, and what is stored."""

import math
from collections.abc import Iterator
from functools import partial
from typing import Annotated, Any, Literal, Self

import numpy as np
from pydantic import AfterValidator, Field, field_validator, model_validator

from insonify.files import bundled_meshes
from insonify.operating_system import is_portable
from insonify.scene import PLAIN_SCENE, Scene, SceneError
from insonify.scene.base import Declaration, FilePath, KindOf, Words, parameter
from insonify.surveys.annotations import ANNOTATIONS, AnnotationKind
from insonify.surveys.distributions import Drawn, Uniform
from insonify.surveys.engine import FLAGS
from insonify.surveys.storages import STORAGES, Files, StorageKind

CLEAR = 1.2  # altitude over the height of a target, at least
LEAST_FREQUENCY, MOST_FREQUENCY = 5e4, 2e6  # Hz, of a sonar whose frequency follows from the grain of its speckle
SOUND_SPEED = 1500.0  # m/s, by which lengths of range become times
Name = Annotated[str, Field(pattern=r"^[A-Za-z0-9][\w-]*$", max_length=60)]


class TargetGroup(Declaration):
    """Targets of one class, drawn again for every scene."""

    name: Name = parameter(description="class of the targets in annotations")
    of: tuple[Drawn, ...] = parameter(
        description="choices for a target: names of the library, or tables such as those of a scene", min_length=1
    )
    count: Drawn = parameter(1, "number of targets in a scene: a whole number, or a distribution")
    along: Drawn = parameter(Uniform(low=0.05, high=0.95), "position along the tow, as a share of its length")
    ground_range: Drawn = parameter(
        None, "distance abeam of the tow; from one altitude to most of the range when left out", "m"
    )
    weight: float = parameter(1.0, "relative frequency of this group, where a scene has one group only", gt=0.0)
    set: dict[str, Drawn] = parameter({}, "fields of the target by their paths: values or distributions")

    @model_validator(mode="after")
    def _names_of_the_library(self) -> Self:
        known = bundled_meshes()
        strange = next((one for one in self.of if isinstance(one, str) and one not in known), None)
        if strange is not None:
            raise ValueError(
                f"of: {strange!r} is not in the library of targets; choose from {', '.join(known)}, or write "
                '{ kind = "mesh", path = … }'
            )
        return self


class Evidence(Declaration):
    """What must be seen of a target for it to be annotated."""

    least: float = parameter(0.1, "least share of a target within a tile for which it is annotated", ge=0.0, le=1.0)
    contrast: float = parameter(
        1.0, "least contrast with the bed beside it, over the scatter of the bed's levels", ge=0.0, le=100.0
    )


class Tiles(Evidence):
    """How records are cut."""

    pings: int = parameter(256, "height of a tile, in pings", ge=8, le=16384)
    bins: int = parameter(256, "width of a tile, in range bins", ge=8, le=16384)
    overlap: float = parameter(0.0, "share of a tile that the next one repeats", ge=0.0, le=0.9)
    empty: float = parameter(1.0, "share of the tiles without a target of a class that is kept, 0 to 1", ge=0.0, le=1.0)


class Images(Declaration):
    """Grey levels of images: decibels relative to the median of the record at that range."""

    bits: int = parameter(8, "bits of a grey level: 8 or 16")
    low: float = parameter(-25.0, "level that is black, as is silence", "dB", ge=-200.0, le=200.0)
    high: float = parameter(20.0, "level that is white", "dB", ge=-200.0, le=200.0)

    @model_validator(mode="after")
    def _levels(self) -> Self:
        if self.bits not in (8, 16):
            raise ValueError(f"bits: {self.bits} is not possible; give 8 or 16")
        if self.low >= self.high:
            raise ValueError(f"low {self.low:g} dB is not below high {self.high:g} dB; swap them")
        return self


class Sampling(Declaration):
    """How finely a sonar samples a target, which sets lengths of the scene in proportion."""

    length: float = parameter(120.0, "bins that the target's length spans", gt=0.0, le=1e4)
    bin: float | None = parameter(
        None, "length of a range bin, in place of length; for scenes without targets", "m", gt=0.0, le=100.0
    )
    step: float = parameter(1.0, "distance from ping to ping, in bins", gt=0.0, le=100.0)
    altitude: float | None = parameter(None, "altitude over the range", gt=0.0, lt=1.0)
    pulse: float | None = parameter(None, "range resolution of the pulse, in bins", gt=0.0, le=100.0)
    beam: float | None = parameter(
        None, "width of the beam at half of the range, in steps of the track", gt=0.0, le=1000.0
    )
    grain: float | None = parameter(
        None,
        "correlation length of speckle along the tow, in steps of the track; with the beam it sets the frequency",
        gt=0.0,
        le=1000.0,
    )
    node: float | None = parameter(None, "spacing of the nodes of the relief, in bins", gt=0.0, le=100.0)
    relief: bool = parameter(False, "whether lengths in seabed.relief are given in range bins")
    snr: float | None = parameter(
        None, "mean echo of the bed over the noise, at 0.7 of the range", "dB", ge=-100.0, le=200.0
    )

    def changes(self, scene: Scene, length: float | None, height: float = 0.0) -> dict[str, Any]:
        """Fields of a scene, given the length and the height of its target in metres."""
        if self.bin is None and length is None:
            raise SceneError("sampling.length: the scene has no target; give sampling.bin, or a group of targets")
        unit = self.bin or float(length or 0.0) / self.length
        reach, speed = unit * scene.sonar.bins, SOUND_SPEED
        rate = min(0.45 * speed / reach, 50.0)
        step = self.step * unit
        found: dict[str, Any] = {"sonar.range": reach, "sonar.ping_rate": rate, "track.speed": step * rate}
        if self.altitude is not None:
            altitude = max(self.altitude * reach, CLEAR * height)
            found |= {"track.altitude": altitude, "seabed.depth": max(scene.seabed.depth, 1.5 * altitude)}
        if self.pulse is not None:
            found |= {"sonar.pulse": {"kind": "tone", "duration": 2.0 * self.pulse * unit / speed}}
        if self.beam is not None:
            width = math.degrees(math.atan(self.beam * step / (0.5 * reach)))
            width = min(max(width, 0.02), 40.0)
            found |= {"sonar.beam": {"kind": "gaussian", "width": width}}
            if self.grain is not None:
                # Echoes correlate over half of the array, a wavelength over twice the beam.
                wavelength = 2.0 * math.radians(width) * self.grain * step
                found |= {"sonar.frequency": float(np.clip(speed / wavelength, LEAST_FREQUENCY, MOST_FREQUENCY))}
        if self.node is not None:
            found |= {"seabed.spacing": self.node * unit}
        if self.relief:
            found |= {f"seabed.relief{path}": unit * value for path, value in lengths_of(scene.seabed.relief)}
        if self.snr is not None:
            found |= {"receiver.noise": {"kind": "snr", "value": self.snr, "at": 0.7 * reach}}
        return found


def lengths_of(declared: Declaration, path: str = "") -> Iterator[tuple[str, float]]:
    """Paths and values of the fields in metres of a declaration and of those within."""
    for name, field in type(declared).model_fields.items():
        value, extra = getattr(declared, name), field.json_schema_extra
        if isinstance(value, float) and isinstance(extra, dict) and extra.get("unit") == "m":
            yield f"{path}.{name}", value
        for number, part in enumerate(value if isinstance(value, tuple) else [value]):
            if isinstance(part, Declaration):
                yield from lengths_of(part, f"{path}.{name}.{number}" if isinstance(value, tuple) else f"{path}.{name}")


class Chips(Evidence):
    """Pictures about each target, and as many of the bed across the tow."""

    pixels: int = parameter(128, "longer side of a picture", ge=16, le=2048)
    about: Literal["length", "extent"] = parameter(
        "length", "length: a square about the target; extent: its echo and shadow together, with an even border"
    )
    margin: float = parameter(
        1.6, "longer side of the window, in lengths of the target or of the extent", gt=0.1, le=50.0
    )
    aspect: float = parameter(1.0, "length of the window along the tow over that across", gt=0.05, le=20.0)
    along: float = parameter(0.0, "along-track offset of the window from the target, in sides", ge=-1.0, le=1.0)
    across: float = parameter(0.0, "offset of the window away from the tow, in sides", ge=-1.0, le=1.0)
    turns: int = parameter(0, "rotation of the picture in quarter turns", ge=0, le=3)
    mirrored: bool = parameter(False, "whether the picture is mirrored")
    least: float = parameter(0.2, "least share of a target within the window", ge=0.0, le=1.0)


class Picture(Declaration):
    """How a chip is displayed."""

    scale: Literal["linear", "root", "log"] = parameter("log", "curve from amplitude to grey level")
    levelled: float = parameter(
        1.0, "1: divided by the median at each range; 0: as received after the gain", ge=0.0, le=1.0
    )
    black: float = parameter(1.0, "percentile that is black", "%", ge=0.0, le=60.0)
    white: float = parameter(99.5, "percentile that is white", "%", ge=60.5, le=100.0)
    grey: float | None = parameter(None, "grey of the median, between darkest and brightest", gt=0.0, lt=1.0)
    tone: Literal["exponent", "gain"] = parameter(
        "exponent", "how the median gets its grey: by an exponent, or by a gain, in place of white"
    )
    knee: float = parameter(
        1.0, "grey at which a primary of a coloured palette saturates, above which grey rises less", gt=0.0, le=1.0
    )
    darkest: float = parameter(0.0, "grey level of black, above 0 for little contrast", ge=0.0, lt=0.3)
    brightest: float = parameter(1.0, "grey level of white", ge=0.3, le=1.0)
    inverted: bool = parameter(False, "whether strong echoes are dark")
    ground_range: bool = parameter(False, "whether the picture is over ground range, without the water column")
    water_column: bool = parameter(True, "whether the picture includes the water column")
    along: float = parameter(1.0, "length of the average or repetition along the tow in pixels", ge=1.0, le=16.0)
    across: float = parameter(1.0, "length of the average or repetition across the tow in pixels", ge=1.0, le=16.0)
    samples: Literal["mean", "nearest"] = parameter(
        "mean", "mean: averages, interpolated between; nearest: single samples, repeated where pixels are finer"
    )
    jpeg: int | None = parameter(None, "JPEG quality of an earlier compression; none when left out", ge=5, le=100)
    lines: int = parameter(
        0, "least number of scale lines, at round distances; their spacing is the caption", ge=0, le=8
    )


def _check_draws(model: type[Declaration], table: dict[str, Any] | None) -> dict[str, Any] | None:
    """Check that a table of draws names fields of a declaration."""
    strange = next((name for name in table or () if name not in model.model_fields), None)
    if strange is not None:
        raise ValueError(f"{strange}: no such field; choose from {', '.join(model.model_fields)}")
    return table


class DatasetSpecification(Declaration):
    """Everything that a data set depends on."""

    title: Words = parameter("Untitled", "what the data set shows", max_length=200)
    description: Words = parameter("", "a paragraph about it", max_length=5000)
    seed: int = parameter(1, "seed of all random draws", ge=0, le=2**63 - 1)
    scenes: int = parameter(100, "number of scenes", ge=1, le=10_000_000)
    base: FilePath = parameter(PLAIN_SCENE, "bundled scene, or TOML file, from which all scenes are derived")
    set: dict[str, Drawn] = parameter({}, "fields of the scene by their paths: values or distributions")
    targets: tuple[TargetGroup, ...] = parameter((), "classes of targets")
    numbered: tuple[Name, ...] = parameter(
        (), "classes of this set and of those to be merged with it, in order of their numbers; its own when left out"
    )
    groups: Literal["all", "one"] = parameter("all", "whether a scene has targets of all groups or of one")
    tolerance: float = parameter(0.03, "accepted relative error of a record", gt=0.0, le=1.0)
    negatives: float = parameter(0.2, "share of the scenes without targets of these groups", ge=0.0, le=1.0)
    sampling: Annotated[dict[str, Drawn] | None, AfterValidator(partial(_check_draws, Sampling))] = parameter(
        None, "distributions of the fields of `Sampling`, which set how finely a target is sampled"
    )
    chips: Annotated[dict[str, Drawn] | None, AfterValidator(partial(_check_draws, Chips))] = parameter(
        None, "distributions of the fields of `Chips`, which cut windows about targets in place of tiles"
    )
    chips_each: int = parameter(1, "number of chips of each target and of the bed, each with new draws", ge=1, le=1000)
    picture: Annotated[dict[str, Drawn], AfterValidator(partial(_check_draws, Picture))] = parameter(
        {}, "distributions of the fields of `Picture`, which set how chips are displayed"
    )
    tiles: Tiles = parameter(Tiles, "how records are cut")
    images: Images = parameter(Images, "grey levels of images")
    splits: dict[Name, Annotated[float, Field(gt=0.0)]] = parameter(
        {"train": 0.8, "validation": 0.1, "test": 0.1}, "shares of the scenes in each split, in any unit", min_length=1
    )
    annotations: tuple[Annotated[AnnotationKind, KindOf(ANNOTATIONS)], ...] = parameter(
        ("coco", "yolo"), "formats of annotations"
    )
    storage: Annotated[StorageKind, KindOf(STORAGES)] = parameter(Files, "how images are stored")

    @field_validator("splits")
    @classmethod
    def _splits_are_folders_of_their_own(cls, splits: dict[str, float]) -> dict[str, float]:
        """Names must differ on systems, too, where *Train* and *train* are one folder, and *con* is a device."""
        if any(name.lower() == FLAGS for name in splits):
            raise ValueError(f"a split may not be named {FLAGS!r}, the folder of finished jobs; rename it")
        if refused := next((name for name in splits if not is_portable(name)), None):
            raise ValueError(f"a split may not be named {refused!r}, which Windows takes for a device; rename it")
        if len({name.lower() for name in splits}) < len(splits):
            raise ValueError("the names of two splits differ in the case of letters alone; rename one")
        return splits

    @model_validator(mode="after")
    def _classes_differ_and_jobs_are_whole(self) -> Self:
        names = [group.name for group in self.targets]
        twice = next((name for name in names if names.count(name) > 1), None)
        if twice is not None:
            raise ValueError(f"targets: the class {twice!r} is declared twice; merge the two, or rename one")
        if self.numbered and (strange := set(names) - set(self.numbered)):
            raise ValueError(f"numbered: lacks the class {min(strange)!r}; add it, or leave numbered out")
        together = self.storage.scenes
        if self.scenes % together:
            whole = together * (self.scenes // together + 1)
            raise ValueError(
                f"scenes: {self.scenes} is not a multiple of storage.scenes {together}, which are stored together; "
                f"give {whole}"
            )
        return self

    @property
    def classes(self) -> list[str]:
        """Classes of targets in the order of their numbers."""
        return list(self.numbered) or [group.name for group in self.targets]
