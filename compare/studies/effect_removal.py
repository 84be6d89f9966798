"""Scenes without one of their effects."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from jointwave.cases.errors import SceneError
from jointwave.cases.material.strength import SLIP
from jointwave.cases.plane.effects import SIDES
from jointwave.cases.scene_type import AnyScene, Either, checked
from jointwave.cases.schema.damping import Attenuating
from jointwave.cases.schema.joint import PARTS
from jointwave.cases.schema.scene import Scene

Change = Callable[[Any], Any]  # from a scene to one of its kind


def left_out(scene: Either, name: str) -> Either:
    """Return a scene without one of its effects; raises SceneError if there is no such scene."""
    if name not in WITHOUT:
        raise SceneError(scene.where, name, None, "is the subject of the scene")
    return checked(WITHOUT[name](scene))


def _joints(**values: Any) -> Change:
    """Return a function that changes the law of all joints, including soft layers."""

    def change(scene: AnyScene) -> AnyScene:
        if not isinstance(scene, Scene):
            sets = [one.model_copy(update=values) for one in scene.joint_sets]
            return scene.model_copy(update={"joint_sets": sets})
        layers = [layer.model_copy(update=values) for layer in scene.soft_layers]
        joints = scene.joints.model_copy(update=values)
        return scene.model_copy(update={"joints": joints, "soft_layers": layers})

    return change


def _table(name: str, **values: Any) -> Change:
    def change(scene: AnyScene) -> AnyScene:
        table = getattr(scene, name).model_copy(update=values)
        return scene.model_copy(update={name: table})

    return change


def _free(table: str, kind: str) -> Change:
    """Return a function that frees the ends, or the sides, of a kind."""

    def change(scene: AnyScene) -> AnyScene:
        held = getattr(scene, table)
        free = {name: "free" for name, found in held if found == kind}
        return scene.model_copy(update={table: held.model_copy(update=free)})

    return change


#: By effect, the change that leaves it out of a scene.
WITHOUT: dict[str, Change] = {
    "dashpots": lambda scene: _table("damping", rayleigh=None)(_joints(damping_ratio=None)(scene)),
    "no tension": _joints(tension=None),
    "joints that differ": lambda scene: scene.model_copy(update={"soft_layers": []}),
    "scatter": lambda scene: scene.model_copy(update={"scatter": None}),
    "segments": lambda scene: scene.model_copy(update={"segments": []}),
    **{f"{kind} ends": _free("ends", kind) for kind in ("quiet", "matched", "fixed")},
    **{f"{kind} sides": _free("boundaries", kind) for kind in SIDES},
    "energy ledger": _table("record", energy=False),
    "field output": _table("record", fields=None),
    "finite rotation": _table("motion", rotation="small"),
    "slip": _joints(
        **dict.fromkeys((*SLIP, *(key for part in PARTS if part.along for key in part.all_keys)))
    ),
    **{part.name: _joints(**dict.fromkeys(part.all_keys)) for part in PARTS},
    "mass damping": _table("damping", mass_proportional=None, rayleigh=None),
    "constant Q": _table("rock", **dict.fromkeys(Attenuating.model_fields)),
    "local damping": _table("damping", local=None),
    "gravity": lambda scene: scene.model_copy(update={"gravity": None}),
    "prestress": lambda scene: scene.model_copy(update={"prestress": None}),
}
