"""Scenes whose relief, material and speckle are known, drawn by seed: what is learned from their records is judged."""

import numpy as np

from insonify import relief
from insonify.scene import Scene
from insonify.scene.edit import build, edit

PERIOD, SPACING = 102.4, 0.1  # m, unlike the grids that are learned
SHORTEST = 0.6  # m, wavelength from which slopes count: eight cells of 0.075 m, the resolution of the pulse
MATERIALS = ("silt", "fine_sand", "medium_sand", "coarse_sand", "sandy_gravel")
BEAMS = ({"kind": "knife"}, {"kind": "fan", "width": 1.0}, {"kind": "fan", "width": 0.5})


def draw_bed(seed: int) -> Scene:
    """β from 1.0 to 2.2, rms slopes from 0.03 to 0.2, three altitudes, knife and fans, with and without speckle."""
    draw = np.random.default_rng(seed)
    beta, slope = draw.uniform(1.0, 2.2), 0.03 * (0.2 / 0.03) ** draw.random()
    altitude = float(draw.choice([6.0, 10.0, 15.0]))
    speckle = str(draw.choice(["none", "rayleigh"]))
    beam = BEAMS[int(draw.integers(len(BEAMS)))]
    return make_bed(beta, slope, altitude, speckle, beam, str(draw.choice(MATERIALS)), seed + 1000)


def make_bed(
    beta: float, slope: float, altitude: float, speckle: str, beam: dict[str, object], material: str, seed: int
) -> Scene:
    """Scene with a fractal bed of an rms slope, of waves above 0.6 m."""
    fractal = {"kind": "fractal", "beta": beta, "rms": 0.1, "period": PERIOD}
    scene = build(
        {
            "title": f"known bed {seed}",
            "seed": seed,
            "seabed": {"depth": 30.0, "spacing": SPACING, "material": material, "relief": fractal},
            "sonar": {"frequency": 400e3, "beam": beam, "range": 40.0, "bins": 800, "ping_rate": 10.0},
            "track": {"altitude": altitude, "speed": 2.0, "pings": 384},
            "receiver": {"speckle": speckle},
        }
    )
    return edit(scene, {"seabed.relief.rms": 0.1 * slope / rms_slope(scene)})


def rms_slope(scene: Scene) -> float:
    """Rms slope along x of the heights of a scene's bed, of waves above 0.6 m."""
    heights = relief(scene.seabed, seed=scene.seed)
    ny, nx = heights.shape
    waves = np.fft.fft2(heights)
    y, x = np.fft.fftfreq(ny, scene.seabed.spacing)[:, None], np.fft.fftfreq(nx, scene.seabed.spacing)
    kept = np.abs(waves * 2.0 * np.pi * x * (np.hypot(x, y) <= 1.0 / SHORTEST)) ** 2
    return float(np.sqrt(kept.sum()) / heights.size)


def errors(truth: Scene, learned: Scene) -> tuple[float, float, float]:
    """Errors of a learned scene: of β, of the slope as a share, of the material's level in dB."""
    frequency = truth.sonar.frequency
    level = learned.seabed.material.materials[0].reflectivity_at(frequency).diffuse
    known = truth.seabed.material.materials[0].reflectivity_at(frequency).diffuse
    return (
        getattr(learned.seabed.relief, "beta", np.inf) - truth.seabed.relief.beta,
        rms_slope(learned) / rms_slope(truth) - 1.0,
        10.0 * float(np.log10(level / known)),
    )
