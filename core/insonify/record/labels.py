"""Labels of range bins as variables of a record: those that tracing finds, and others that follow from them."""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from insonify.io.record_schema import ACROSS
from insonify.kernels.common.types import Poses
from insonify.plugins import extensions
from insonify.scene import Scene
from insonify.scene.targets import Target
from insonify.scene.volumes import Volume
from insonify.terrain import AnyGround
from insonify.tracers.labels import PATHS

Columns = dict[str, NDArray[Any]]


class LabelledBlock(NamedTuple):
    """Successive pings of a record, from which their labels follow."""

    scene: Scene
    ground: AnyGround  # the bed
    poses: Poses  # of the sonar at each ping, (n,)
    columns: Columns  # ``intensity`` and the traced labels of `RecordLabels` by their names, (n, 2, bins), port first


@dataclass(frozen=True)
class Label:
    """A label of every range bin: a variable of a record with ``truth=True``.

    A label belongs to records once it is made: at the top level of a module of ``insonify.record``, of one that an
    installed package announces as an entry point of the group ``insonify.labels``, or anywhere. Of two with a name the
    later one counts.
    """

    name: str  # of the variable
    text: str  # what it is, in few words
    unit: str = ""  # none for numbers that stand for names, and for yes or no
    # Returns one value for each bin, (n, 2, bins), port first, which depends on its ping alone; None in a scene that
    # has no such label. Left out of a label that tracing finds.
    find: Callable[[LabelledBlock], NDArray[Any] | None] | None = None
    needs: tuple[str, ...] = ()  # traced labels from which it follows; a record that lacks one of them lacks it too
    meanings: Callable[[LabelledBlock], Mapping[int, str]] | None = None  # returns the names of numbers

    def __post_init__(self) -> None:
        """Add the label to the labels of records."""
        LABELS[self.name] = self

    def variable(self, block: LabelledBlock) -> dict[str, Any]:
        """Return the variable by its name; an empty dictionary where the block has none."""
        if not all(name in block.columns for name in self.needs):
            return {}
        values = block.columns.get(self.name) if self.find is None else self.find(block)
        if values is None:
            return {}
        attributes: dict[str, Any] = ({"units": self.unit} if self.unit else {}) | {"long_name": self.text}
        if self.meanings is not None:  # by the CF conventions
            meanings = self.meanings(block)
            attributes["flag_values"] = np.array(list(meanings), values.dtype)
            attributes["flag_meanings"] = " ".join(meanings.values())
        return {self.name: (ACROSS, np.moveaxis(values, 1, 0), attributes)}


LABELS: dict[str, Label] = {}


def label_variables(block: LabelledBlock) -> dict[str, Any]:
    """Return the variables that label each range bin."""
    extensions("insonify.record", "insonify.labels")  # labels add themselves
    return {name: variable for label in LABELS.values() for name, variable in label.variable(block).items()}


def name_parts(parts: Iterable[Target | Volume]) -> dict[int, str]:
    """Name targets or volumes by their numbers."""
    return {number: f"{part.kind}_{number}" for number, part in enumerate(parts)}


def _name_materials(block: LabelledBlock) -> dict[int, str]:
    of_targets = (target.material.name for target in block.scene.targets)
    return dict(enumerate(["nothing", *block.ground.names, *of_targets], -1))


Label(
    "target_id",
    "greatest contributor of the bin",
    meanings=lambda block: {-2: "nothing", -1: "bed"} | name_parts(block.scene.targets),
)
Label("material", "material of that contributor", meanings=_name_materials)
Label("shadow", "share of the bed's direct echo that targets hide, weighted by the beam", "1")
Label(
    "shadow_id",
    "target that hides most of it",
    meanings=lambda block: {-2: "nothing"} | name_parts(block.scene.targets),
)
Label("ground_range", "ground range of that contributor's strongest piece", "m")
Label("incidence", "incidence on that piece, from its normal", "degree")
Label("path", "propagation path of the sound", meanings=lambda block: dict(enumerate(["none", *PATHS], -1)))
Label("caustic", "whether the sound passes near a caustic, with its level limited by wave theory")
Label(
    "volume_id",
    "volume of the water column with a greater mean echo than that contributor",
    find=lambda block: block.columns["volume_id"] if block.scene.volumes else None,
    needs=("volume_id",),
    meanings=lambda block: {-2: "nothing"} | name_parts(block.scene.volumes),
)
