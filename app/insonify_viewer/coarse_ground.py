"""Fewer nodes of new endless ground, for the pictures that are shown while a slider moves."""

from __future__ import annotations

from insonify.scene import Scene, SceneError, edit

THINNINGS = (4, 2)  # times the spacing; the first that resolves the waves of the relief is taken


def thin_new_ground(scene: Scene, known: Scene | None) -> Scene:
    """Scene on fewer nodes, where its ground is endless and not that of another scene whose tiles are known.

    Endless ground shares all but its finest waves with the same ground at a multiple of the spacing, and the time that
    a window takes falls with the square of it.

    Parameters
    ----------
    scene : Scene
    known : Scene or None
        The scene that was traced last at full accuracy.

    Returns
    -------
    Scene
        The scene itself where its ground is known, is not endless, or has waves that no wider spacing resolves.
    """
    if not scene.seabed.endless or (known is not None and _ground_of(scene) == _ground_of(known)):
        return scene
    for times in THINNINGS:
        try:
            return edit(scene, {"seabed.spacing": times * scene.seabed.spacing})
        except SceneError:  # waves of the relief are too short for it
            continue
    return scene


def _ground_of(scene: Scene) -> tuple[object, ...]:
    """Return what decides the tiles beneath the pings of a scene."""
    return scene.seabed, scene.seed, scene.track.start, scene.track.heading
