"""Which pictures stand below which rows of the panel."""

from __future__ import annotations

from insonify.display.scene_curves import beam_curve, pulse_curve, pulse_spectrum_curve, vertical_beam_curve
from insonify_viewer.panels.parameters.setting_pictures.base import SettingPicture
from insonify_viewer.panels.parameters.setting_pictures.curves_picture import CurvesPicture
from insonify_viewer.panels.parameters.setting_pictures.spectrum_picture import SpectrumPicture


def pictures_of_settings() -> dict[str, SettingPicture]:
    """Make the pictures, by the dotted path of the setting below whose rows they stand."""
    return {
        "sonar.beam": CurvesPicture(lambda scene: scene.sonar.beam.has_width, (beam_curve,)),
        "sonar.vertical": CurvesPicture(lambda scene: scene.sonar.vertical.shades, (vertical_beam_curve,)),
        "sonar.pulse": CurvesPicture(lambda scene: scene.sonar.pulse.length > 0.0, (pulse_curve, pulse_spectrum_curve)),
        "seabed.relief.peaks": SpectrumPicture(),
    }
