"""Targets whose triangles are put together from their fields and kept: wrecks, aircraft, persons."""

from abc import abstractmethod
from functools import lru_cache

from insonify.scene.targets import Posed
from insonify.scene.targets.shape import Shape


class Generated(Posed):
    """A target that is built over the bed at z = 0, and that pitch and roll turn in part."""

    @abstractmethod
    def build(self) -> Shape:
        """Put the parts together."""

    @property
    def attitude(self) -> tuple[float, float, float]:
        """Heading; pitch and roll turn the body, not what lies about it."""
        return self.heading, 0.0, 0.0

    def shape(self) -> Shape:
        """Return the triangles of all parts; the bed is at z = 0."""
        return _kept_shape(self.model_copy(update={"position": (0.0, 0.0), "heading": 0.0}))

    @property
    def underside(self) -> float:
        """Height of the lowest point above the bed, in metres, negative where it is buried."""
        return self.gap + self.shape().lowest


@lru_cache(maxsize=64)
def _kept_shape(target: Generated) -> Shape:
    return target.build()
