"""Checks of a scene against the abilities of the methods, before anything is traced."""

from __future__ import annotations

from insonify.scene import Scene, SceneError


def check_method(scene: Scene, method: str, bounces: int) -> None:
    """Refuse what a scene asks for and a method cannot do.

    Parameters
    ----------
    scene : Scene
    method : str
        Asked for, or "auto".
    bounces : int
        That are to be followed.

    Raises
    ------
    SceneError
        One sentence with the field, the value and the remedy.
    """
    surface = scene.water.surface
    if bounces > 0 and method in ("sweep", "march"):
        raise SceneError(f"sonar.bounces: the {method} does not follow {bounces} of them; set it to 0 or use rays")
    if not scene.receiver.speckle.interferes:
        return
    if bounces > 0 or method in ("march", "rays"):
        other = f"bounces, of which sonar.bounces asks for {bounces}" if bounces > 0 else f"the method {method!r}"
        raise SceneError(f"receiver.speckle: 'coherent' is heard by the sweep, not by {other}; take another speckle")
    if surface.reflects:
        raise SceneError(
            f"water.surface: {surface.kind!r} makes ghosts, of which 'coherent' speckle knows nothing; take another "
            "receiver.speckle, or the surface 'none'"
        )


def check_refraction(scene: Scene, method: str) -> None:
    """Refuse what cannot be done where sound bends.

    Raises
    ------
    SceneError
        One sentence with the field, the value and the remedy.
    """
    surface = scene.water.surface
    if scene.receiver.speckle.interferes:
        raise SceneError(
            "receiver.speckle: 'coherent' adds waves that go straight, and in this water sound bends; take another "
            "speckle, or water.kind 'uniform'"
        )
    if scene.water.varies_along and method == "sweep":
        raise SceneError(
            "method: 'sweep' hears water that differs by depth alone, and this differs along a 'section'; take rays"
        )
    if surface.reflects:
        raise SceneError(
            f"water.surface: its ghosts ({surface.kind!r}) come along straight lines, and here sound bends; "
            "take the surface 'none', or water.kind 'uniform'"
        )
