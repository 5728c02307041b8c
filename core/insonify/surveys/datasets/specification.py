"""Specification of a data set: what its scenes have in common, what is drawn for each, and what is stored."""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import Field, field_validator, model_validator

from insonify.files import bundled_meshes
from insonify.scene import DEFAULT_SCENE
from insonify.scene.base import Declaration, FilePath, KindOf, Words, parameter
from insonify.surveys.annotations import ANNOTATIONS, AnnotationKind
from insonify.surveys.distributions import Drawn
from insonify.surveys.distributions.uniform import Uniform
from insonify.surveys.engine import FLAGS
from insonify.surveys.storages import STORAGES, Files, StorageKind

Name = Annotated[str, Field(pattern=r"^[A-Za-z0-9][\w-]*$", max_length=60)]


class TargetGroup(Declaration):
    """Targets of one class, drawn anew for every scene."""

    name: Name = parameter(description="class of the targets in annotations")
    of: tuple[Any, ...] = parameter(
        description="what a target may be: names of the library, or tables such as those of a scene",
        min_length=1,
    )
    count: Drawn = parameter(1, description="how many there are in a scene: a whole number, or a distribution of it")
    along: Drawn = parameter(
        Uniform(low=0.05, high=0.95), description="where they lie along the tow, as a share of it, 0 to 1"
    )
    ground_range: Drawn = parameter(
        None,
        unit="m",
        description="how far abeam of the tow; from one altitude to most of the range when left out",
    )
    set: dict[str, Drawn] = parameter({}, description="fields of the target by their paths: values or distributions")

    @model_validator(mode="after")
    def _names_of_the_library(self) -> TargetGroup:
        known = bundled_meshes()
        strange = next((one for one in self.of if isinstance(one, str) and one not in known), None)
        if strange is not None:
            raise ValueError(
                f"of: {strange!r} is not in the library of targets; choose from {', '.join(known)}, or write "
                '{ kind = "mesh", path = … }'
            )
        return self


class Tiles(Declaration):
    """How records are cut."""

    pings: int = parameter(256, description="height of a tile, in pings", ge=8, le=16384)
    bins: int = parameter(256, description="width of a tile, in range bins", ge=8, le=16384)
    overlap: float = parameter(0.0, description="share of a tile that the next one shows again", ge=0.0, le=0.9)
    empty: float = parameter(
        1.0, description="share of the tiles without a target of a class that is kept, 0 to 1", ge=0.0, le=1.0
    )
    least: float = parameter(
        0.1, description="share of a target that a tile shows at least if it is annotated there", ge=0.0, le=1.0
    )


class Images(Declaration):
    """Grey levels of images: decibels relative to the median of the record at that range."""

    bits: int = parameter(8, description="bits of a grey level: 8 or 16")
    low: float = parameter(-25.0, unit="dB", description="level that is black, as silence is", ge=-200.0, le=200.0)
    high: float = parameter(20.0, unit="dB", description="level that is white", ge=-200.0, le=200.0)

    @model_validator(mode="after")
    def _levels(self) -> Images:
        if self.bits not in (8, 16):
            raise ValueError(f"bits: {self.bits} are not written; give 8 or 16")
        if self.low >= self.high:
            raise ValueError(f"low {self.low:g} dB is not below high {self.high:g} dB; exchange them")
        return self


class DatasetSpecification(Declaration):
    """Everything that a data set depends on."""

    title: Words = parameter("Untitled", description="what the data set shows", max_length=200)
    description: Words = parameter("", description="a paragraph about it", max_length=5000)
    seed: int = parameter(1, description="seed of all that is drawn", ge=0, le=2**63 - 1)
    scenes: int = parameter(100, description="number of scenes", ge=1, le=10_000_000)
    base: FilePath = parameter(DEFAULT_SCENE, description="bundled scene, or TOML file, that all scenes begin with")
    set: dict[str, Drawn] = parameter({}, description="fields of the scene by their paths: values or distributions")
    targets: tuple[TargetGroup, ...] = parameter((), description="classes of targets")
    negatives: float = parameter(0.2, description="share of the scenes that have none of these targets", ge=0.0, le=1.0)
    tiles: Tiles = parameter(Tiles(), description="how records are cut")
    images: Images = parameter(Images(), description="grey levels of images")
    splits: dict[Name, Annotated[float, Field(gt=0.0)]] = parameter(
        {"train": 0.8, "validation": 0.1, "test": 0.1},
        description="shares of the scenes in each split, in any unit",
        min_length=1,
    )
    annotations: tuple[Annotated[AnnotationKind, KindOf(ANNOTATIONS)], ...] = parameter(
        ("coco", "yolo"), description="formats of annotations"
    )
    storage: Annotated[StorageKind, KindOf(STORAGES)] = parameter(Files(), description="how images are stored")

    @field_validator("splits")
    @classmethod
    def _no_split_is_a_folder_of_flags(cls, splits: dict[str, float]) -> dict[str, float]:
        if any(name.lower() == FLAGS for name in splits):
            raise ValueError(f"a split may not be named {FLAGS!r}, the folder of finished jobs; rename it")
        return splits

    @model_validator(mode="after")
    def _classes_differ(self) -> DatasetSpecification:
        names = self.classes
        twice = next((name for name in names if names.count(name) > 1), None)
        if twice is not None:
            raise ValueError(f"targets: the class {twice!r} is there twice; join the two, or rename one")
        return self

    @model_validator(mode="after")
    def _whole_jobs(self) -> DatasetSpecification:
        together = self.storage.scenes
        if self.scenes % together:
            whole = together * (self.scenes // together + 1)
            raise ValueError(
                f"scenes: {self.scenes} is no multiple of storage.scenes {together}, which are stored together; "
                f"give {whole}"
            )
        return self

    @property
    def classes(self) -> list[str]:
        """Classes of targets, in order."""
        return [group.name for group in self.targets]
