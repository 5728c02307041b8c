"""Scene: the complete declaration of a simulation."""

from collections.abc import Iterator
from typing import Any, Literal, Self

import tomli_w
from pydantic import field_validator, model_validator

from insonify.cards import make_card, quote_text
from insonify.errors import SceneError
from insonify.io.georeference import Georeference
from insonify.scene.base import Coordinate, Declaration, Words, is_field, parameter
from insonify.scene.links import Link, split_description
from insonify.scene.receiver import Receiver
from insonify.scene.seabed import Seabed
from insonify.scene.sonar import Sonar
from insonify.scene.sonar.presets import with_preset
from insonify.scene.targets import AnyTarget, Pit
from insonify.scene.track import Track
from insonify.scene.volumes import AnyVolume
from insonify.scene.water import AnyWater, UniformWater

DEFAULT_ALTITUDE = 10.0
SCHEMA = 1
MOST_NAMED = 12  # targets in a card
MOST_TARGETS = 10_000  # twenty times as many took two minutes to pack
# Limits of bed cells along a range: a slice takes a dozen knots per cell, and endless ground is stored as a square.
MOST_CELLS, MOST_ENDLESS_CELLS = 262_144, 4096


class World(Declaration):
    """Place of the scene's own coordinates on Earth."""

    origin: tuple[Coordinate, Coordinate] | None = parameter(
        None, "map coordinates of the scene's (0, 0); a DEM's centre when left out", "m"
    )
    crs: str = parameter("", "coordinate reference system of the origin, such as EPSG:32631")


class Scene(Declaration):
    """Everything a record depends on; immutable, so an edit makes a new one."""

    schema_version: Literal[1] = parameter(SCHEMA, "version of the scene format")
    title: Words = parameter("Untitled", "what the scene shows", max_length=200)
    description: Words = parameter(
        "",
        "what the scene shows and what to change; [words](path.to.field=value) link to a value to try",
        max_length=5000,
    )
    controls: tuple[str, ...] = parameter(
        (), "dotted paths of the main fields of the scene; the viewer pins them on top", max_length=6
    )
    partner: tuple[str, ...] | None = parameter(
        None, "scene to compare with: name or TOML file (this scene when left out), then settings path=value"
    )
    seed: int = parameter(1, "seed of all random numbers", ge=0, le=2**63 - 1)
    world: World = parameter(World, "geographic position and map coordinates")
    seabed: Seabed = parameter(Seabed, "the bed")
    targets: tuple[AnyTarget, ...] = parameter((), "targets on the bed", max_length=MOST_TARGETS)
    volumes: tuple[AnyVolume, ...] = parameter((), "schools and plumes in the water column", max_length=MOST_TARGETS)
    water: AnyWater = parameter(UniformWater, "speed of sound and absorption of the water")
    sonar: Sonar = parameter(Sonar, "the sonar")
    track: Track = parameter(Track, "the tow")
    receiver: Receiver = parameter(Receiver, "the receiver")

    @model_validator(mode="before")
    @classmethod
    def _sonar_by_name(cls, values: Any) -> Any:
        return with_preset(values)

    @field_validator("controls")
    @classmethod
    def _controls_are_fields(cls, controls: tuple[str, ...]) -> tuple[str, ...]:
        for path in controls:
            if not is_field(cls, path):
                raise ValueError(
                    f"{path[:40]!r} is not a field of a scene; write its dotted path, such as 'track.altitude'"
                )
        return controls

    @field_validator("description")
    @classmethod
    def _links_lead_to_fields(cls, description: str) -> str:
        for part in split_description(description):
            if isinstance(part, Link) and not is_field(cls, part.path):
                raise ValueError(f"links to {part.path[:40]!r}, which is not a field of a scene; write its dotted path")
        return description

    @model_validator(mode="after")
    def _pings_and_slices_fit(self) -> Self:
        # The speed of other waters is known only after they are built.
        if self.water.only_speed is not None:
            self.sonar.check_ping_rate(self.water.only_speed)
            self.sonar.check_pulse_length(self.water.only_speed)
        # The spacing of a DEM is known only after it is read.
        if not self.seabed.relief.measured:
            self.check_slice_length(self.seabed.spacing)
        return self

    @model_validator(mode="after")
    def _sonar_is_in_the_water(self) -> Self:
        altitude, depth, heave = self.altitude, self.seabed.depth, self.track.heave
        if self.seabed.relief.measured:
            return self
        if self.track.depth is None and altitude > depth:
            raise ValueError(
                f"track.altitude {altitude:g} m puts the sonar above the surface of water {depth:g} m deep; "
                "lower it or deepen seabed.depth"
            )
        room = min(altitude, depth - altitude)
        if heave > 0.0 and heave >= room:
            raise ValueError(
                f"track.motion: a heave of {heave:g} m takes the sonar at altitude {altitude:g} m out of the water, "
                f"{depth:g} m deep; keep its amplitude below {room:g} m"
            )
        if altitude <= 0.0:
            raise ValueError(
                f"track.depth {self.track.depth:g} m puts the sonar into the bed at {depth:g} m; "
                "reduce it or deepen seabed.depth"
            )
        return self

    @model_validator(mode="after")
    def _law_and_beam_model_the_effects(self) -> Self:
        receiver, water = self.receiver, self.water
        # Law `light` has straight rays, and their first echoes from the bed and from targets alone.
        effects = {
            f"receiver.reverberation {receiver.reverberation.kind!r} is scattered by water and surface": (
                receiver.reverberation.echoes, "remove the reverberation"),
            "volumes scatter sound throughout": (self.volumes, "remove the volumes"),
            "receiver.speckle 'coherent' sums waves": (receiver.speckle.interferes, "another speckle"),
            f"water.surface {water.surface.kind!r} mirrors sound": (any(water.surface.paths), "remove the surface"),
            f"water {water.kind!r} bends sound": (water.only_speed is None, "water of one speed"),
            f"sonar.bounces {self.sonar.bounces} takes later echoes": (self.sonar.bounces > 0, "sonar.bounces 0"),
        }  # fmt: skip
        for effect, (present, remedy) in effects.items():
            if self.sonar.law == "light" and present:
                text = f"{effect}, which sonar.law 'light' does not model; use law 'sonar' or {remedy}"
                raise ValueError(text)
        if self.receiver.speckle.interferes and not self.sonar.beam.has_width:
            raise ValueError(
                "receiver.speckle 'coherent' sums the scatterers within the beam, and sonar.beam 'knife' has no width; "
                "use a fan or another speckle"
            )
        return self

    def check_slice_length(self, spacing: float) -> None:
        """Raise SceneError if the range spans more cells (m) of the bed than a slice can have."""
        most, bed = (MOST_ENDLESS_CELLS, "endless ground") if self.seabed.endless else (MOST_CELLS, "the bed")
        if self.sonar.range > most * spacing:
            raise SceneError(
                f"sonar.range {self.sonar.range:g} m is {self.sonar.range / spacing:.3g} times the seabed.spacing of "
                f"{spacing:g} m, and a slice has at most {most} cells of {bed}; shorten the range to "
                f"{most * spacing:.4g} m or widen the spacing"
            )

    @property
    def about(self) -> str:
        """The description without its links."""
        parts = split_description(self.description)
        return "".join(part if isinstance(part, str) else part.words for part in parts)

    def _repr_html_(self) -> str:
        """Describe the scene in a notebook."""
        sonar, track = self.sonar, self.track
        facts = [
            ("", self.about), ("sonar", f"{sonar.frequency / 1e3:g} kHz, {sonar.range:g} m, 2 x {sonar.bins} bins"),
            ("tow", f"{track.pings} pings at {sonar.ping_rate:g} per second, {track.speed:g} m/s"),
            ("bed", f"depth {self.seabed.depth:g} m, {self.altitude:g} m below the sonar"),
            ("targets", ", ".join(target.kind for target in self.targets[:MOST_NAMED]) or "none"),
        ]  # fmt: skip
        settings = self.model_dump(mode="json", exclude_defaults=True, exclude_none=True)
        return make_card(self.title, facts, quote_text(tomli_w.dumps(settings)))

    @property
    def georeference(self) -> Georeference | None:
        """Place of the scene's (0, 0) on Earth: from ``world``, and from the map of a measured bed."""
        measured = self.seabed.relief.georeference(self.world.origin)
        if measured is not None:
            return Georeference(self.world.crs or measured.crs, measured.origin)
        return None if self.world.origin is None else Georeference(self.world.crs, self.world.origin)

    @property
    def pits(self) -> tuple[Pit, ...]:
        """Pits and mounds around targets, which are part of the bed."""
        return tuple(target.pit for target in self.targets if target.pit is not None)

    def describe_limits(self) -> Iterator[str]:
        """Describe in a sentence each way in which the scene leaves the range of a formula for its water or noise."""
        for part in (self.water, self.water.absorption, self.water.surface, self.receiver.noise):
            if part is not None:
                yield from part.describe_limits(self.sonar.frequency)

    @property
    def altitude(self) -> float:
        """Height of the sonar above the declared mean bed, in metres; the mean of a DEM is in the terrain."""
        if self.track.depth is not None:
            return self.seabed.depth - self.track.depth
        return DEFAULT_ALTITUDE if self.track.altitude is None else self.track.altitude
