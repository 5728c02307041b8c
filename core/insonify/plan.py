"""Choose, for a scene and a tolerance, the cheapest model that is accurate enough, and say why."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

from insonify.scene import Scene, SceneError
from insonify.scene.materials import Material
from insonify.scene.seabed import Flat
from insonify.scene.sonar import Fan

METHODS = ("auto", "sweep", "march", "rays")
MOST_PLANES = 64
# Error law of a fan of planes against 64, measured over fractal beds: percent at a spacing of one cell, and exponent.
ERROR_AT_ONE_CELL = 0.006
ERROR_EXPONENT = 1.5
# Error law of single rays a side, measured likewise.
ERROR_OF_1000_RAYS = 0.31


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
    """

    method: str
    settings: dict[str, Any]
    reasons: tuple[tuple[str, str], ...]

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
    if method == "march":
        step = scene.seabed.spacing * min(1.0, tolerance / 0.03)
        reason = f"asked for; steps of {step:.3g} m, {scene.sonar.bins} rays a side"
        return Plan("march", {"step": step, "rays": scene.sonar.bins}, (("march", reason),))
    if method == "rays":
        rays = max(1000, math.ceil(1000.0 * ERROR_OF_1000_RAYS / tolerance))
        reason = f"asked for; {rays} rays a side, error about {100 * ERROR_OF_1000_RAYS * 1000 / rays:.2g} %"
        return Plan("rays", {"rays": rays}, (("rays", reason),))
    chosen = "asked for" if method == "sweep" else "a height field and convex targets: nothing needs single rays"
    planes, why = _planes(scene, tolerance)
    return Plan("sweep", {"planes": planes}, (("sweep", chosen), (f"{planes} plane{'s' * (planes > 1)}", why)))


def _planes(scene: Scene, tolerance: float) -> tuple[int, str]:
    """Planes across the beam, and why."""
    beam = scene.sonar.beam
    if not isinstance(beam, Fan):
        return 1, "a knife beam has no width"
    width = 2.0 * scene.sonar.range * math.sin(math.radians(beam.width) / 2.0)
    broad = f"a beam of {beam.width:g}° is {width:.3g} m wide at {scene.sonar.range:g} m"
    detail, of_what = _detail(scene)
    if detail is None:
        return 2, f"{broad}, over a bed without detail"
    widest = detail * (tolerance / ERROR_AT_ONE_CELL) ** (1.0 / ERROR_EXPONENT)
    planes = min(MOST_PLANES, 2 * max(1, math.ceil(width / widest / 2.0)))
    error = ERROR_AT_ONE_CELL * (width / planes / detail) ** ERROR_EXPONENT
    return planes, (
        f"{broad}; {planes} planes lie "
        f"{width / planes:.2g} m apart there, {of_what} is {detail:.3g} m: error about {100 * error:.2g} %"
    )


def _detail(scene: Scene) -> tuple[float | None, str]:
    """Size of the finest thing that a fan must not step over; None where there is nothing."""
    sizes = [(target.radius, f"the radius of target {number}") for number, target in enumerate(scene.targets)]
    if not (isinstance(scene.seabed.relief, Flat) and isinstance(scene.seabed.material, Material)):
        sizes.append((scene.seabed.spacing, "a cell of the bed"))
    return min(sizes, default=(None, ""))
