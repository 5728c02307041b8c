"""Checks of a scene against the abilities of the methods, before anything is traced."""

from insonify.scene import Scene, SceneError
from insonify.tracers.base import AUTO, find_tracer


def check_method(scene: Scene, method: str, bounces: int) -> None:
    """Raise an error if a method cannot simulate what the scene declares."""
    tracer = None if method == AUTO else find_tracer(method)
    surface = scene.water.surface
    if bounces > 0 and tracer is not None and not tracer.follows_bounces:
        raise SceneError(f"sonar.bounces: {method!r} does not follow bounces, here {bounces}; set it to 0 or use rays")
    if scene.receiver.speckle.interferes:
        if bounces > 0 or (tracer is not None and not tracer.sums_waves):
            other = f"bounces (sonar.bounces is {bounces})" if bounces > 0 else f"the method {method!r}"
            raise SceneError(f"receiver.speckle: 'coherent' is part of the sweep, not of {other}; take another speckle")
        if surface.reflects:
            raise SceneError(
                f"water.surface: {surface.kind!r} adds multipath, which 'coherent' speckle does not include; take "
                "another receiver.speckle, or the surface 'none'"
            )
    if tracer is not None:
        tracer.refuse(scene)


def check_refraction(scene: Scene, method: str) -> None:
    """Raise an error if water that refracts sound is combined with an effect computed along straight rays only."""
    surface = scene.water.surface
    if scene.receiver.speckle.interferes:
        raise SceneError(
            "receiver.speckle: 'coherent' sums waves along straight paths, and this water refracts sound; take another "
            "speckle, or water.kind 'uniform'"
        )
    if scene.water.varies_along and method != AUTO and not find_tracer(method).refracts_along:
        raise SceneError(
            f"method: {method!r} refracts sound by depth only, and a 'section' varies along the range; take rays"
        )
    if surface.reflects:
        raise SceneError(
            f"water.surface: multipath ({surface.kind!r}) follows straight paths, and this water refracts sound; "
            "take the surface 'none', or water.kind 'uniform'"
        )
