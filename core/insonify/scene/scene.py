"""Scene: the complete declaration of a simulation."""

from __future__ import annotations

from typing import Literal

from pydantic import field_validator, model_validator

from insonify.errors import SceneError
from insonify.io.georeference import Georeference
from insonify.scene.base import Declaration, Place, parameter
from insonify.scene.field_paths import is_field
from insonify.scene.links import Link, plain_words, split_description
from insonify.scene.receiver import Receiver
from insonify.scene.seabed import Seabed
from insonify.scene.sonar import Sonar
from insonify.scene.targets import AnyTarget
from insonify.scene.track import Track
from insonify.scene.volumes import AnyVolume
from insonify.scene.water import AnyWater
from insonify.scene.water.uniform import UniformWater

DEFAULT_ALTITUDE = 10.0
SCHEMA = 1
# Limits of bed cells along a range: a slice holds a dozen knots per cell, and endless ground is stored as a square.
MOST_CELLS, MOST_ENDLESS_CELLS = 262_144, 4096


class World(Declaration):
    """Where the scene's own coordinates lie on Earth."""

    origin: tuple[Place, Place] | None = parameter(
        None, unit="m", description="map coordinates of the scene's (0, 0); a DEM's centre when left out"
    )
    crs: str = parameter("", description="coordinate reference system of the origin, as written to files")


class Scene(Declaration):
    """Everything a record depends on; immutable, so an edit makes a new one."""

    schema_version: Literal[1] = parameter(SCHEMA, description="version of the scene format")
    title: str = parameter("Untitled", description="what the scene shows", max_length=200)
    description: str = parameter(
        "",
        description="a paragraph: what it shows, what to move; [words](path.to.field=value) link to a value to try",
        max_length=5000,
    )
    controls: tuple[str, ...] = parameter(
        (), description="fields that the scene is about, by dotted path; the viewer pins them on top", max_length=6
    )
    partner: tuple[str, ...] | None = parameter(
        None, description="a scene to compare with: its name or TOML file, this scene if left out, and settings of it"
    )
    seed: int = parameter(1, description="seed of all random numbers", ge=0, le=2**63 - 1)
    world: World = parameter(World(), description="place on Earth")
    seabed: Seabed = parameter(Seabed(), description="the bed")
    targets: tuple[AnyTarget, ...] = parameter((), description="targets on the bed")
    volumes: tuple[AnyVolume, ...] = parameter((), description="schools and plumes in the water column")
    water: AnyWater = parameter(UniformWater(), description="speed of sound and absorption of the water")
    sonar: Sonar = parameter(Sonar(), description="the sonar")
    track: Track = parameter(Track(), description="the tow")
    receiver: Receiver = parameter(Receiver(), description="the receiver")

    @field_validator("controls")
    @classmethod
    def _controls_are_fields(cls, controls: tuple[str, ...]) -> tuple[str, ...]:
        for path in controls:
            if not is_field(cls, path):
                raise ValueError(
                    f"{path[:40]!r} is no field of a scene; write its dotted path, such as 'track.altitude'"
                )
        return controls

    @field_validator("description")
    @classmethod
    def _links_lead_to_fields(cls, description: str) -> str:
        for part in split_description(description):
            if isinstance(part, Link) and not is_field(cls, part.path):
                raise ValueError(f"links to {part.path[:40]!r}, which is no field of a scene; write its dotted path")
        return description

    @model_validator(mode="after")
    def _ping_rate_fits_the_range(self) -> Scene:
        # The speed of other waters is known only after they are built.
        if self.water.only_speed is not None:
            self.sonar.refuse_haste(self.water.only_speed)
            self.sonar.refuse_long_pulse(self.water.only_speed)
        return self

    @model_validator(mode="after")
    def _slices_can_be_held(self) -> Scene:
        # The spacing of a DEM is known only after it is read.
        if not self.seabed.relief.measured:
            self.refuse_long_slices(self.seabed.spacing)
        return self

    @model_validator(mode="after")
    def _sonar_is_in_the_water(self) -> Scene:
        if self.track.depth is None and self.altitude > self.seabed.depth and not self.seabed.relief.measured:
            raise ValueError(
                f"track.altitude {self.altitude:g} m puts the sonar above the surface of water {self.seabed.depth:g} m "
                "deep; lower it or deepen seabed.depth"
            )
        return self

    @model_validator(mode="after")
    def _heave_has_room(self) -> Scene:
        room = min(self.altitude, self.seabed.depth - self.altitude)
        if self.track.heave > 0.0 and self.track.heave >= room and not self.seabed.relief.measured:
            raise ValueError(
                f"track.motion: a heave of {self.track.heave:g} m takes the sonar at altitude {self.altitude:g} m out "
                f"of the water, {self.seabed.depth:g} m deep; keep its amplitude below {room:g} m"
            )
        return self

    @model_validator(mode="after")
    def _sonar_is_above_the_bed(self) -> Scene:
        if self.altitude <= 0.0 and not self.seabed.relief.measured:
            raise ValueError(
                f"track.depth {self.track.depth:g} m puts the sonar into the bed at {self.seabed.depth:g} m; "
                "reduce it or deepen seabed.depth"
            )
        return self

    @model_validator(mode="after")
    def _reverberation_has_energy(self) -> Scene:
        if self.sonar.law == "light" and self.receiver.reverberation.echoes:
            raise ValueError(
                f"receiver.reverberation {self.receiver.reverberation.kind!r} is scattered by water and surface, which "
                "sonar.law 'light' does not model; take law 'sonar' or leave the reverberation out"
            )
        return self

    @model_validator(mode="after")
    def _volumes_have_energy(self) -> Scene:
        if self.sonar.law == "light" and self.volumes:
            raise ValueError(
                f"volumes: a {self.volumes[0].kind} scatters sound throughout, which sonar.law 'light' does not model; "
                "take law 'sonar' or leave the volumes out"
            )
        return self

    @model_validator(mode="after")
    def _scatterers_interfere(self) -> Scene:
        if not self.receiver.speckle.interferes:
            return self
        if self.sonar.law == "light":
            raise ValueError(
                "receiver.speckle 'coherent' sums waves, which sonar.law 'light' does not model; "
                "take law 'sonar' or another speckle"
            )
        if not self.sonar.beam.has_width:
            raise ValueError(
                "receiver.speckle 'coherent' sums the scatterers within the beam, and sonar.beam 'knife' has no width; "
                "take a fan or another speckle"
            )
        return self

    def refuse_long_slices(self, spacing: float) -> None:
        """Refuse a range of more cells of the bed than a slice can hold.

        Parameters
        ----------
        spacing : float
            Metres between nodes of the bed.

        Raises
        ------
        SceneError
        """
        most, of_what = (MOST_ENDLESS_CELLS, "endless ground") if self.seabed.endless else (MOST_CELLS, "the bed")
        if self.sonar.range > most * spacing:
            raise SceneError(
                f"sonar.range {self.sonar.range:g} m is {self.sonar.range / spacing:.3g} times the seabed.spacing of "
                f"{spacing:g} m, and at most {most} cells of {of_what} are held; shorten the range to "
                f"{most * spacing:.4g} m or widen the spacing"
            )

    @property
    def about(self) -> str:
        """The description as plain words, without its links."""
        return plain_words(self.description)

    @property
    def georeference(self) -> Georeference | None:
        """Place of the scene's (0, 0) on Earth: from ``world``, and from the map of a measured bed."""
        measured = self.seabed.relief.georeference(self.world.origin)
        if measured is not None:
            return Georeference(self.world.crs or measured.crs, measured.origin)
        return None if self.world.origin is None else Georeference(self.world.crs, self.world.origin)

    @property
    def altitude(self) -> float:
        """Height of the sonar above the declared mean bed, in metres; a DEM's own mean is known to the terrain."""
        if self.track.depth is not None:
            return self.seabed.depth - self.track.depth
        return DEFAULT_ALTITUDE if self.track.altitude is None else self.track.altitude
