"""What a plan means for a scene, on one screen: error found, planes of pings, cost, and what is left out."""

from __future__ import annotations

import math
import textwrap
import time
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from insonify.arrays import Floats, Integers
from insonify.packing.packed_scene import pack
from insonify.planning.case import Case
from insonify.planning.effects import BY_SUBJECT
from insonify.planning.plan_entries import Plan, counted, percent
from insonify.planning.selection import Alternative, check_request, choose_for_case, list_alternatives, make_case
from insonify.record.record_error import RecordError
from insonify.scene import Scene
from insonify.simulation import Simulation, prepare
from insonify.tow.line import tow_line_at
from insonify.tow.poses import take_poses

SECONDS = 5.0  # predicted, in which the pings of a page are traced: all of a record, or some of a longer one
WIDTH = 78  # characters
LOUDEST = 0.75  # of the most planes, from which pings are named


def write_plan_page(
    scene: Scene, *, method: str = "auto", tolerance: float = 0.03, forced: Mapping[str, str] | None = None
) -> list[str]:
    """Lines that say how a scene is simulated, what that leaves out, and what its pings come out with."""
    wishes = forced or {}
    check_request(scene, tolerance, method, wishes)
    packed = pack(scene)
    case = make_case(packed, method, wishes)
    plan = choose_for_case(case, tolerance)
    simulation = prepare(scene, method=method, tolerance=tolerance, forced=wishes, plan=plan, packed=packed)
    return [*_describe_record(simulation, tolerance), "", *_describe_choices(case, plan, tolerance)]


def _describe_record(simulation: Simulation, tolerance: float) -> list[str]:
    """Error, planes and cost of the record, traced."""
    pings, of = _choose_pings(simulation), simulation.scene.track.pings
    poses = simulation.poses(pings)
    simulation.trace_pings(take_poses(poses, slice(1)))  # loads the kernels
    began = time.process_time()
    traced = simulation.trace_pings(poses)
    busy = time.process_time() - began
    errors, whole = simulation.errors(traced.squares.sum(axis=1)).astype(np.float64), RecordError(tolerance)
    whole.add(pings, errors, traced.planes)
    lines = [f"Tolerance  {percent(tolerance)} of every ping, from the first return of the bed"]
    found = f"Error      {percent(whole.whole)} of the record"
    if simulation.plan.goal is not None:
        worst, over = int(np.argmax(errors)), int((errors > tolerance).sum())
        found += f"; {percent(errors[worst])} of ping {pings[worst]}, the worst"
        found += f"; {counted(over, 'ping')} beyond the tolerance" if over else ""
    lines.append(found)
    if simulation.scene.sonar.beam.has_width and simulation.plan.method == "sweep":
        lines.append(f"Planes     {_describe_planes(simulation, pings, traced.planes)}")
    some = counted(of, "ping") if pings.size == of else f"{pings.size:,} of {of:,} pings"
    lines.append(f"Cost       {_seconds(busy / pings.size)} of one thread a ping, {_seconds(busy)} for {some}")
    return lines


def _choose_pings(simulation: Simulation) -> Integers:
    """All pings of a record, or as many spread over the track as take some seconds."""
    pings = simulation.scene.track.pings
    return np.unique(np.linspace(0, pings - 1, min(pings, simulation.pings_within(SECONDS))).astype(np.int64))


def _describe_planes(simulation: Simulation, pings: Integers, planes: Integers) -> str:
    """Least, median and most planes across the beam, and the pings with the most."""
    if simulation.plan.goal is None or planes.min() == planes.max():
        return f"{planes.max()} across the beam in every ping"
    most, many = int(planes.argmax()), planes >= LOUDEST * planes.max()
    first = last = most
    while first > 0 and many[first - 1]:
        first -= 1
    while last < planes.size - 1 and many[last + 1]:
        last += 1
    counts = f"{planes.min()} least, {int(np.median(planes))} median, {planes.max()} most"
    if 2 * (last + 1 - first) > planes.size:
        return counts
    run = f"ping {pings[first]}" if first == last else f"pings {pings[first]}-{pings[last]}"
    return f"{counts} ({run}, {_name_place(simulation, pings[most : most + 1])})"


def _name_place(simulation: Simulation, ping: Integers) -> str:
    """Name what the beam crosses in a ping: the end of a target, a target, or the bed alone."""
    scene, line = simulation.scene, tow_line_at(simulation.scene, ping)
    squint, half = math.radians(scene.sonar.beam.axis), simulation.arrays.half_width
    found = []
    for number in simulation.plan.model.targets:
        points = _outline_of(simulation, number)
        dx, dy, c, s = points[:, 0] - line.x, points[:, 1] - line.y, np.cos(line.heading), np.sin(line.heading)
        azimuth = np.arctan2(dx * c + dy * s, np.abs(dy * c - dx * s)) - squint
        low, high, distance = azimuth.min(), azimuth.max(), float(np.hypot(dx, dy).min())
        if low <= half and high >= -half and distance <= scene.sonar.range:
            is_end = low > -half or high < half
            target = scene.targets[number]
            name = Path(getattr(target, "path", target.kind)).stem  # a mesh is what its file holds
            found.append((distance, f"{'end of ' if is_end else ''}the {name}, targets.{number}"))
    return min(found)[1] if found else "the bed alone"


def _outline_of(simulation: Simulation, number: int) -> Floats:
    """Points of a target seen from above, (n, 2)."""
    solids, mesh = simulation.arrays.solids, simulation.arrays.mesh
    own = solids.target == number
    ends = [solids.start[own], solids.start[own] + solids.length[own, None] * solids.axis[own]]
    return np.concatenate([*ends, mesh.corners[mesh.target == number].reshape(-1, 3)])[:, :2]


def _describe_choices(case: Case, plan: Plan, tolerance: float) -> list[str]:
    """Table of what is modelled and left out, and the next cheaper model."""
    alternatives = list_alternatives(case, plan, tolerance)
    without = {each.subject: each.error for each in alternatives if each.subject != "planes"}
    lines = []
    for title, head, modelled in (("Modelled", "without it", True), ("Left out", "changes", False)):
        entries = [entry for entry in plan.entries if entry.modelled is modelled and entry.subject in BY_SUBJECT]
        if entries:
            lines.append(f"{title:<44}{head:>20}{'a ping':>14}")
        for entry in entries:
            error = without.get(entry.subject, 0.0) if modelled else entry.error
            name = f"  {entry.choice}{' (forced)' if entry.forced else ''}"
            change = _change(error) if error > 0.0 or modelled or entry.forced else "nothing"
            lines.append(f"{name:<44}{change:>20}{_seconds(entry.cost) if entry.cost else '':>14}".rstrip())
    return [*lines, "", *textwrap.wrap(_describe_next(alternatives), WIDTH, subsequent_indent="  ")]


def _describe_next(alternatives: list[Alternative]) -> str:
    """Name the cheaper model of the most work, and why it is not taken."""
    cheaper = [each for each in alternatives if each.work < 1.0]
    if not cheaper:
        return "Next cheaper: none; no coarser setting takes less work"
    best = max(cheaper, key=lambda each: each.work)
    why = f"it errs by {percent(best.error)} and may err by {percent(best.allowed)}"
    return f"Next cheaper: {best.words}, {percent(1.0 - best.work)} less work; not taken, because {why}"


def _change(error: float) -> str:
    """Write a share of the record in percent and decibels."""
    return f"{percent(error)} ({10.0 * math.log10(1.0 + error):.2f} dB)" if error > 0.0 else ""


def _seconds(seconds: float) -> str:
    """Write a time with two digits."""
    unit, scale = next(((unit, scale) for unit, scale in (("s", 1.0), ("ms", 1e-3)) if seconds >= scale), ("µs", 1e-6))
    return f"{float(f'{seconds / scale:.2g}'):g} {unit}"
