"""Choose, for a scene and a tolerance, the cheapest model that is accurate enough, and say why."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any

from insonify.scene import Scene, SceneError
from insonify.scene.fractal import Fractal
from insonify.scene.materials import Material
from insonify.scene.receiver import Coherent
from insonify.scene.reliefs import Flat
from insonify.scene.sonar import Knife
from insonify.scene.surface import WAYS, NoSurface, RoughSurface
from insonify.scene.targets import AnyTarget, Box, MeshFile
from insonify.scene.water import SectionWater
from insonify.sound.beams import main_lobe
from insonify.sound.sea_surface import rms_height, slope_variance
from insonify.sound.straightness import Bending, bending_of
from insonify.sound.water import speed_at_sonar

METHODS = ("auto", "sweep", "march", "rays")
MOST_PLANES = 64
# Error law of a fan of planes against 128, over fractal beds of β 1.2 to 2 with rms 0.4 cells: share of the record when
# planes lie one cell apart at the greatest range; a factor of ten for every 0.4 of β; square of the spacing.
ERROR_AT_ONE_CELL, LAW_BETA, LAW_RMS = 0.012, 1.2, 0.4
BETA_PER_DECADE = 0.4
# Likewise for targets, whose glint is narrow: with planes one radius apart.
ERROR_AT_ONE_RADIUS = 0.18
THIN = 0.15  # m, radius of the thin parts of a mesh, which it does not tell before it is read
# A bed that no β describes (measured heights, patches of material) counts as this smooth.
OTHER_BETA = 1.4
# Error law of single rays over a rough bed, at 1000 rays a side, and its order: a fan spreads them over two angles.
KNIFE_RAYS, FAN_RAYS = (0.13, 1.0), (0.31, 0.75)


@dataclass(frozen=True)
class Plan:
    """How a scene is simulated.

    Attributes
    ----------
    method : str
        Tracer: sweep, march or rays.
    settings : dict
        What it is called with.
    reasons : tuple of (str, str)
        Each choice and why it was made, with numbers.
    bent : bool
        Whether sound follows the water; if not, it is taken to go straight at the sonar's speed.
    """

    method: str
    settings: dict[str, Any]
    reasons: tuple[tuple[str, str], ...]
    bent: bool = False

    @property
    def planes(self) -> int:
        """Planes across the beam; 1 where the method has none."""
        return int(self.settings.get("planes", 1))

    def lines(self) -> list[str]:
        """Return one line a choice, as the command prints them."""
        return [f"{choice}: {reason}" for choice, reason in self.reasons]


def plan(scene: Scene, tolerance: float = 0.03, *, method: str = "auto") -> Plan:
    """Plan a simulation.

    Parameters
    ----------
    scene : Scene
        What to simulate.
    tolerance : float
        Greatest error beyond 1.4 times the altitude, as a share of the record (0.03 is 3 %).
    method : str
        A tracer's name, or "auto".

    Returns
    -------
    Plan

    Raises
    ------
    SceneError
        If the tolerance is not a positive number or the method is unknown.
    """
    if not (math.isfinite(tolerance) and tolerance > 0.0):
        raise SceneError(f"tolerance: {tolerance!r} is not above 0; give a share such as 0.03")
    if method not in METHODS:
        raise SceneError(f"method: {method!r} is not known; choose one of {', '.join(METHODS)}")
    if (bounces := scene.sonar.bounces) > 0 and method in ("sweep", "march"):
        raise SceneError(f"sonar.bounces: the {method} does not follow {bounces} of them; set it to 0 or use rays")
    if isinstance(scene.receiver.speckle, Coherent) and (bounces > 0 or method in ("march", "rays")):
        other = f"bounces, of which sonar.bounces asks for {bounces}" if bounces > 0 else f"the method {method!r}"
        raise SceneError(f"receiver.speckle: 'coherent' is heard by the sweep, not by {other}; take another speckle")
    surface = scene.water.surface
    if isinstance(scene.receiver.speckle, Coherent) and not isinstance(surface, NoSurface):
        raise SceneError(
            f"water.surface: {surface.kind!r} makes ghosts, of which 'coherent' speckle knows nothing; take another "
            "receiver.speckle, or the surface 'none'"
        )
    bending = bending_of(scene)
    bent = bending.most >= tolerance
    if bent and isinstance(scene.receiver.speckle, Coherent):
        raise SceneError(
            "receiver.speckle: 'coherent' adds waves that go straight, and in this water sound bends; take another "
            "speckle, or water.kind 'uniform'"
        )
    if bent and isinstance(scene.water, SectionWater) and method == "sweep":
        raise SceneError(
            "method: 'sweep' hears water that differs by depth alone, and this differs along a 'section'; take rays"
        )
    if bent and not isinstance(surface, NoSurface):
        raise SceneError(
            f"water.surface: its ghosts ({surface.kind!r}) come along straight lines, and here sound bends; "
            "take the surface 'none', or water.kind 'uniform'"
        )
    chosen = _method(scene, tolerance, method, bent)
    reasons = (*chosen.reasons, *_sound(scene, bending, chosen, bent), *_surface(scene), *_pings(scene))
    return replace(chosen, reasons=reasons, bent=bent)


def _method(scene: Scene, tolerance: float, method: str, bent: bool) -> Plan:
    """Pick the tracer and what it is called with."""
    bounces = scene.sonar.bounces
    if method == "march":
        step = scene.seabed.spacing * min(1.0, tolerance / 0.03)
        reason = f"asked for; steps of {step:.3g} m, {scene.sonar.bins} rays a side"
        return Plan("march", {"step": step, "rays": scene.sonar.bins}, (("march", reason),))
    if method == "rays" or bounces > 0:
        return _rays(scene, tolerance, "asked for" if method == "rays" else f"{bounces} bounces need single rays")
    if bent and isinstance(scene.water, SectionWater):
        return _rays(scene, tolerance, "in water that differs along the level each ray bends in its own way")
    chosen = "asked for" if method == "sweep" else "a height field and first echoes: nothing needs single rays"
    planes, why = _planes(scene, tolerance)
    across = (f"{planes} plane{'s' * (planes > 1)}", why)
    settings = {"planes": planes} | (_rays(scene, tolerance, "").settings if bent else {})
    return Plan("sweep", settings, (("sweep", chosen), across, *_speckle(scene), *_tow(scene)))


def _sound(scene: Scene, bending: Bending, chosen: Plan, bent: bool) -> tuple[tuple[str, str], ...]:
    """Say whether sound bends, and what it would matter; nothing of water that is the same everywhere."""
    if bending.most == 0.0:
        return ()
    bin_length = scene.sonar.range / scene.sonar.bins
    matter = (
        f"it moves the farthest echo of the bed by {bending.shift:.2g} m, a bin is {bin_length:.3g} m, and its level "
        f"by {f'{100.0 * bending.level:.2g} %' if bending.level < 1.0 else 'more than half'}"
    )
    if not bent:
        return (("straight sound", f"bending is left out; {matter}"),)
    if chosen.method != "sweep":
        return (("bent sound", f"along arcs; {matter}"),)
    return (
        (
            "bent sound",
            f"by tables of the water; {matter}; pings that hear a place along several ways or none go to "
            f"{chosen.settings['rays']} rays a side",
        ),
    )


def _rays(scene: Scene, tolerance: float, chosen: str) -> Plan:
    """As many rays as the tolerance asks for."""
    error, order = KNIFE_RAYS if isinstance(scene.sonar.beam, Knife) else FAN_RAYS
    rays = max(1000, math.ceil(1000.0 * (error / tolerance) ** (1.0 / order)))
    reason = f"{chosen}; {rays} rays a side, error about {100 * error * (1000 / rays) ** order:.2g} %"
    return Plan("rays", {"rays": rays}, (("rays", reason),))


def _speckle(scene: Scene) -> tuple[tuple[str, str], ...]:
    """Say what coherent speckle costs; nothing of speckle that costs little."""
    if not isinstance(scene.receiver.speckle, Coherent):
        return ()
    return (("scatterers", "coherent speckle adds up every one in the beam, which takes most of the time"),)


def _surface(scene: Scene) -> tuple[tuple[str, str], ...]:
    """Say what is made of the sea surface; nothing of none."""
    surface = scene.water.surface
    ways = [way.replace("_", "-") for way in WAYS if getattr(surface, way, False)]
    if isinstance(surface, NoSurface) or not ways:
        return ()
    images = f"{', '.join(ways)}: from images of the sonar above it"
    if not isinstance(surface, RoughSurface):
        return (("flat sea", f"{images}; what rises higher than the sonar leaves it in sight"),)
    height, slope = (
        rms_height(surface.wind_speed),
        math.degrees(math.sqrt(slope_variance(surface.wind_speed))),
    )
    waves = f"smeared in range by waves of {height:.2g} m rms and slopes of {slope:.2g}° rms, along the beam alone"
    return (("rough sea", f"{images}, {waves}"),)


def _tow(scene: Scene) -> tuple[tuple[str, str], ...]:
    """Say what is made of a tow that is not a straight one; nothing of one that is."""
    if not scene.track.kinds:
        return ()
    return (
        (
            ", ".join(scene.track.kinds),
            "each ping from its own place and heading; while one is out the fish stands still",
        ),
    )


def _pings(scene: Scene) -> tuple[tuple[str, str], ...]:
    """Say where pings lie farther apart than the beam is wide, for a target there can be missed."""
    apart = scene.track.speed / scene.sonar.ping_rate
    if isinstance(scene.sonar.beam, Knife):
        return (("pings", f"{apart:.3g} m apart; a knife-edge beam misses what is narrower"),)
    # Nearer than this the beam is narrower than the way between two pings; nothing lies nearer than the bed.
    covered = apart / (2.0 * math.sin(main_lobe(scene.sonar, speed_at_sonar(scene))))
    if covered <= scene.altitude:
        return ()
    nearer = f"nearer than {covered:.3g} m" if covered < scene.sonar.range else "at every range"
    return (
        ("pings", f"{apart:.3g} m apart, more than the beam is wide {nearer}; what is narrower can be missed there"),
    )


def _planes(scene: Scene, tolerance: float) -> tuple[int, str]:
    """Planes across the beam, and why."""
    beam = scene.sonar.beam
    if isinstance(beam, Knife):
        return 1, "a knife beam has no width"
    width = 2.0 * scene.sonar.range * math.sin(main_lobe(scene.sonar, speed_at_sonar(scene)))
    broad = f"the main lobe of a {beam.words} is {width:.3g} m wide at {scene.sonar.range:g} m"
    demands = [*_bed_demand(scene, width), *_target_demands(scene, width)]
    if not demands:
        return 2, f"{broad}, over a bed without detail"
    error, of_what = max(demands)  # with one plane
    planes = min(MOST_PLANES, 2 * max(1, math.ceil(math.sqrt(error / tolerance) / 2.0)))
    return planes, (
        f"{broad}; {planes} planes lie {width / planes:.2g} m apart there, {of_what}: "
        f"error about {100 * error / planes**2:.2g} %"
    )


def _bed_demand(scene: Scene, width: float) -> list[tuple[float, str]]:
    """Error that a single plane would make of the bed's detail; nothing for a level bed of one material."""
    relief, spacing = scene.seabed.relief, scene.seabed.spacing
    if isinstance(relief, Flat) and isinstance(scene.seabed.material, Material):
        return []
    beta, rms = OTHER_BETA, LAW_RMS
    if isinstance(relief, Fractal) and isinstance(scene.seabed.material, Material):
        beta, rms = min(relief.exponents), relief.rms / spacing
    at_one_cell = ERROR_AT_ONE_CELL * 10.0 ** ((LAW_BETA - beta) / BETA_PER_DECADE) * rms / LAW_RMS
    return [(at_one_cell * (width / spacing) ** 2, f"a cell of the bed is {spacing:.3g} m")]


def _target_demands(scene: Scene, width: float) -> list[tuple[float, str]]:
    """Error that a single plane would make of each target."""
    return [
        (ERROR_AT_ONE_RADIUS * (width / radius) ** 2, f"target {number} has a radius of {radius:.3g} m")
        for number, radius in enumerate(map(_radius, scene.targets))
    ]


def _radius(target: AnyTarget) -> float:
    """Radius of a target, half the smallest side of a box, what the thin parts of a mesh are taken to have."""
    if isinstance(target, Box):
        return min(target.size) / 2.0
    return THIN if isinstance(target, MeshFile) else target.radius
