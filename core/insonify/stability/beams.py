"""Failures of beams: too few planes, too few pings, a cone taken for a plane."""

from __future__ import annotations

import math
from functools import lru_cache
from textwrap import wrap

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from insonify.plan import plan
from insonify.scene import Scene, edit
from insonify.simulate import prepare, simulate
from insonify.sound.flat_bed import along_track_width
from insonify.stability.case import Case, Way
from insonify.stability.drawing import FAINT, INK, RIGHT, WRONG, named, panel
from insonify.stability.scenery import level_scene
from insonify.tracers import sweep

Curve = NDArray[np.float64]
FEW = 4
BALL = {"kind": "sphere", "position": [2.0, 38.0], "radius": 0.05}
WIDE = {"sonar.beam": {"kind": "fan", "width": 2.5}}


@lru_cache(maxsize=1)
def _past_a_ball() -> tuple[Curve, Curve, Curve, int]:
    """Places along the track, the ball's echo over the bed's by few planes and by those planned, and their number."""
    scene = level_scene(WIDE | {"targets": [BALL], "track.speed": 0.5, "track.pings": 80})
    simulation, bare = prepare(scene), prepare(level_scene(WIDE))
    near = math.hypot(38.0, 10.0 - 0.05) - 0.05
    echo = slice(int(near / 0.05), int(near / 0.05) + 2)
    poses = simulation.poses(np.arange(80))
    bed = sweep.trace(bare.problem, bare.poses(np.arange(1)))[0, 0, echo].sum()
    few, planned = (
        sweep.trace(simulation.problem, poses, planes=n)[:, 0, echo].sum(axis=1) / bed - 1.0
        for n in (FEW, simulation.plan.planes)
    )
    return poses.x - 2.0, few, planned, simulation.plan.planes


def _comb(echo: Curve) -> float:
    """Greatest swing of the echo within the beam, over its mean there."""
    along = _past_a_ball()[0]
    inside = np.abs(along) < 0.35 * 39.3 * math.radians(2.5)
    return float(100.0 * np.ptp(echo[inside]) / _past_a_ball()[2][inside].mean())


def _draw_comb(figure: Figure) -> None:
    along, few, planned, count = _past_a_ball()
    axes = panel(figure, x="place along the track, from abreast of the ball (m)", y="the ball's echo over the bed's")
    axes.plot(along, few, ".-", color=WRONG, linewidth=1.0, markersize=3, label=f"{FEW} planes")
    axes.plot(along, planned, ".-", color=RIGHT, linewidth=1.0, markersize=3, label=f"the plan's {count} planes")
    named(axes)


def _sparse() -> Scene:
    balls = [{"kind": "sphere", "position": [1.0 + 2.0 * k, 15.0], "radius": 0.1} for k in range(5)]
    beam = {"kind": "fan", "width": 0.5}
    return level_scene({"targets": balls, "sonar.beam": beam, "sonar.ping_rate": 1.0, "track.pings": 6})


@lru_cache(maxsize=1)
def _missed() -> float:
    """Count the balls without which the record is the same."""
    whole = simulate(_sparse()).intensity.values
    balls = _sparse().targets
    without = (edit(_sparse(), {"targets": [plain for plain in balls if plain != ball]}) for ball in balls)
    return float(sum(np.array_equal(whole, simulate(scene).intensity.values) for scene in without))


def _missed_unsaid() -> float:
    said = any("can be missed" in entry.reason for entry in plan(_sparse()).entries)
    return 0.0 if said else _missed()


@lru_cache(maxsize=1)
def _widths() -> tuple[Curve, Curve, Curve, Curve]:
    """Slant range, and the arc of a level bed within a beam of 2.5°: as a plane's wedge, as a cone, and by count."""
    problem = prepare(level_scene(WIDE)).problem
    r = np.array([10.2, 10.5, 11.0, 12.0, 14.0, 18.0, 25.0, 40.0])
    x = np.sqrt(r**2 - 100.0)
    azimuth = (np.arange(2_000_000) + 0.5) / 2_000_000 * 0.5 * math.pi
    inside = [np.mean(xk / rk * np.sin(azimuth) <= math.sin(problem.half_width)) for xk, rk in zip(x, r)]
    return r, x * 2.0 * problem.half_width, along_track_width(problem, x, r), math.pi * x * np.array(inside)


def _width_off(widths: Curve) -> float:
    return float(100.0 * np.abs(widths / _widths()[3] - 1.0).max())


def _draw_widths(figure: Figure) -> None:
    r, wedge, cone, counted = _widths()
    axes = panel(figure, x="slant range, 10 m above the bed (m)", y="bed within the beam (m)")
    axes.plot(r, wedge, color=WRONG, label="wedge between two planes, x θ")
    axes.plot(r, cone, color=RIGHT, label="cone about the track, near r θ")
    axes.plot(r, counted, "o", color=INK, markersize=3, label="counted azimuth by azimuth")
    named(axes)


def _draw_sparse(figure: Figure) -> None:
    scene = _sparse()
    half, apart = math.radians(0.25), scene.track.speed / scene.sonar.ping_rate
    axes = panel(figure, x="along the track (m)", y="across (m)")
    for ping in range(scene.track.pings):
        x = ping * apart
        axes.fill([x, x - 25.0 * half, x + 25.0 * half], [0.0, 25.0, 25.0], color=FAINT, alpha=0.35, linewidth=0)
    places = np.array([target.position[:2] for target in scene.targets])
    axes.plot(places[:, 0], places[:, 1], "o", color=WRONG, markersize=5, label="targets, which no beam meets")
    axes.fill([], [], color=FAINT, alpha=0.35, label="beams of the pings")
    reason = next(entry.reason for entry in plan(scene).entries if "can be missed" in entry.reason)
    axes.set_title("\n".join(wrap(f"own plan: {reason}", 110)), fontsize=8.5, color=RIGHT, loc="left")
    axes.set_ylim(-9.0, 26.0)
    named(axes, "lower right")


CASES = (
    Case(
        "Too few planes across a fan",
        "A target narrower than the distance between two planes is heard when one meets it and not in between.",
        "swing of a small ball's echo within the beam", "%",
        Way(f"Cuts the beam into {FEW} planes.", lambda: _comb(_past_a_ball()[1]), 100.0),
        Way("Lets the plan choose by the ball and how wide the beam is there.",
            lambda: _comb(_past_a_ball()[2]), 60.0),
        _draw_comb,
    ),
    Case(
        "Pings too far apart",
        "Between two pings the fish moves on by more than its beam is wide.",
        "targets missed without a word", "of 5",
        Way("Simulates what is asked for.", _missed, 3.0),
        Way("Says in the plan up to which range what is narrow can be missed.", _missed_unsaid, 0.0),
        _draw_sparse,
    ),
    Case(
        "A cone taken for a wedge",
        "A beam keeps its angle to the track, not to a plane: at slant range r it takes in r θ of bed, not x θ.",
        "error of the width it takes in", "%",
        Way("Takes ground range times the beam's angle.", lambda: _width_off(_widths()[1]), 30.0),
        Way("Takes all azimuths with cos θ · |sin φ| within the beam.", lambda: _width_off(_widths()[2]), 0.01),
        _draw_widths,
    ),
)  # fmt: skip
