"""The beam of a line of transducers."""

from __future__ import annotations

from typing import Literal

from insonify.scene.base import parameter
from insonify.scene.beams.aimed import AimedBeam


class LineArray(AimedBeam):
    """The beam of a line of transducers, with its sidelobes, wider than far away within its near field."""

    rank = 40
    kind: Literal["array"] = "array"
    length: float = parameter(
        0.5, unit="m", description="length of the array along the fish", gt=0.0, le=20.0, slider=(0.1, 2.0), log=True
    )
    taper: Literal["uniform", "cosine", "hamming", "taylor"] = parameter(
        "uniform", description="weight of the elements; a tapered array has lower sidelobes and a wider beam"
    )
    two_way: bool = parameter(True, description="whether sound passes the beam going and coming, or once")

    @property
    def words(self) -> str:
        """Name of the beam for captions."""
        return self._named(f"{self.taper} array of {self.length:g} m {'two' if self.two_way else 'one'}-way")
