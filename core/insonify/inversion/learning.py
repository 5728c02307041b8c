"""Bed from a record: a scene with a similar simulated record, found by simulation, and compared with the record."""

import tempfile
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from insonify.inversion.bed_parameters import slope_above
from insonify.inversion.footprint import footprint_of
from insonify.inversion.matching import UNDETERMINED, Matching, level_difference, speed_of_sound
from insonify.inversion.recorded_sonar import RecordedSonar, declare_sonar
from insonify.inversion.roughness_fit import FINEST, RoughnessFit, estimate_beam, estimate_pulse, fit_roughness
from insonify.inversion.segment_spectra import SegmentSpectra, SoundedBed, measure_segment_spectra, sound_bed
from insonify.io.atomic import replacing, write_text
from insonify.scene import Scene, scene_to_toml
from insonify.scene.edit import edit
from insonify.simulation import simulate
from insonify.statistics.record_statistics import RecordStatistics, measure_statistics

MATCHED, DIFFERS, TAKEN, ESTIMATED, UNKNOWN = "matched", "differs", "as recorded", "estimated", "not in the record"
LONGEST = 2048  # pings, from the middle of a longer record
DESCRIPTION = (
    "Relief, material and speckle are learned from a record. The landscape is another one of the same statistics, and "
    "targets are left out: place your own. Change the seed for another bed of this kind."
)
Navigation = Mapping[str, NDArray[np.float64]]


class Finding(NamedTuple):
    """One line of the report."""

    quantity: str  # name of the quantity
    recorded: str  # its values; empty if unknown
    simulated: str
    verdict: str  # ``matched``, ``differs``, ``as recorded``, ``estimated`` or ``not in the record``


@dataclass(frozen=True)
class Learned:
    """A scene learned from a record, and the comparison of both records."""

    scene: Scene  # on a straight, level track
    findings: tuple[Finding, ...]  # quantities that match, that differ, and that the record does not show
    # Time, x, y, altitude and heading of a track that is not straight and level.
    navigation: Navigation | None = None

    def lines(self) -> list[str]:
        """Lay out the findings as lines of a table with a heading."""
        rows = [("", "record", "scene", ""), *self.findings]
        widths = [max(len(row[column]) for row in rows) for column in range(3)]
        return ["  ".join([*(text.ljust(width) for text, width in zip(row, widths)), row[3]]).rstrip() for row in rows]

    def summarise(self) -> str:
        """Summarise in one clause how the record of the scene compares with the recording."""
        differing = [found.quantity for found in self.findings if found.verdict == DIFFERS]
        return f"differs from the recording in: {', '.join(differing)}" if differing else "matches the recording"

    def write(self, path: str | Path) -> list[Path]:
        """Write the scene as TOML, and its track as CSV beside it where that is not straight; return the files."""
        path, scene = Path(path), self.scene
        written = [path]
        if self.navigation is not None:
            beside = path.with_name(f"{path.stem}-track.csv")
            with replacing(beside) as unfinished:
                scene = _on_track(scene, self.navigation, unfinished, beside.name)
            written.append(beside)
        write_text(path, scene_to_toml(scene))
        return written


def learn(
    record: xr.Dataset,
    changes: Mapping[str, Any] | None = None,
    *,
    progress: Callable[[float], None] | None = None,
) -> Learned:
    """Learn a scene from a record.

    Sonar and track are those that the record declares. Relief, material, speckle and level are fitted. Then the scene
    is simulated, the same fit is made of its record, and the difference corrects the parameters (indirect inference:
    Gouriéroux, Monfort and Renault 1993).

    Parameters
    ----------
    record : Dataset
        From ``records.read_record`` or `simulate`.
    changes : mapping of str to object, optional
        Fields of the scene by dotted path that the record does not contain, such as ``{"sonar.beam.width": 0.5}``.
    progress : callable, optional
        Called now and then with the share done, from 0 to 1; may raise to stop.

    Returns
    -------
    Learned

    Raises
    ------
    SceneError
        If the record shows too little bed, or a field is given that is learned.
    """
    record = _middle(record)
    sonar = declare_sonar(record, changes or {})
    bed = sound_bed(record, sonar.altitude, separate=not sonar.simulated)
    spectra = measure_segment_spectra(bed)
    sonar = _estimate_sonar(sonar, bed, spectra)
    with _staged_track(sonar.scene, sonar.navigation) as scene:
        candidate, fit = Matching(scene, sonar, bed, spectra, progress or (lambda share: None)).match()
        own = simulate(candidate.set_on(scene))
    title = f"Learned from {str(record.attrs.get('title', '')) or 'a record'}"[:200]
    learned = edit(candidate.set_on(sonar.scene), {"title": title, "description": DESCRIPTION})
    return Learned(learned, report_findings(record, own, sonar, learned, fit), sonar.navigation)


def _middle(record: xr.Dataset) -> xr.Dataset:
    """Cut a long record to the pings in its middle."""
    pings = record.sizes["ping_time"]
    first = max(pings - LONGEST, 0) // 2
    return record.isel(ping_time=slice(first, first + LONGEST))


def _estimate_sonar(sonar: RecordedSonar, bed: SoundedBed, spectra: SegmentSpectra) -> RecordedSonar:
    """Estimate pulse and beam from the record where nothing declares them."""
    scene, speed = sonar.scene, speed_of_sound(sonar.scene)
    if "sonar.pulse" in sonar.assumed:
        scene = edit(scene, {"sonar.pulse": estimate_pulse(spectra, bed.bin_length, speed)})
    if "sonar.beam" in sonar.assumed:
        scene = edit(scene, {"sonar.beam.width": estimate_beam(spectra, scene, speed)})
    return sonar._replace(scene=scene)


@contextmanager
def _staged_track(scene: Scene, navigation: Navigation | None) -> Iterator[Scene]:
    """Yield a scene on a recorded track, from a temporary file that is removed after the block."""
    if navigation is None:
        yield scene
        return
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "track.csv"
        yield _on_track(scene, navigation, file, str(file))


def _on_track(scene: Scene, navigation: Navigation, file: Path, path: str) -> Scene:
    """Write a track as CSV, and return the scene towed along it by the path of the finished file."""
    table = np.column_stack(list(navigation.values()))
    np.savetxt(file, table, fmt="%.6g", delimiter=",", header=",".join(navigation), comments="")
    return edit(scene, {"track.motion": {"kind": "recorded", "path": path}})


def report_findings(
    record: xr.Dataset, own: xr.Dataset, sonar: RecordedSonar, scene: Scene, fit: RoughnessFit
) -> tuple[Finding, ...]:
    """Compare a record with the simulated record of the scene learned from it."""
    return (
        *_geometry(record, sonar, scene),
        *_sonar(sonar, scene),
        *_bed(record, own, sonar, scene, fit),
        *_statistics(measure_statistics(record), measure_statistics(own)),
        Finding("targets", "", "none", UNKNOWN),
    )


def _geometry(record: xr.Dataset, sonar: RecordedSonar, scene: Scene) -> Iterator[Finding]:
    """Altitude, track and range, which the scene copies."""
    low, mean, high = (float(value(sonar.altitude)) for value in (np.min, np.mean, np.max))
    kept = f"{scene.altitude:.1f} m" if sonar.navigation is None else f"{low:.1f} to {high:.1f} m"
    yield Finding("altitude", f"{mean:.1f} m ({low:.1f} to {high:.1f})", kept, TAKEN)
    pings, spacing = record.sizes["ping_time"], scene.track.speed / scene.sonar.ping_rate
    shape = "straight" if sonar.navigation is None else "as recorded"
    yield Finding("track", f"{pings} pings", f"{pings} pings {spacing:.3g} m apart, {shape}", TAKEN)
    reach = f"{scene.sonar.range:.4g} m in {scene.sonar.bins} bins"
    yield Finding("range", reach, reach, TAKEN)


def _sonar(sonar: RecordedSonar, scene: Scene) -> Iterator[Finding]:
    """Beam, pulse and frequency: declared, estimated or assumed."""
    pulse = scene.sonar.pulse
    lasts = f" of {1e6 * pulse.length:.3g} µs" if pulse.length > 0.0 else ""
    declared = {
        "frequency": (f"{scene.sonar.frequency / 1e3:.4g} kHz", UNKNOWN),
        "beam": (scene.sonar.beam.words, ESTIMATED),
        "pulse": (f"{pulse.kind}{lasts}", ESTIMATED),
    }
    for name, (text, otherwise) in declared.items():
        verdict = otherwise if f"sonar.{name}" in sonar.assumed else TAKEN
        yield Finding(name, text if verdict == TAKEN else "", text, verdict)


def _bed(
    record: xr.Dataset, own: xr.Dataset, sonar: RecordedSonar, scene: Scene, fit: RoughnessFit
) -> Iterator[Finding]:
    """Relief, patches, speckle and level."""
    footprint = footprint_of(scene, speed_of_sound(scene))
    altitude = own["platform_altitude"].values if sonar.simulated else sonar.altitude
    separate = not sonar.simulated
    recorded = sound_bed(record, sonar.altitude, separate=separate)
    simulated = sound_bed(own, altitude, separate=separate)
    patches = fit.patches is not None
    again = fit_roughness(measure_segment_spectra(simulated), footprint, patches=patches, near=fit)
    yield from _relief(fit, again, scene, FINEST * footprint.cell)
    yield _compare("speckle, variance of amplitude", fit.speckle, again.speckle, 0.15 * fit.speckle + 0.01, ".3f")
    difference = level_difference(recorded, simulated)
    if sonar.simulated:
        yield Finding("material level", "0.0 dB", f"{-difference:+.1f} dB", _verdict(difference, 0.0, 1.0))
    else:
        yield Finding("material level", "", scene.seabed.material.materials[0].name, UNKNOWN)
        yield Finding("level over range", "0.0 dB", f"{-difference:+.1f} dB", _verdict(difference, 0.0, 1.0))


def _relief(fit: RoughnessFit, again: RoughnessFit, scene: Scene, shortest: float) -> Iterator[Finding]:
    """Exponent and strength of the relief as both records show them, and the slope of the learned bed."""
    if fit.relief.log_level_error >= UNDETERMINED:
        yield Finding("relief", "none above the speckle", "flat", UNKNOWN)
        return
    one, other = fit.relief, again.relief
    error = f" ± {one.exponent_error:.2f}"
    verdict = _verdict(one.exponent, other.exponent, 0.15)
    yield Finding("relief, exponent as it shows", f"{one.exponent:.2f}{error}", f"{other.exponent:.2f}", verdict)
    ratio = float(np.exp(0.5 * (other.log_level - one.log_level)))
    yield Finding("relief, height as it shows", "1.00", f"{ratio:.2f}", _verdict(ratio, 1.0, 0.2))
    text = f"{getattr(scene.seabed.relief, 'beta', 0.0):.2f}; {slope_above(scene, shortest):.3f}"
    yield Finding(f"relief, exponent and slope above {shortest:.2g} m", "", text, ESTIMATED)


def _statistics(one: RecordStatistics, other: RecordStatistics) -> Iterator[Finding]:
    """Statistics that `insonify compare` measures."""
    middle, own = (float(np.median(each.variation)) for each in (one, other))
    yield _compare("variation in even patches", middle, own, 0.15 * middle + 0.01, ".2f")
    yield _compare("spectral slope along track", one.along.slope(), other.along.slope(), 0.15, ".2f")
    yield _compare("spectral slope across", one.across.slope(), other.across.slope(), 0.15, ".2f")
    depths = [one.shadow_depth, other.shadow_depth]
    shown = tuple("none" if np.isnan(depth) else f"{depth:.0f} dB" for depth in depths)
    alike = np.isnan(depths).all() or abs(depths[0] - depths[1]) <= 3.0
    yield Finding("shadows", shown[0], shown[1], MATCHED if alike else DIFFERS)


def _compare(quantity: str, one: float, other: float, tolerance: float, form: str) -> Finding:
    """Compare two numbers that may differ by a tolerance."""
    return Finding(quantity, f"{one:{form}}", f"{other:{form}}", _verdict(one, other, tolerance))


def _verdict(one: float, other: float, tolerance: float) -> str:
    return MATCHED if abs(one - other) <= tolerance else DIFFERS
