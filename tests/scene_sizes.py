"""How much memory and how many steps a scene can ask for, from what it declares alone: slow clocks say nothing here."""

import math

from insonify.io.meshes import read_mesh
from insonify.parallel import count_threads
from insonify.planning import Plan
from insonify.scene import Scene
from insonify.scene.receiver.speckles import Coherent
from insonify.scene.seabed.materials import Material
from insonify.scene.seabed.reliefs.random_relief import RandomRelief
from insonify.scene.sonar.pulses import Ideal, Tone
from insonify.scene.water import UniformWater

ALWAYS = 64e6  # bytes: tables of beams and of water, and what Python needs
OF_ENDLESS_GROUND = 600e6  # the tiles that are kept
OF_BENT_SOUND = 100e6  # the tables of some pings
OF_MESHES = 300e6  # what the many planes of a beam with a pattern cut of thousands of triangles
PER_KNOT, PER_CELL, PER_BIN = 500.0, 150.0, 400.0  # bytes of all arrays that are held at once
PER_TRIANGLE = 8.0  # steps of a plane that cuts it
KNOTS_PER_CELL = 8.0 * math.sqrt(2.0) * 2.0  # crossings of both families, halved twice; bent sound goes farther
TILE = 512
LEVEL_CELLS = 4096
MOST_PLANES = 1024
DEFAULT_SIDE = 102.4


def cells_along(scene: Scene) -> float:
    """Cells of the bed along the range."""
    return scene.sonar.range / scene.seabed.spacing


def most_bytes(scene: Scene) -> float:
    """Bytes that arrays of a scene may take at once, three pings at a time."""
    knots = KNOTS_PER_CELL * cells_along(scene) + 64.0
    lines = min(scene.track.pings, 64) * 2.0 * (scene.sonar.bins + pulse_bins(scene))
    held = ALWAYS + count_threads() * knots * PER_KNOT + _grid(scene) * PER_CELL + lines * PER_BIN
    held += MOST_PLANES * knots * 16.0 if isinstance(scene.receiver.speckle, Coherent) else 0.0
    held += 0.0 if isinstance(scene.water, UniformWater) else OF_BENT_SOUND
    held += OF_MESHES if any(target.kind == "mesh" for target in scene.targets) else 0.0
    return held + (OF_ENDLESS_GROUND if scene.seabed.endless else 0.0) + 64.0 * _waves(scene)


def pulse_bins(scene: Scene) -> float:
    """Bins that a pulse lasts; no more than the record has."""
    pulse = scene.sonar.pulse
    if isinstance(pulse, Ideal):
        return 1.0
    return 2.0 * math.ceil(0.5 * 1700.0 * pulse.duration / (scene.sonar.range / scene.sonar.bins)) + 1.0


def _grid(scene: Scene) -> float:
    """Nodes of the bed that are held."""
    seabed = scene.seabed
    if seabed.endless:
        return (TILE + 2.2 * cells_along(scene) + 3.0) ** 2
    if isinstance(seabed.relief, RandomRelief) or seabed.random_reliefs:
        return max(part.period / seabed.spacing for part in seabed.random_reliefs) ** 2
    if seabed.relief.kind == "mimic":
        return 4.0 * 2.0 * seabed.relief.reach / seabed.spacing
    if seabed.relief.kind == "flat" and not isinstance(seabed.material, Material):
        return min(max(DEFAULT_SIDE / seabed.spacing, 4.0), LEVEL_CELLS) ** 2
    return 16.0


def _waves(scene: Scene) -> float:
    """Samples of a line of waves, of the pulse and of its spectrum."""
    sonar, pulse = scene.sonar, scene.sonar.pulse
    if isinstance(pulse, Ideal):
        resolution = sonar.range / sonar.bins
    else:
        resolution = 0.5 * 1300.0 * (pulse.duration if isinstance(pulse, Tone) else 1.0 / pulse.bandwidth)
    fine = 16.0 * sonar.range / resolution if isinstance(scene.receiver.speckle, Coherent) else 0.0
    return fine + 64.0 * max(pulse_bins(scene), 32.0)


def most_steps(scene: Scene, plan: Plan) -> float:
    """Steps, each of some nanoseconds, that a scene of a plan may take: ground made, knots or cells passed, echoes."""
    pings, sonar = scene.track.pings, scene.sonar
    knots = KNOTS_PER_CELL * cells_along(scene) + 64.0
    rays = float(plan.settings.get("rays", 0)) * 2.0 ** min(sonar.bounces, 16)
    lines = MOST_PLANES if plan.method == "sweep" else 0
    cut = lines * PER_TRIANGLE * _triangles(scene) * (1.0 + len(plan.model.ways))
    bins = sonar.bins * (1.0 + pulse_bins(scene))
    return 100.0 * _grid(scene) + 2.0 * pings * ((lines + rays) * (knots + 100.0) + cut + bins) + _waves(scene)


def _triangles(scene: Scene) -> int:
    """Triangles of all meshes, each of which planes cut and ghosts meet again."""
    return sum(len(read_mesh(target.path)) for target in scene.targets if target.kind == "mesh")
