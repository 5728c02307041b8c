"""Work of a data set: each job draws some scenes, simulates them, and stores the tiles of their records."""

import hashlib
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, Self

from insonify.scene import Scene, edit, scene_to_toml
from insonify.simulation import simulate
from insonify.surveys.datasets.chips import cut_chips
from insonify.surveys.datasets.scenes import DrawnScene, draw_scene, hash_share
from insonify.surveys.datasets.specification import DatasetSpecification
from insonify.surveys.datasets.tiles import cut_tiles
from insonify.surveys.engine import digest_of, job_number, name_job, shelf_of
from insonify.surveys.specification import contents_of
from insonify.surveys.storages import Tile

WARMING = 4  # pings of a scene that compiles the kernels


@dataclass(frozen=True)
class DatasetWork:
    """The jobs of a data set."""

    specification: DatasetSpecification
    base: Scene  # scene that all others begin with
    folder: Path  # of the data set

    @cached_property
    def digest(self) -> str:
        """Hash of all that every job depends on."""
        # A data set may grow: no scene depends on their number.
        return digest_of(*contents_of(self.specification, self.base, "scenes"))

    def names(self) -> list[str]:
        """Names of all jobs."""
        jobs = self.specification.scenes // self.specification.storage.scenes
        return [name_job(number, self.digest) for number in range(jobs)]

    def make(self, name: str, beside: Path) -> dict[str, Any]:
        """Simulate the scenes of a job, store their tiles below a folder, and describe both."""
        job, together = job_number(name), self.specification.storage.scenes
        tiles: list[Tile] = []
        scenes = []
        for number in range(job * together, (job + 1) * together):
            drawn = draw_scene(self.specification, self.base, number)
            tiles += self._tiles_of(drawn)
            toml = scene_to_toml(drawn.scene)
            digest = hashlib.sha256(toml.encode()).hexdigest()[:16]
            scenes.append({"scene": number, "hash": digest, "drawn": drawn.draws.drawn, "toml": toml})
        if tiles:
            self.specification.storage.write(beside, f"{job:07d}", shelf_of(job), tiles)
        return {"made": len(tiles), "scenes": scenes, "tiles": [tile.description for tile in tiles]}

    def begun(self) -> Self:
        """Return the work as it is: scenes have nothing to share."""
        return self

    def warm_up(self) -> None:
        """Simulate a few pings of the first scene."""
        scene = draw_scene(self.specification, self.base, 0).scene
        few = edit(scene, {"track.pings": min(WARMING, scene.track.pings)})
        simulate(few, truth="targets", tolerance=self.specification.tolerance)  # as `cut` does

    def cut(self, drawn: DrawnScene) -> Iterator[Tile]:
        """Simulate a scene and cut its record."""
        wanted = self.specification
        record = simulate(drawn.scene, truth="targets", tolerance=wanted.tolerance)
        if wanted.chips is not None:
            return cut_chips(drawn, record, wanted)
        return cut_tiles(drawn, record, wanted.classes, wanted.tiles, wanted.images)

    def _tiles_of(self, drawn: DrawnScene) -> Iterator[Tile]:
        """Tiles of one scene that are kept, annotated."""
        wanted, classes = self.specification, self.specification.classes
        for tile in self.cut(drawn):
            description = tile.description
            # Chips, and tiles with targets, are always kept; a share of the empty tiles is kept at random.
            always = wanted.chips is not None or description["targets"]
            share = hash_share(wanted.seed, description["scene"], description["name"])
            if not always and share >= wanted.tiles.empty:
                continue
            for kind in wanted.annotations:
                tile.labels.update(kind.of_tile(description, classes))
            yield tile
