"""Effects of a scene that are taken out and brought back by a tick: what they are, and what each changes."""

from __future__ import annotations

from insonify_viewer.effects.catalogue import EFFECTS, Effect
from insonify_viewer.effects.meter import EffectMeter
from insonify_viewer.effects.rows import EffectRow, EffectTicks

__all__ = ["EFFECTS", "Effect", "EffectMeter", "EffectRow", "EffectTicks"]
