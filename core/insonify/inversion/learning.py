"""Bed from a record: a scene with a similar simulated record, found by simulation and comparison."""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from insonify.inversion.findings import DIFFERS, Finding, format_table, report_findings
from insonify.inversion.matching import Matching, speed_of_sound
from insonify.inversion.recorded_sonar import RecordedSonar, declare_sonar
from insonify.inversion.roughness_fit import estimate_beam, estimate_pulse
from insonify.inversion.segment_spectra import SegmentSpectra, SoundedBed, measure_segment_spectra, sound_bed
from insonify.io.atomic import replacing
from insonify.scene import Scene, scene_to_toml
from insonify.scene.edit import edit
from insonify.simulation import simulate

LONGEST = 2048  # pings, from the middle of a longer record
DESCRIPTION = (
    "Relief, material and speckle are learned from a record. The landscape is another one of the same statistics, and "
    "targets are left out: place your own. Change the seed for another bed of this kind."
)
Navigation = Mapping[str, NDArray[np.float64]]


@dataclass(frozen=True)
class Learned:
    """A scene learned from a record, and the comparison of both records."""

    scene: Scene  # on a straight, level track
    findings: tuple[Finding, ...]  # quantities that match, that differ, and that the record does not show
    # Time, x, y, altitude and heading of a track that is not straight and level.
    navigation: Navigation | None = None

    def lines(self) -> list[str]:
        """Lay out the findings as lines of a table."""
        return format_table(self.findings)

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
        with replacing(path) as unfinished:
            unfinished.write_text(scene_to_toml(scene), encoding="utf-8")
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
