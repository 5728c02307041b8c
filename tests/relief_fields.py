"""What changes the record of every field of made relief, for the test that holds all fields together."""

from __future__ import annotations

from collections.abc import Callable

Changes = dict[str, tuple[dict, dict]]

# Every kind of made relief, with what changes it; a mask and a period belong to all.
PERIOD, PATCHY = 16.0, {"kind": "patches", "size": 3.0}
MADE = {
    "fractal": ({"beta": 1.6, "peaks": [[6.0, 3.0]], "rms": 0.1}, {}),
    "power_law": ({}, {"strength": 0.02, "exponent": 3.0}),
    "von_karman": (
        {"across": 2.0, "along": 5.0, "rms": 0.1},
        {"rms": 0.11, "across": 3.0, "along": 4.0, "heading": 20.0, "hurst": 0.5},
    ),
    "ripples": (
        {"wavelength": 2.0, "height": 0.2},
        {
            "wavelength": 2.5,
            "heading": 50.0,
            "height": 0.22,
            "bandwidth": 0.2,
            "bandwidth_along": 0.2,
            "sharpness": 0.3,
        },
    ),
    "cascade": ({"rms": 0.1}, {"rms": 0.11, "intermittency": 0.3, "hurst": 0.9}),
    "autocorrelation": ({"rms": 0.1}, {"rms": 0.11, "function": "gaussian"}),
}
OF_CORRELATIONS = {
    "exponential": {"length": (1.0, 1.5)},
    "gaussian": {"length": (1.0, 1.5)},
    "table": {"points": ([[0.0, 1.0], [1.0, 0.4], [3.0, 0.0]], [[0.0, 1.0], [1.0, 0.3], [3.0, 0.0]])},
    "file": {"path": ("CORRELATION", "OTHER_CORRELATION")},
}
ENDLESS_FRACTAL = {"extent": "endless", "clamp": "soft", "coefficients": "gaussian"}


def of_made(path: str, place: str, within: Callable[[dict], dict]) -> Changes:
    """What changes each kind of made relief, given how a relief comes to stand at a place of the seabed."""
    found = {}
    for kind, (given, changes) in MADE.items():
        base = {"kind": kind, "period": PERIOD, **given}
        needs, here = within(base), f"{path}[{kind}]"
        found |= {f"{here}.{name}": (needs, {f"{place}.{name}": value}) for name, value in changes.items()}
        found[f"{here}.period"] = (needs, within(base | {"period": 20.0}))
        found[f"{here}.mask"] = (needs, {f"{place}.mask": PATCHY})
        masked = within(base | {"mask": PATCHY})
        for name, value in {"share": 0.3, "size": 4.0, "softness": 1.0}.items():
            found[f"{here}.mask[patches].{name}"] = (masked, {f"{place}.mask.{name}": value})
        if kind != "cascade":
            softly = ENDLESS_FRACTAL if kind == "fractal" else {}
            found[f"{here}.extent"] = (
                within(base | softly | {"extent": "periodic"}),
                {f"{place}.extent": "endless"},
            )
    for kind, fields_ in OF_CORRELATIONS.items():
        for name, (before, after) in fields_.items():
            of = {"kind": kind, name: before}
            found[f"{path}[autocorrelation].function[{kind}].{name}"] = (
                within({"kind": "autocorrelation", "period": PERIOD, "rms": 0.1, "function": of}),
                {f"{place}.function.{name}": after},
            )
    return found


def of_fractals(path: str, place: str, within: Callable[[dict], dict]) -> Changes:
    """What changes a fractal relief."""
    base = {"kind": "fractal", "period": PERIOD, **MADE["fractal"][0]}
    without = {name: value for name, value in base.items() if name != "beta"}
    rotated = within(without | {"beta_x": 1.2, "beta_y": 1.6, "decay": "rotated"})
    two = within(base | {"peaks": [[6.0, 3.0], [4.0, -2.0]]})
    changes = {
        "beta": (within(base), 1.7),
        "beta_x": (rotated, 1.3),
        "beta_y": (rotated, 1.7),
        "rms": (within(base), 0.11),
        "quadrants": (within(base), 4),
        "combine": (two, "max"),
        "decay": (rotated, "elliptic"),
        "clamp": (within(base), "soft"),
        "coefficients": (within(base), "gaussian"),
    }
    found = {f"{path}[fractal].{name}": (needs, {f"{place}.{name}": value}) for name, (needs, value) in changes.items()}
    return found | {f"{path}[fractal].peaks": (within(base), {f"{place}.peaks.0.1": 4.0})}


def alone(relief: dict) -> dict:
    return {"seabed.relief": relief}


def summed(relief: dict) -> dict:
    return {"seabed.relief": {"kind": "sum", "of": [relief]}}
