"""Variants of a scene: without one of its effects, or with one alone."""

from collections.abc import Callable
from typing import Any

from cases.effects import active_effects
from cases.errors import SceneError
from cases.kinds import checked
from cases.material.strength import SLIP, SOFTENING
from cases.schema.scene import Scene


def left_out(scene: Scene, name: str) -> Scene:
    """Return a scene without one of its effects; raises SceneError where there is none."""
    if name not in WITHOUT:
        raise SceneError(scene.where, name, None, "is what the scene is about")
    return checked(WITHOUT[name](scene))


def only(scene: Scene, name: str | None) -> Scene:
    """Return a scene with one of its effects, or none, besides those that it cannot be without.

    Raises SceneError where the scene cannot be so, or cannot be without the effect either.
    """
    if name is not None and name in active_effects(only(scene, None)):
        raise SceneError(scene.where, name, None, "stays when all others go")
    for other in active_effects(scene):
        if other != name and other in WITHOUT:
            try:
                scene = left_out(scene, other)
            except SceneError:  # it stays, as it does when every other effect does
                continue
    if name is not None and name not in active_effects(scene):
        raise SceneError(scene.where, name, None, "does not act without the others")
    return scene


def _joints(**values: Any) -> Callable[[Scene], Scene]:
    """Return a function that changes the law of all joints, those of soft layers included."""

    def change(scene: Scene) -> Scene:
        layers = [layer.model_copy(update=values) for layer in scene.soft_layers]
        joints = scene.joints.model_copy(update=values)
        return scene.model_copy(update={"joints": joints, "soft_layers": layers})

    return change


def _table(name: str, **values: Any) -> Callable[[Scene], Scene]:
    def change(scene: Scene) -> Scene:
        table = getattr(scene, name).model_copy(update=values)
        return scene.model_copy(update={name: table})

    return change


def _free(kind: str) -> Callable[[Scene], Scene]:
    """Return a function that frees the ends of a kind."""

    def change(scene: Scene) -> Scene:
        ends = {k: "free" for k in ("start", "end") if getattr(scene.ends, k) == kind}
        return scene.model_copy(update={"ends": scene.ends.model_copy(update=ends)})

    return change


def _undamped(scene: Scene) -> Scene:
    return _table("damping", rayleigh=None)(_joints(damping_ratio=None)(scene))


#: By effect, what leaves it out of a scene.
WITHOUT: dict[str, Callable[[Scene], Scene]] = {
    "dashpots": _undamped,
    "no tension": _joints(tension=True),
    "joints that differ": lambda scene: scene.model_copy(update={"soft_layers": []}),
    **{f"{kind} ends": _free(kind) for kind in ("quiet", "matched", "fixed")},
    "energy ledger": _table("record", energy=False),
    "field output": _table("record", fields=None),
    "finite rotation": _table("motion", rotation="small"),
    "slip": _joints(**dict.fromkeys(SLIP)),
    "softening": _joints(**dict.fromkeys(SOFTENING)),
    "mass damping": _table("damping", mass_proportional=None, rayleigh=None),
    "local damping": _table("damping", local=None),
    "gravity": lambda scene: scene.model_copy(update={"gravity": None}),
    "prestress": lambda scene: scene.model_copy(update={"prestress": None}),
}
