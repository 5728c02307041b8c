"""Record of the default scene that comes with the package, which a window shows while it compiles its first kernels."""

import hashlib
from importlib.metadata import version

import numpy as np

from insonify.arrays import Singles
from insonify.display.normalisation import LevelBed
from insonify.display.picture import compile_picture
from insonify.files import resources
from insonify.operating_system import lower_priority
from insonify.packing.packed_scene import Model
from insonify.planning import Plan
from insonify.scene import DEFAULT_SCENE, Scene, load_scene, scene_to_toml
from insonify.simulation import prepare

FILE = resources() / "records" / "default.npz"
FORMAT = 1
UNPLANNED = Plan(Model())  # by which a scene is prepared without tracing any of its pings
DROPPED = 12  # bits of each number that are not stored, an error of 2.5e-4 of it at most


def digest_of(scene: Scene) -> str:
    """Digest of what an example must have been made of: the scene, this version, and the format of the file."""
    return hashlib.sha256(f"{FORMAT} {version('insonify')}\n{scene_to_toml(scene)}".encode()).hexdigest()


def read_example(scene: Scene) -> Singles | None:
    """Read the record of a scene from the package: amplitudes relative to a level bed, (pings, 2, bins).

    None unless it was made of this very scene by this version. ``docs/make/example.py`` writes the file.
    """
    with np.load(FILE) as file:
        if str(file["digest"]) != digest_of(scene):
            return None
        octets = np.moveaxis(file["octets"], 0, -1)  # the least of each number first, as they compress best
    return (np.ascontiguousarray(octets).view("<u4")[..., 0] << np.uint32(DROPPED)).view(np.float32)


def compile_for_example() -> None:
    """Compile in a process of its own what the example is shown by: its picture, its bed, its record on a level bed."""
    compile_picture()
    simulation = prepare(load_scene(DEFAULT_SCENE), plan=UNPLANNED)
    level_record = np.ones((1, 2, simulation.arrays.bins), dtype=np.float32)
    LevelBed(simulation).normalise(level_record, np.zeros(1, dtype=np.int64))
    lower_priority()  # from now on the process compiles beside a window that is in use
