"""Several reliefs on one bed."""

from typing import Annotated, Self

from pydantic import model_validator

from insonify.io.georeference import Georeference
from insonify.scene.base import KindOf, parameter
from insonify.scene.seabed.materials import MaterialMap
from insonify.scene.seabed.reliefs import RELIEFS, AddableRelief, HeightGrid, ReliefKind
from insonify.scene.seabed.reliefs.random_relief import RandomRelief


class SumOfReliefs(ReliefKind, kind="sum", rank=80):
    """Several reliefs on one bed, independent of one another; one of them may be measured."""

    of: tuple[Annotated[AddableRelief, KindOf(RELIEFS, AddableRelief, default="fractal")], ...] = parameter(
        description="the reliefs: all of the same period, or all endless; one may be a dem", min_length=1, max_length=16
    )

    @model_validator(mode="after")
    def _parts_fit_together(self) -> Self:
        random = self._random
        for part in random[1:]:
            if part.period != random[0].period:
                raise ValueError(
                    f"of repeats after {random[0].period:g} m in one part and after {part.period:g} m in another; "
                    "give all the same period"
                )
            if part.endless != random[0].endless:
                raise ValueError("of is endless in one part and repeats in another; give all the same extent")
        count = len(self.of) - len(random)
        if count > 1:
            raise ValueError(f"of has {count} measured beds; keep one")
        if count and any(part.endless for part in random):
            raise ValueError("of is endless in one part and measured in another; remove extent from the endless one")
        return self

    @property
    def _random(self) -> tuple[RandomRelief, ...]:
        return tuple(part for part in self.of if isinstance(part, RandomRelief))

    @property
    def _measured(self) -> AddableRelief | None:
        return next((part for part in self.of if part.measured), None)

    @property
    def measured(self) -> bool:  # type: ignore[override]  # depends on the parts
        """Whether one of the parts is measured."""
        return self._measured is not None

    @property
    def parts(self) -> tuple[RandomRelief, ...]:
        """The reliefs, unless one is measured."""
        return () if self.measured else self._random

    @property
    def detail(self) -> tuple[RandomRelief, ...]:
        """The random reliefs on top of the measured one."""
        return self._random if self.measured else ()

    @property
    def version(self) -> tuple[int, int] | None:
        """Version of the file of the measured part."""
        return None if self._measured is None else self._measured.version

    def sample(
        self, spacing: float, origin: tuple[float, float] | None = None, shape: tuple[int, int] | None = None
    ) -> HeightGrid:
        """Read the measured part."""
        if self._measured is None:
            raise NotImplementedError
        return self._measured.sample(spacing, origin, shape)

    def georeference(self, origin: tuple[float, float] | None) -> Georeference | None:
        """Map coordinates of the local (0, 0) of the measured part."""
        return None if self._measured is None else self._measured.georeference(origin)

    def check(self, spacing: float, material: MaterialMap) -> None:
        """Check every relief of the sum."""
        for part in self.of:
            part.check(spacing, material)
