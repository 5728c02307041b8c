"""Draw the figures of the theory and architecture pages."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from library import target_library

INK, ACCENT, LIT, DARK, PALE = "#2b3440", "#b3561d", "#1f7a8c", "#9aa5b1", "#e8ecf0"
STYLE: Any = {
    "figure.dpi": 100,
    "svg.fonttype": "path",
    "svg.hashsalt": "insonify",
    "font.size": 10,
    "text.color": INK,
    "axes.labelcolor": INK,
    "axes.edgecolor": DARK,
    "xtick.color": INK,
    "ytick.color": INK,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "legend.frameon": False,
}


def draw(folder: Path) -> None:
    """Draw all figures."""
    mpl.use("Agg")
    import matplotlib.pyplot as plt

    folder.mkdir(exist_ok=True)
    with mpl.rc_context(STYLE):
        for name, (size, paint) in FIGURES.items():
            figure = plt.figure(figsize=size, layout="constrained")
            paint(figure)
            options = {"metadata": {"Date": None}} if name.endswith(".svg") else {"dpi": 130}
            figure.savefig(folder / name, **options)
            plt.close(figure)


def sweep(figure: Any) -> None:
    """Profile with the running horizon, above the bins that its visible parts fill."""
    above, below = figure.subplots(2, 1, sharex=False, height_ratios=[3, 2])
    x = np.array([0.0, 3.0, 6.0, 9.0, 11.0, 13.0, 16.0, 20.0, 24.0, 27.0, 29.0, 33.0, 40.0])
    z = np.array([-10.0, -9.6, -9.8, -8.8, -6.6, -8.4, -9.7, -9.5, -9.2, -7.0, -8.6, -9.4, -9.2])
    bins = np.zeros(90)
    horizon = -math.inf
    for i in range(x.size - 1):
        rise = (z[i + 1] - z[i]) / (x[i + 1] - x[i])
        offset = z[i] - rise * x[i]
        seen = z[i + 1] / x[i + 1] > horizon
        start = min(max(offset / (horizon - rise), x[i]), x[i + 1]) if seen and horizon > -math.inf else x[i]
        above.plot(x[i : i + 2], z[i : i + 2], color=DARK, lw=2)
        if seen:
            xs = np.linspace(start, x[i + 1], 400)
            zs = offset + rise * xs
            above.plot(xs[[0, -1]], zs[[0, -1]], color=ACCENT, lw=3, solid_capstyle="butt")
            r = np.hypot(xs, zs)
            cosine = np.abs(offset) / (r * math.hypot(1.0, rise))
            np.add.at(bins, np.minimum((2.0 * r).astype(int), bins.size - 1), cosine**2 * (xs[1] - xs[0]) * r)
        horizon = max(horizon, z[i + 1] / x[i + 1])
    for k in (4, 9):
        above.plot([0, 40], [0, 40 * z[k] / x[k]], color=LIT, lw=0.8, ls="--")
    above.plot(0, 0, "o", color=INK)
    above.annotate("sonar", (0.5, 0.2))
    above.annotate("horizon", (24.5, -14.0), color=LIT)
    above.annotate("visible", (1.2, -11.4), color=ACCENT)
    above.annotate("hidden", (11.6, -11.4), color="#6b7683")
    above.set(ylabel="height (m)", xlabel="ground range (m)", ylim=(-17, 2), xlim=(-0.5, 40))
    below.stairs(bins, 0.5 * np.arange(bins.size + 1), fill=True, color=ACCENT)
    below.set(xlabel="slant range (m)", ylabel="energy per bin", yticks=[], xlim=(-0.5, 42))


def beam(figure: Any) -> None:
    """Along-track width of a fan by the cone and by a wedge of azimuths."""
    axes = figure.subplots()
    height, width = 10.0, math.radians(2.5)
    x = np.geomspace(0.05, 30.0, 800)
    r, edge = np.hypot(x, height), height * math.tan(width / 2.0)
    cone = 2.0 * x * np.arcsin(np.minimum(np.sin(width / 2.0) * r / x, 1.0))
    axes.loglog(x, cone, color=ACCENT, lw=4, alpha=0.6, label="cone: 2x arcsin(min(1, r sin(w/2) / x))")
    axes.loglog(x, r * width, color=INK, lw=1.2, ls="--", label="slant range: r w")
    axes.loglog(x, x * width, color=LIT, lw=1.5, label="wedge of azimuths: x w")
    axes.axvline(edge, color=DARK, lw=0.8, ls=":")
    axes.annotate("all azimuths: πx", (0.95 * edge, 0.025), ha="right", color="#6b7683")
    axes.set(xlabel="ground range (m), altitude 10 m", ylabel="arc of the bed in the beam (m)", ylim=(0.01, 8))
    axes.xaxis.set_major_formatter("{x:g}")
    axes.yaxis.set_major_formatter("{x:g}")
    axes.legend(loc="upper left", fontsize=9)


def scattering(figure: Any) -> None:
    """Backscattering strength of the named sediments at two frequencies: model, and the laws fitted to it."""
    from insonify.scene.seabed.materials.catalogue import MATERIALS
    from insonify.scene.seabed.materials.sediments import model_strength, scattering_strength

    grazing = np.radians(np.linspace(5.0, 89.9, 300))
    names = ("silt", "fine_sand", "medium_sand", "coarse_sand", "sandy_gravel", "cobble")
    for axes, frequency in zip(figure.subplots(1, 2, sharey=True), (100e3, 300e3)):
        for k, name in enumerate(names):
            material: Any = MATERIALS[name]
            law = scattering_strength(material.reflectivity_at(frequency), np.sin(grazing))
            model = model_strength(material.model, frequency, grazing)
            colour = mpl.colormaps["viridis"](0.9 - 0.17 * k)
            axes.plot(np.degrees(grazing), 10.0 * np.log10(law), color=colour, lw=2, label=name)
            axes.plot(np.degrees(grazing), 10.0 * np.log10(model), color=colour, lw=1, ls="--")
        title = f"{frequency / 1e3:g} kHz"
        axes.set(xlabel="grazing angle (°)", xlim=(0, 90), ylim=(-50, 0), title=title)
    figure.axes[0].set_ylabel("backscattering strength (dB)")
    axes.legend(fontsize=9, loc="lower right")


def error(figure: Any) -> None:
    """One ping as it is and divided by a smooth curve that falls as a level bed's does."""
    import insonify
    from insonify.scene import edit

    scene = edit(insonify.load_scene("default"), {"track.pings": 8, "sonar.range": 100.0, "sonar.ping_rate": 5.0})
    record = insonify.simulate(scene, method="sweep")
    r, ping = record.slant_range.values, record.intensity.values[1, 4].astype(float)
    level = insonify.simulate(edit(scene, {"seabed.relief": "flat", "targets": ()}), method="sweep").intensity.values[
        1, 4
    ]
    left, right = figure.subplots(1, 2)
    heard = level > 0.0
    left.semilogy(r[heard], np.maximum(ping[heard], 1e-14), color=DARK, lw=0.7, label="ping")
    left.semilogy(r[heard], level[heard], color=ACCENT, lw=1.5, label="level bed")
    left.set(xlabel="slant range (m)", ylabel="energy per bin", ylim=(1e-13, None))
    left.legend()
    right.plot(r[heard], ping[heard] / level[heard], color=DARK, lw=0.7)
    right.axvline(14.0, color=LIT, lw=1, ls="--")
    right.annotate("1.4 altitudes", (15.5, 3.6), color=LIT)
    right.set(xlabel="slant range (m)", ylabel="ping / level bed", ylim=(0, 4))


def apparent(figure: Any) -> None:
    """Rays in a thermocline to a level bed, and where they make the bed seem to be."""
    import insonify
    from insonify.scene import edit

    layers = {"kind": "profile", "depth": [0, 10, 20, 40], "sound_speed": [1530, 1529, 1497, 1496]}
    water = edit(insonify.load_scene("default"), {"water": layers}).water
    angles = np.array([10.5, 12.0, 14.0, 17.0, 22.0, 32.0, 60.0])
    paths = insonify.ray_paths(water, 5.0, angles, max_range=400.0, bottom=30.0)
    axes = figure.subplots()
    for k, angle in enumerate(np.radians(angles)):
        end = int(np.flatnonzero(paths.hit.values[k])[-1])
        x, depth = paths.range.values[k, : end + 1], paths.depth.values[k, : end + 1]
        straight = 1529.5 * paths.time.values[k, end]
        there = straight * math.cos(angle), 5.0 + straight * math.sin(angle)
        axes.plot(x, depth, color=ACCENT, lw=1.5)
        axes.plot([0, there[0]], [5.0, there[1]], color=LIT, lw=0.8, ls="--")
        axes.plot(*there, "o", color=LIT, ms=5)
        axes.plot(x[-1], depth[-1], "o", color=ACCENT, ms=5)
    axes.axhline(30.0, color=DARK, lw=1)
    axes.plot([], [], color=ACCENT, marker="o", label="ray to the true place")
    axes.plot([], [], color=LIT, ls="--", marker="o", label="straight line to the apparent place")
    axes.plot(0, 5.0, "s", color=INK)
    axes.set(xlabel="ground range (m)", ylabel="depth (m)", ylim=(34, 0), xlim=(-2, None))
    axes.legend(loc="upper right")


def caustics(figure: Any) -> None:
    """Level bed at three frequencies, about the caustic of water that slows down with depth."""
    import insonify
    from insonify.scene import edit

    layers = {"kind": "profile", "depth": [0, 24, 70], "sound_speed": [1570, 1490, 1487.5]}
    changes: dict[str, Any] = {
        "seabed.depth": 64.0, "seabed.relief": "flat", "targets": (), "water": layers, "track.altitude": 38.0,
        "track.pings": 1, "sonar.beam": "knife", "sonar.pulse": "ideal", "sonar.range": 420.0, "sonar.bins": 4200,
        "sonar.ping_rate": 1.0, "seabed.material": {"name": "medium_sand", "diffuse": 0.2, "specular": 0.0},
    }  # fmt: skip
    axes = figure.subplots()
    for frequency, color in ((12e3, LIT), (120e3, ACCENT), (1e6, INK)):
        scene = edit(insonify.load_scene("default"), {**changes, "sonar.frequency": frequency})
        record = insonify.simulate(scene)
        level = 10.0 * np.log10(np.maximum(record.intensity.values[1, 0].astype(float), 1e-30))
        axes.plot(record.slant_range.values, level, color=color, lw=1.2, label=f"{frequency / 1e3:g} kHz")
    axes.set(xlabel="slant range (m)", ylabel="intensity of a bin (dB)", xlim=(375, 405), ylim=(-150, -90))
    axes.legend()


def multipath(figure: Any) -> None:
    """Geometry of the images in the sea surface."""
    axes = figure.subplots()
    d, h, x = 12.0, 10.0, 34.0
    bed, heights = -d - h, {"sonar": -d, "image": d, "image of the image": d + 2.0 * h}
    axes.axhline(0.0, color=LIT, lw=2)
    axes.axhline(bed, color=DARK, lw=2)
    ways = (  # corners between the sonar and the point, and the image that they seem to come from
        ("R", (14.5, -14.6), ACCENT, [], -d),
        ("R$_s$", (23.2, -9.5), LIT, [0.0], d),
        ("R$_{bs}$", (24.6, -3.6), INK, [bed, 0.0], d + 2.0 * h),
    )
    for name, place, color, touched, image in ways:
        slope = (image - bed) / x
        # Unfolded, the way is straight: it meets the bed at h below the sonar, the surface at twice the depths above.
        falls = [h, 2.0 * h + d] if len(touched) == 2 else [d]
        corners = [(fall / slope, z) for fall, z in zip(falls, touched)]
        axes.plot(*zip((0.0, -d), *corners, (x, bed)), color=color, lw=1.8)
        if corners:
            axes.plot([0.0, corners[-1][0]], [image, 0.0], color=color, lw=1, ls="--")
        axes.annotate(name, place, color=color)
    for name, z in heights.items():
        axes.plot(0.0, z, "o", color=INK)
        axes.annotate(name, (-1.2, z), ha="right", va="center")
    for text, place, color in (
        ("sea surface", (34.0, 0.8), LIT),
        ("bed", (0.0, bed - 2.6), "#6b7683"),
        ("d", (-1.5, -6.5), INK),
        ("h", (-1.5, -17.5), INK),
    ):
        axes.annotate(text, place, color=color)
    axes.plot([0, 0], [bed, 0], color=DARK, lw=0.8, ls=":")
    axes.set(xlim=(-16, 42), ylim=(-26, 34), aspect="equal")
    axes.set_axis_off()


def speckle(figure: Any) -> None:
    """Densities of Rayleigh and K intensity, and the histogram of simulated records."""
    from scipy.special import gammaln, kv

    import insonify
    from insonify.scene import edit

    axes = figure.subplots()
    intensity = np.linspace(0.01, 8.0, 400)
    axes.semilogy(intensity, np.exp(-intensity), color=ACCENT, lw=2, label="Rayleigh")
    scene = edit(insonify.load_scene("default"), {"seabed.relief": "flat", "targets": (), "track.pings": 400})
    mean = insonify.simulate(scene).intensity.values[:, :, 400:]
    for shape, color in ((5.0, LIT), (1.0, INK)):
        root = np.sqrt(shape * intensity)
        log = math.log(2.0 * shape) - gammaln(shape) + (shape - 1.0) * np.log(root)
        axes.semilogy(
            intensity, np.exp(log) * kv(shape - 1.0, 2.0 * root), color=color, lw=2, label=f"K, shape {shape:g}"
        )
    edges = np.linspace(0.0, 8.0, 33)
    for k, (kind, color) in enumerate(
        (("rayleigh", ACCENT), ({"kind": "k", "shape": 5.0}, LIT), ({"kind": "k", "shape": 1.0}, INK))
    ):
        made = insonify.simulate(edit(scene, {"receiver.speckle": kind})).intensity.values[:, :, 400:] / mean
        density = np.histogram(made, edges)[0] / made.size / np.diff(edges)
        axes.plot(
            0.5 * (edges[1:] + edges[:-1]), density, "o", color=color, ms=3, label="simulated" if k == 0 else None
        )
    axes.set(xlabel="intensity over its mean", ylabel="probability density", xlim=(0, 8), ylim=(1e-4, 3))
    axes.legend()


def fractal_beds(figure: Any) -> None:
    """Six reliefs of one seed."""
    import insonify
    from insonify.scene import edit

    seabed = insonify.load_scene("figure-6")
    shared: dict[str, Any] = {"period": 51.2, "rms": 0.1}
    peak = {"kind": "fractal", "beta_x": 1.2, "beta_y": 1.6, "peaks": [[8.0, 4.0]], **shared}
    reliefs = {
        "fractal, β = 1.8": {"kind": "fractal", "beta": 1.8, **shared},
        "fractal, β = 1.4, peak (8, 4)": {"kind": "fractal", "beta": 1.4, "peaks": [[8.0, 4.0]], **shared},
        "separable, 1.2 and 1.6": {**peak, "decay": "separable"},
        "elliptic, 1.2 and 1.6": {**peak, "decay": "elliptic"},
        "ripples": {"kind": "ripples", "wavelength": 4.0, "period": 51.2},
        "cascade": {"kind": "cascade", **shared},
    }
    for axes, (title, relief) in zip(figure.subplots(2, 3).ravel(), reliefs.items()):
        bed = edit(seabed, {"seabed": {"depth": 30.0, "spacing": 0.2, "relief": relief}}).seabed
        heights = insonify.relief(bed, (256, 256))
        low, high = np.percentile(heights, (1.0, 99.0))
        axes.imshow(heights, cmap="cividis", origin="lower", vmin=low, vmax=high)
        axes.set_title(title, fontsize=9)
        axes.set_axis_off()


def data_flow(figure: Any) -> None:
    """Way of data from a scene file to a record on the screen."""
    axes = figure.subplots()
    placed = {
        "scene": (0.0, 2.0, "TOML, --set, sliders\nfrozen declarations"),
        "planning": (2.6, 3.0, "which model is\naccurate enough?"),
        "terrain": (2.6, 2.0, "heights and\nmaterials of the bed"),
        "acoustics": (2.6, 1.0, "beam, water, sea\nsurface, in formulas"),
        "packing": (5.2, 2.0, "SceneArrays, Poses:\nplain arrays"),
        "tracers": (7.8, 2.0, "sweep, march, rays,\nscatterers"),
        "kernels": (7.8, 0.6, "slice, sweep, rays …\nNumba, in parallel"),
        "receiver": (10.4, 2.0, "pulse, speckle,\nnoise, gain"),
        "Dataset": (13.0, 2.0, "intensity per channel,\nping and bin; labels"),
        "io": (13.0, 3.2, "netCDF, NumPy, XTF"),
        "display": (13.0, 0.8, "picture, page"),
        "viewer": (10.4, 0.6, "worker thread,\nwaterfall, panels"),
    }
    arrows = [
        ("scene", "planning"), ("scene", "terrain"), ("scene", "acoustics"), ("planning", "packing"),
        ("terrain", "packing"), ("acoustics", "packing"), ("packing", "tracers"), ("tracers", "kernels"),
        ("kernels", "tracers"), ("tracers", "receiver"), ("receiver", "Dataset"), ("Dataset", "io"),
        ("Dataset", "display"), ("receiver", "viewer"),
    ]  # fmt: skip
    for name, (x, y, text) in placed.items():
        outline: Any = {"boxstyle": "round,pad=0.08", "fc": PALE, "ec": DARK}
        axes.add_patch(mpl.patches.FancyBboxPatch((x - 0.95, y - 0.36), 1.9, 0.72, **outline))
        axes.text(x, y + 0.22, name, ha="center", va="center", fontsize=9.5, weight="bold")
        axes.text(x, y - 0.12, text, ha="center", va="center", fontsize=7.5, linespacing=1.25)
    for one, other in arrows:
        axes.annotate("", _rim(placed[other], placed[one]), _rim(placed[one], placed[other]), arrowprops=ARROW)
    axes.set(xlim=(-1.2, 14.2), ylim=(0.0, 3.8), aspect="equal")
    axes.set_axis_off()


SETTINGS = (
    ("rays", "rays per side", ("1400", "5500", "120000")),
    ("sweep", "planes", ("2", "5", "28")),
)
CROP = slice(235, 335), slice(15.0, 45.0)  # pings, and slant ranges in metres, of the starboard side


def errors(figure: Any) -> None:
    """Draw a part of the default scene's record by rays and by planes, at three errors each."""
    import insonify
    from insonify.display.normalisation import LevelBed
    from insonify.display.picture import choose_contrast, colour_amplitudes
    from insonify.simulation import prepare
    from insonify.statistics.record_errors import compare_records

    scene, pings = insonify.load_scene("default"), np.arange(CROP[0].start, CROP[0].stop)
    exact = prepare(scene, method="sweep", forced={"planes": "256"})
    poses, reference = exact.poses(pings), exact.trace(exact.poses(pings))
    near, far = CROP[1].start, CROP[1].stop
    bins = slice(*(round(one / scene.sonar.range * scene.sonar.bins) for one in (near, far)))
    rows = figure.subplots(len(SETTINGS), 3)
    levels = None
    for axes, (method, unit, counts) in zip(rows, SETTINGS):
        for one, count in zip(axes, counts):
            simulation = prepare(scene, method=method, forced={"rays" if method == "rays" else "planes": count})
            record = simulation.trace(poses)
            error = compare_records(exact.arrays, poses, record, reference).beyond
            amplitude = LevelBed(simulation).normalise(record, pings)[::-1, 1, bins]
            levels = levels or choose_contrast(amplitude)
            one.imshow(colour_amplitudes(amplitude, levels=levels), extent=(near, far, 0.0, 0.2 * pings.size))
            one.set_title(
                f"{method}, {int(count):,} {unit.removesuffix('s') if count == '1' else unit}: {100.0 * error:.2g} %"
            )
            one.set_axis_off()


ARROW = {"arrowstyle": "-|>", "color": ACCENT, "lw": 1.2, "shrinkA": 1, "shrinkB": 1}


def _rim(box: tuple[float, float, str], towards: tuple[float, float, str]) -> tuple[float, float]:
    """Where a box's rim faces another box."""
    dx, dy = towards[0] - box[0], towards[1] - box[1]
    if abs(dx) > 0.5:
        return box[0] + math.copysign(1.03, dx), box[1] + min(max(0.2 * dy, -0.3), 0.3)
    return box[0], box[1] + math.copysign(0.44, dy)


Size = tuple[float, float]
FIGURES: dict[str, tuple[Size, Callable[[Any], None]]] = {
    "errors.jpg": ((13.0, 6.4), errors),
    "sweep.svg": ((7.5, 4.6), sweep),
    "beam.svg": ((6.5, 3.4), beam),
    "scattering.svg": ((9.0, 3.8), scattering),
    "error.svg": ((7.5, 3.2), error),
    "apparent.svg": ((7.0, 3.6), apparent),
    "caustics.svg": ((7.0, 3.6), caustics),
    "multipath.svg": ((6.5, 6.5), multipath),
    "speckle.svg": ((6.5, 3.8), speckle),
    "data-flow.svg": ((11.0, 3.2), data_flow),
    "fractal-beds.jpg": ((7.2, 5.0), fractal_beds),
    "target-library.jpg": ((10.0, 9.6), target_library),
}
