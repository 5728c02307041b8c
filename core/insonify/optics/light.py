"""Ray-traced picture of a scene, lit by a lamp at the sonar.

The rays of every pixel go to the first surface. Where the scene follows bounces (``sonar.bounces``), they continue
through mirrors and clear bodies. At each hit a ray to the lamp decides whether the hit lies in a shadow. A surface
returns I = k_d cos θ_i + k_s max(0, R·V)ⁿ of the lamp's light (Lambert, Phong) with its own k_d, k_s and n. A share of
ambient light keeps shadows from being black.
"""

import warnings
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np

from insonify.arrays import Booleans, Bytes, Floats, Integers
from insonify.io.atomic import replacing
from insonify.kernels.common.types import BED, SceneArrays, Solids
from insonify.optics.cutaway import Camera, Cutaway, OpticalScene, make_camera, make_cutaway
from insonify.packing.targets import pack_solids
from insonify.parallel import in_parallel
from insonify.scene.seabed.materials.catalogue import MATERIALS
from insonify.scene.targets.shape import ball, frustum
from insonify.tracers.rays import PathHits, cast, follow

LUMINANCE = np.array([0.2126, 0.7152, 0.0722])  # of linear red, green, blue
Shares = Sequence[tuple[str, float]]
SHORT = 1e-5  # m before a hit, where the ray starts that finds its normal
LONG = 400.0  # m after which a ray through mirrors ends
PICTURE_WIDTH = 1200
RAYS_PER_PIXEL = 2  # rays of a pixel, each way
DEEP, CLEAR = np.array([0.008, 0.030, 0.050]), np.array([0.070, 0.185, 0.245])  # of the water below and above, as shown
STEEP, SLIGHT = -0.64, -0.45  # vertical components of directions that show these colours
VEIL = 0.07  # share of a pixel that is light scattered by the water
LAMP = np.array([1.0, 0.955, 0.86])
AROUND = np.array([0.055, 0.085, 0.10])  # ambient light over the light of the lamp
CUT = np.array([0.11, 0.075])  # share of it that the sides of the cutaway return, ahead and aside
MIDDLE, WHITE = 0.22, 99.9  # brightness of the middle tone, percentile that is white
GAMMA = 2.2
OFF = 1e-4  # m above a surface, where the ray to the lamp starts
LAMP_REACH = 1e4  # m
FISH = np.array([0.85, 0.47, 0.03])  # as shown
SIZE = 0.045  # length over the longer side of the cutaway: larger than life, to be visible
LINE = 0.0007  # of it: radius of the plumb line
DPI = 100
INSET = 26  # pixels from the left
INK, FAINT = "#f2f6f8", "#b9cbd3"


def hues(rows: tuple[str, ...]) -> Floats:
    """Linear colours of rows of the material table, (n, 3), scaled to a luminance of 1."""
    linear = np.array([mixed_colour(shares_of(row)) for row in rows]) ** 2.2
    return np.asarray(linear / (linear @ LUMINANCE)[:, np.newaxis])


def mixed_colour(shares: Shares) -> Floats:
    """Mean colour of named materials by their shares, (3,)."""
    return np.asarray(sum(share * np.array(MATERIALS[name].colour) for name, share in shares))


def shares_of(row: str) -> Shares:
    """Materials and their shares in a row's name: ``25.1_silt+74.9_rock``, or one name alone."""
    parts = [part.partition("_") for part in row.split("+")]
    return [(name, float(percent) / 100.0) for percent, _, name in parts] if "+" in row else [(row, 1.0)]


class OpticalHits(NamedTuple):
    """Hits of rays of sight, with the share of light that each returns."""

    ray: Integers  # (n,) number of the ray
    # (n, 3) place of the hit, direction of the ray, and unit normal on the ray's side; the normal is zero inside
    # a body.
    where: Floats
    way: Floats
    normal: Floats
    what: Integers  # (n,) index of the target, or ``BED`` (-1)
    share: Floats  # (n,) share of the surface's light that reaches the eye
    escaped: Floats  # (n,) share of the ray that continues from here and hits nothing


def light_picture(optical: OpticalScene, cutaway: Cutaway, width: int = PICTURE_WIDTH) -> Bytes:
    """Draw a scene lit by a lamp at the sonar, half way along the track."""
    renderer = LightRenderer(optical, cutaway)
    camera = make_camera(cutaway, width)
    shares = in_parallel(lambda first, last: renderer.rows(camera, first, last), camera.height)
    return tone_mapped(np.concatenate(shares))


class LightRenderer:
    """Traces rays of sight through a cutaway and lights the surfaces that they hit."""

    def __init__(self, optical: OpticalScene, cutaway: Cutaway) -> None:
        self._cutaway = cutaway
        self._arrays, self._ground = optical.arrays, optical.ground
        self._of_bed = len(self._ground.names)
        names = (*self._ground.names, *(target.material.name for target in optical.scene.targets))
        self._shown = with_towfish(self._arrays, self._cutaway, self._of_bed)
        self._hues = hues(names)

    def rows(self, camera: Camera, first: int, last: int) -> Floats:
        """Average the light of the rays through each pixel of some rows."""
        ways = camera.directions(np.arange(first, last), RAYS_PER_PIXEL)
        seen = self.light_along(camera.place, ways.reshape(-1, 3))
        return np.asarray(seen.reshape(*ways.shape[:-1], 6).mean(axis=(1, 3)))

    def light_along(self, place: Floats, ways: Floats) -> Floats:
        """Trace rays from the eye and return the light that arrives along them."""
        up = np.clip((ways[:, 2:] - STEEP) / (SLIGHT - STEEP), 0.0, 1.0)
        seen = np.concatenate([np.zeros(ways.shape), DEEP + up * (CLEAR - DEEP)], axis=1)  # the water
        enter, leave, face = self._cutaway.intersect(place, ways)
        inside = np.flatnonzero(leave > enter)
        starts = place + enter[inside, None] * ways[inside]
        cut = starts[:, 2] < self._ground.height_at(starts[:, 0], starts[:, 1])
        sides, through = inside[cut], inside[~cut]
        # The sides of the cutaway.
        rows = material_rows(self._arrays, starts[cut], np.full(sides.size, BED), self._of_bed)
        seen[sides, :3] = (self._arrays.reflectivity[rows, 0] * CUT[face[sides]])[:, None] * self._hues[rows]
        seen[sides, 3:] = 0.0
        found = find_optical_hits(self._shown, starts[~cut], ways[through], (leave - enter)[through], self._of_bed)
        ray = through[found.ray]
        seen[ray] = 0.0
        np.add.at(seen, ray, found.share[:, None] * self._returned(found))
        np.add.at(seen[:, 3:], ray, found.escaped[:, None] * CLEAR)
        return seen

    def _returned(self, found: OpticalHits) -> Floats:
        """Light that surfaces return to the eye, (n, 6)."""
        rows = material_rows(self._shown, found.where, found.what, self._of_bed)
        diffuse, specular, shininess = self._shown.reflectivity[rows].T
        to_lamp = self._cutaway.lamp - found.where
        far = np.linalg.norm(to_lamp, axis=1)
        to_lamp /= far[:, None]
        cosine = np.einsum("ij,ij->i", found.normal, to_lamp)
        free, _, _ = cast(self._arrays, found.where + OFF * found.normal, to_lamp, reach=LAMP_REACH)
        lamp = LAMP * ((cosine > 0.0) & (free > far - 2.0 * OFF))[:, None]
        mirrored = 2.0 * cosine[:, None] * found.normal - to_lamp
        lobe = np.maximum(-np.einsum("ij,ij->i", mirrored, found.way), 0.0) ** shininess
        around = AROUND * (0.6 + 0.4 * found.normal[:, 2:])
        even = diffuse[:, None] * self._hues[np.minimum(rows, len(self._hues) - 1)] * (lamp * cosine[:, None] + around)
        lit = even + (specular * lobe)[:, None] * lamp
        # The lamp lies inside the fish, which is therefore shown in a fixed colour.
        facing = -np.einsum("ij,ij->i", found.normal, found.way)[:, None]
        is_fish = (rows == len(self._hues))[:, None]
        return np.concatenate([np.where(is_fish, 0.0, lit), np.where(is_fish, FISH * facing, 0.0)], axis=1)


def find_optical_hits(arrays: SceneArrays, starts: Floats, ways: Floats, reach: Floats, of_bed: int) -> OpticalHits:
    """Trace rays to their first hit within reach, and further where the scene follows bounces."""
    distance, what, normal = cast(arrays, starts, ways, reach=float(reach.max(initial=0.0)))
    ray = np.flatnonzero(distance <= reach)
    if arrays.bounces > 0:
        return _followed(arrays, starts[ray], ways[ray], ray, of_bed)
    where = starts[ray] + distance[ray, None] * ways[ray]
    ones = np.ones(ray.size)
    return OpticalHits(ray, where, ways[ray], normal[ray], what[ray], ones, 0.0 * ones)


def _followed(arrays: SceneArrays, starts: Floats, ways: Floats, ray: Integers, of_bed: int) -> OpticalHits:
    """Follow rays that hit something through their bounces."""
    paths = follow(arrays, starts, ways, arrays.bounces, reach=LONG)
    before = _before(paths)
    whence = np.where(paths.bounce[:, None] == 0, starts[paths.ray], paths.position[before])
    way = paths.position - whence
    way /= np.linalg.norm(way, axis=1, keepdims=True)
    # A ray from just before the hit finds the normal only if it runs in the water.
    near, _, normal = cast(arrays, paths.position - SHORT * way, way, reach=2.0 * SHORT)
    within = np.isinf(near)
    share = np.where(within, 0.0, paths.throughput)
    escaped = _escaped(arrays, paths, before, within, of_bed)
    return OpticalHits(ray[paths.ray], paths.position, way, normal, paths.what, share, escaped)


def _before(paths: PathHits) -> Integers:
    """Index of the hit before each: the last one listed with one bounce less; a first hit has its own index."""
    numbers = np.arange(paths.ray.size)
    before = numbers.copy()
    for bounce in range(1, int(paths.bounce.max(initial=0)) + 1):
        last = np.maximum.accumulate(np.where(paths.bounce == bounce - 1, numbers, 0))
        these = paths.bounce == bounce
        before[these] = last[these]
    return before


def _escaped(arrays: SceneArrays, paths: PathHits, before: Integers, within: Booleans, of_bed: int) -> Floats:
    """Fraction of a ray's energy that escapes after each hit without hitting anything again."""
    rows = material_rows(arrays, paths.position, paths.what, of_bed)
    share, mirrored = paths.throughput, arrays.interface[rows, 0] ** 2
    later = paths.bounce > 0
    parent, arrived = before[later], share[later]
    # A refracted ray always hits the far side of its body; rays from the water leave only by reflection.
    is_mirrored = np.isclose(arrived, share[parent] * mirrored[parent], rtol=1e-6)
    counts = within[parent] | is_mirrored
    met = np.zeros(share.size)
    np.add.at(met, parent[counts], arrived[counts])
    return np.maximum(np.where(within, share, share * mirrored) - met, 0.0)


def material_rows(arrays: SceneArrays, where: Floats, what: Integers, of_bed: int) -> Integers:
    """Row of the reflectivity table at each hit; the rows of targets follow those of the bed."""
    bed = arrays.bed
    ny, nx = bed.materials.shape
    i = np.floor((where[:, 0] - bed.x0) / bed.spacing).astype(np.int64) % nx
    j = np.floor((where[:, 1] - bed.y0) / bed.spacing).astype(np.int64) % ny
    return np.where(what < 0, bed.materials[j, i], of_bed + what)


def tone_mapped(seen: Floats) -> Bytes:
    """Tone-map the light of lit surfaces and add the water, giving 8-bit colours."""
    light, given = seen[..., :3], seen[..., 3:]
    brightness = light @ LUMINANCE
    lit = brightness[brightness > 0.0]
    exposure = MIDDLE / np.exp(np.log(lit).mean()) if lit.size else 1.0
    white = max(exposure * float(np.percentile(lit, WHITE)), 1.0) if lit.size else 1.0
    # Reinhard's tone curve: nearly linear in the dark; highlights keep their form.
    exposed = exposure * light
    tone = exposed * (1.0 + exposed / white**2) / (1.0 + exposed)
    veiled = np.where(brightness[..., None] > 0.0, VEIL * CLEAR + (1.0 - VEIL) * tone, 0.0)
    return np.asarray(255.0 * np.clip(veiled + given, 0.0, 1.0) ** (1.0 / GAMMA) + 0.5, dtype=np.uint8)


def with_towfish(arrays: SceneArrays, cutaway: Cutaway, of_bed: int) -> SceneArrays:
    """Add the towfish, and a plumb line from it to the bed, to a packed scene."""
    longer = float((cutaway.high - cutaway.low)[:2].max())
    length, ahead = SIZE * longer, cutaway.axes[0]
    nose, waist, tail = (cutaway.lamp + share * length * ahead for share in (0.42, -0.3, -0.55))
    foot = np.array([*cutaway.lamp[:2], cutaway.low[2]])
    bodies = [
        frustum(waist, nose, 0.08 * length, 0.08 * length),
        ball(0.08 * length, nose),
        frustum(tail, waist, 0.02 * length, 0.08 * length),
        frustum(tail - 0.06 * length * ahead, tail + 0.1 * length * ahead, 0.12 * length, 0.02 * length),
        frustum(foot, cutaway.lamp, LINE * longer, LINE * longer),
    ]
    row = len(arrays.reflectivity)  # of their material
    own = pack_solids(bodies, np.full(len(bodies), row), np.full(len(bodies), row - of_bed))
    return arrays._replace(
        solids=Solids._make(np.concatenate(columns) for columns in zip(arrays.solids, own)),
        reflectivity=np.vstack([arrays.reflectivity, [0.3, 0.0, 1.0]]),
        interface=np.vstack([arrays.interface, [0.0, 1.0]]),
    )


def write_light(path: Path, optical: OpticalScene) -> tuple[int, int]:
    """Draw a scene by light, with its title, and write it as PNG."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    cutaway = make_cutaway(optical)
    image = light_picture(optical, cutaway)
    height, width, _ = image.shape
    figure = Figure(figsize=(width / DPI, height / DPI), dpi=DPI)
    FigureCanvasAgg(figure)
    figure.figimage(image)
    scene, (along, across, _) = optical.scene, cutaway.high - cutaway.low
    where = f"{scene.altitude:g} m above the bed" if scene.track.depth is None else f"{scene.track.depth:g} m deep"
    line = f"lamp at the sonar, {where}  ·  {along:.0f} m along the track, {across:.0f} m across"
    words = ((scene.title, 44, 15, "bold", INK), (line, 68, 10, "normal", FAINT))
    for text, down, size, weight, ink in words:
        figure.text(
            INSET / width, 1.0 - down / height, text, fontsize=size, fontweight=weight, color=ink, parse_math=False
        )
    with replacing(path) as beside, warnings.catch_warnings():
        warnings.filterwarnings("ignore", "Glyph .* missing")  # a title in any script
        figure.savefig(beside, dpi=DPI)
    return width, height
