"""The base of all tracers, the tracers there are, and what they share: records, and pings in blocks."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from functools import cache
from typing import Any, ClassVar, NamedTuple

import numpy as np

from insonify.arrays import Complexes, Singles
from insonify.kernels.common.types import Poses, SceneArrays
from insonify.packing.containment import refuse_sonar_in_target
from insonify.packing.packed_scene import Model, PackedScene
from insonify.parallel import in_parallel
from insonify.plugins import extensions
from insonify.scene import Scene, SceneError
from insonify.tow.poses import take_poses

AUTO = "auto"  # the method of a plan that chooses the tracer itself
_DECLARED: dict[str, type[Tracer]] = {}


class Ladder(NamedTuple):
    """Numbers by which a tracer is made finer: from the first by doublings to the last."""

    counted: str  # what is counted, as in "64 cones per side"
    first: int
    last: int


class PreparedTracer(ABC):
    """A tracer that is ready for a scene.

    Attributes
    ----------
    trace_waves : callable or None
        As `trace`, but returns complex amplitudes of every bin's samples, (n, 2, bins × samples) complex128. None for a
        tracer that sums energies.
    """

    trace_waves: Callable[..., Complexes] | None = None

    @abstractmethod
    def trace(self, arrays: SceneArrays, poses: Poses, *, threads: int | None = None, **settings: Any) -> Singles:
        """Trace pings.

        Parameters
        ----------
        arrays : SceneArrays
            The scene, without what the plan leaves out.
        poses : Poses
            Poses of the sonar, (n,).
        threads : int, optional
            Greatest number of threads.
        **settings
            As `Tracer.settings` returns them.

        Returns
        -------
        (n, 2, bins) float32
            Mean intensity of an ideal pulse's echoes in each bin, port first. The echo of a ping depends on its own
            pose alone, not on the other pings nor on the number of threads.

        Raises
        ------
        SceneError
            If the sonar is inside a target.
        """

    @property
    def bins_beyond(self) -> int:
        """Bins beyond the record's last with echoes that are summed into the record."""
        return 0


class Tracer(PreparedTracer):
    """A method of tracing: from a scene's arrays and poses of the sonar to the echoes in every range bin.

    A subclass with a `name` is a method that ``--method`` and `insonify.plan` accept. It is found by standing in
    `insonify.tracers`, by an entry point of the group ``insonify.tracers``, or by being declared anywhere. One object
    serves all scenes.

    Attributes
    ----------
    name : str
        Name of the method.
    rank : int
        Place among the methods.
    automatic : bool
        Whether a plan may choose it; the first one by rank that can trace a scene is taken.
    fineness : tuple of str
        Fields of the `Model` that set how finely it traces, the main one first: ``planes``, ``rays``, ``step``,
        ``misplaced`` (division of the bed's segments), ``every`` (stride of the bed's nodes). A tracer that counts
        something else uses ``fineness``.
    ladder : Ladder or None
        Numbers of the main field. A plan doubles it until what that changes keeps to the tolerance.
    follows_bounces : bool
        Whether it follows specular reflections and passages after the first echo (``SceneArrays.bounces``).
    sums_waves : bool
        Whether it can trace the interfering waves of single scatterers, which coherent speckle requires.
    refracts_along : bool
        Whether it refracts sound in water that varies along the range.
    refraction : str
        How it refracts sound, in words for a plan.
    rounding : float
        Relative error of its numbers if they have 32 bits; 0 if all have 64.
    """

    name: ClassVar[str]
    rank: ClassVar[int] = 100
    automatic: ClassVar[bool] = False
    fineness: ClassVar[tuple[str, ...]] = ("fineness",)
    ladder: ClassVar[Ladder | None] = None
    follows_bounces: ClassVar[bool] = False
    sums_waves: ClassVar[bool] = False
    refracts_along: ClassVar[bool] = True
    refraction: ClassVar[str] = "rays follow circular arcs"
    rounding: ClassVar[float] = 0.0

    def __init_subclass__(cls, **others: Any) -> None:
        """Note a tracer that has a name of its own."""
        super().__init_subclass__(**others)
        if "name" in vars(cls):
            _DECLARED[cls.name] = cls

    @abstractmethod
    def settings(self, model: Model) -> dict[str, Any]:
        """Return the keyword arguments of `trace` by which a model is traced."""

    @abstractmethod
    def work(self, scene: Scene, arrays: SceneArrays, model: Model) -> float:
        """Return the work of a ping by a model, both sides; a plan prefers less.

        Parameters
        ----------
        scene, arrays
            The whole scene, as declared and as packed.
        model : Model
            The model.

        Returns
        -------
        float
            A count, the same on every machine: of knots of one plane over uniform water, some 7 ns each.
        """

    def prepare(self, scene: Scene, arrays: SceneArrays) -> PreparedTracer:
        """Return the tracer for one scene: itself, or an object with what it keeps from ping to ping."""
        return self

    def refuse(self, scene: Scene) -> None:
        """Raise a SceneError if it cannot trace what a scene declares, beside what the attributes exclude."""


def list_methods() -> tuple[str, ...]:
    """Return the methods that can be requested: "auto", then the tracers by their ranks."""
    extensions("insonify.tracers", "insonify.tracers")  # tracers declare themselves
    return (AUTO, *sorted(_DECLARED, key=lambda name: _DECLARED[name].rank))


def find_tracer(name: str) -> Tracer:
    """Return the tracer of a name, or raise `SceneError`."""
    known = () if name in _DECLARED else list_methods()  # tracers declare themselves
    if name not in _DECLARED:
        raise SceneError(f"method: {name!r} is not known; choose one of {', '.join(known)}")
    return _made(_DECLARED[name])


def prepare_tracer(packed: PackedScene, model: Model) -> PreparedTracer:
    """Return the tracer of a model, ready for a packed scene."""
    return find_tracer(model.method).prepare(packed.scene, packed.arrays_in_water(model))


@cache
def _made(tracer: type[Tracer]) -> Tracer:
    return tracer()


def trace_blocks(
    arrays: SceneArrays, poses: Poses, trace: Callable[[Poses, Singles], None], threads: int | None
) -> Singles:
    """Record of pings that threads trace block by block, each into its part; a sonar inside a target is refused."""
    refuse_sonar_in_target(arrays, poses)
    out = empty_record(arrays, poses)
    share_blocks(poses, lambda part, first, last: trace(part, out[first:last]), threads)
    return out


def share_blocks(poses: Poses, trace: Callable[[Poses, int, int], None], threads: int | None, least: int = 1) -> None:
    """Share pings among threads, block by block."""
    in_parallel(
        lambda first, last: trace(take_poses(poses, slice(first, last)), first, last), poses.x.size, threads, least
    )


def empty_record(arrays: SceneArrays, poses: Poses) -> Singles:
    """Record of zeros, (pings, 2, bins)."""
    return np.zeros((poses.x.size, 2, arrays.bins), dtype=np.float32)


def new_record(arrays: SceneArrays, poses: Poses) -> Singles:
    """Record without values, (pings, 2, bins), for a tracer that sets every bin."""
    return np.empty((poses.x.size, 2, arrays.bins), dtype=np.float32)
