"""Kinds that a package of somebody else may bring: shapes, a map, a material, and one of each kind of physics."""

import math
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Literal

import numpy as np
import pytest

from insonify.scene import Scene, edit, load_scene
from insonify.scene.base import Family, parameter, rebuild_declarations
from insonify.scene.receiver.speckles import SPECKLES, SpeckleKind, Texture
from insonify.scene.seabed.materials import MATERIAL_MAPS, Cells, CompositeMap
from insonify.scene.seabed.materials.catalogue import MATERIALS, read_materials
from insonify.scene.seabed.reliefs import RELIEFS, HeightGrid, ReliefKind
from insonify.scene.seabed.reliefs.random_relief import ExtendableRelief, rms_height
from insonify.scene.seabed.reliefs.spectrum import Band, Density
from insonify.scene.sonar.beams import BEAMS, BeamConditions, BeamKind
from insonify.scene.sonar.pulses import PULSES, PulseKind
from insonify.scene.targets import TARGETS, Body, Posed
from insonify.scene.targets.shape import Shape, ball, frustum
from insonify.scene.track.motions import MOTIONS, SingleMotion
from insonify.scene.water import WATERS, SoundSpeeds, WaterKind, speeds_by_depth
from insonify.scene.water.absorptions import ABSORPTIONS, AbsorptionKind

OWN_MATERIALS = Path(__file__).parent / "own_materials"
AROUND, ACROSS = 96, 32


@contextmanager
def forgetting(*families: Family) -> Iterator[None]:
    """Forget kinds of these families that modules of others declare within the block."""
    try:
        yield
    finally:
        for family in families:
            models = family._models.items()
            family._models = {kind: model for kind, model in models if model.__module__.startswith("insonify.")}
        rebuild_declarations()


@contextmanager
def own_kinds() -> Iterator[None]:
    families = TARGETS, MATERIAL_MAPS, RELIEFS, BEAMS, PULSES, ABSORPTIONS, WATERS, MOTIONS, SPECKLES
    with forgetting(*families), pytest.MonkeyPatch.context() as patch:
        patch.setattr(MATERIALS, "data", MATERIALS.data | read_materials(OWN_MATERIALS))
        _declare()
        yield


def _declare() -> None:
    """Declare each by its fields and its own shape, indices or law alone."""

    class Dumbbell(Body):
        """Two balls on a bar along x."""

        kind: Literal["dumbbell"] = "dumbbell"
        radius: float = parameter(0.6, unit="m", description="of the balls", gt=0.0, slider=(0.05, 2.0))
        length: float = parameter(3.0, unit="m", description="between the balls", gt=0.0, slider=(0.1, 10.0))

        def shape(self) -> Shape:
            end = np.array([0.5 * self.length, 0.0, 0.0])
            bar = frustum(-end, end, 0.5 * self.radius, 0.3 * self.radius)
            return Shape((ball(self.radius, -end), bar, ball(self.radius, end)))

    class Hoop(Posed):
        """A ring that lies flat."""

        kind: Literal["hoop"] = "hoop"
        radius: float = parameter(2.0, unit="m", description="of the ring", gt=0.0, slider=(0.1, 10.0))
        tube: float = parameter(0.5, unit="m", description="radius of the tube", gt=0.0, slider=(0.05, 2.0), log=True)

        def shape(self) -> Shape:
            u, v = (2.0 * np.pi * np.arange(count + 1) / count for count in (AROUND, ACROSS))
            level = (self.radius + self.tube * np.cos(v))[:, None]
            height = np.broadcast_to((self.tube * np.sin(v))[:, None], (v.size, u.size))
            p = np.stack([level * np.cos(u), level * np.sin(u), height], axis=-1)
            a, b, c, d = p[:-1, :-1], p[:-1, 1:], p[1:, 1:], p[1:, :-1]
            return Shape(triangles=np.concatenate([np.stack([a, b, c], -2), np.stack([a, c, d], -2)]).reshape(-1, 3, 3))

    class Halves(CompositeMap):
        """One material to port of a line along x, another to starboard."""

        kind: Literal["halves"] = "halves"
        border: float = parameter(0.0, unit="m", description="y of the border", slider=(-50.0, 50.0))

        def indices(self, cells: Cells) -> np.ndarray:
            _, y = cells.centres()
            return np.repeat((y % cells.size[1] > self.border)[:, None], cells.shape[1], axis=1).astype(np.uint8)

    class BandRelief(ExtendableRelief):
        """Waves of about one length, in every direction."""

        kind: Literal["band"] = "band"
        rms: float = rms_height()
        wavelength: float = parameter(4.0, unit="m", description="of the waves", gt=0.0, slider=(1.0, 20.0))

        def density(self) -> Density:
            spread = 0.2 / self.wavelength
            return lambda fx, fy: np.exp(-0.5 * ((np.hypot(fx, fy) - 1.0 / self.wavelength) / spread) ** 2)

        def bands(self) -> tuple[Band, ...]:
            return (Band(self.density(), 0.2 / self.wavelength),)

    class Terrace(ReliefKind):
        """A step to port."""

        kind: Literal["terrace"] = "terrace"
        height: float = parameter(1.0, unit="m", description="of the step", slider=(0.0, 5.0))

        def sample(
            self, spacing: float, origin: tuple[float, float] | None = None, shape: tuple[int, int] | None = None
        ) -> HeightGrid:
            ny, nx = shape or (round(40.0 / spacing), 4)
            y = np.arange(ny) * 40.0 / ny
            return HeightGrid(np.repeat(np.where(y > 20.0, self.height, 0.0)[:, None], nx, axis=1), 40.0 / ny)

    class Parabola(BeamKind):
        """A beam whose sensitivity falls as a parabola."""

        kind: Literal["parabola"] = "parabola"
        width: float = parameter(2.0, unit="°", description="one-way full width", gt=0.0, slider=(0.5, 10.0))

        def half_width(self, conditions: BeamConditions) -> float:
            return math.radians(self.width) / 2.0

        def half_power(self, conditions: BeamConditions) -> float:
            return 0.54 * self.extent(conditions)

        def response(self, s: np.ndarray, conditions: BeamConditions) -> np.ndarray:
            return (1.0 - (s / self.extent(conditions)) ** 2) ** 2

    class Decay(PulseKind):
        """A pulse that dies down."""

        kind: Literal["decay"] = "decay"
        time: float = parameter(5e-5, unit="s", description="after which 1/e is left", gt=0.0, slider=(1e-5, 1e-3))

        @property
        def length(self) -> float:
            return 8.0 * self.time

        @property
        def resolution(self) -> float:
            return self.time

        def envelope(self, time: np.ndarray) -> np.ndarray:
            return np.where((time >= 0.0) & (time < self.length), np.exp(-time / self.time), 0.0)

    class Square(AbsorptionKind):
        """Absorption by the square of the frequency."""

        kind: Literal["square"] = "square"
        factor: float = parameter(1.0, unit="dB/km", description="at 100 kHz", ge=0.0, slider=(0.0, 10.0))

        def decibels_per_km(self, frequency: float, depth: float) -> float:
            return self.factor * (frequency / 1e5) ** 2

    class Gradient(WaterKind):
        """Water whose speed falls evenly."""

        kind: Literal["gradient"] = "gradient"
        slope: float = parameter(-0.1, unit="1/s", description="of the speed over depth", slider=(-1.0, 1.0))

        def sound_speeds(self) -> SoundSpeeds:
            return speeds_by_depth([0.0, 100.0], [1500.0, 1500.0 + 100.0 * self.slope])

    class Drift(SingleMotion):
        """A steady way to port."""

        kind: Literal["drift"] = "drift"
        speed: float = parameter(0.1, unit="m/s", description="to port", slider=(-1.0, 1.0))

        def displacement(self, time: np.ndarray) -> dict[str, np.ndarray]:
            return {"sway": self.speed * time}

    class Grains(SpeckleKind):
        """Speckle of few scatterers."""

        kind: Literal["grains"] = "grains"

        @property
        def texture(self) -> Texture:
            return Texture(0.5, None)


def own_scene(kind: str = "hoop") -> Scene:
    """A shape of coral on a level bed."""
    target = {"kind": kind, "position": [5.0, 18.0], "material": "coral"}
    changes = {"targets": [target], "seabed.relief": "flat", "sonar.range": 40.0, "sonar.bins": 200, "track.pings": 80}
    return edit(load_scene("default"), changes)
