"""What every effect of a scene costs, and what it is worth: how far the answer is without it.

Cost is that of a step of one rigid block; worth is the relative L2 misfit of the rigid blocks with
the effect left out, against those of the scene as it stands.
"""

from __future__ import annotations

from collections.abc import Callable
from math import nan
from typing import Any, NamedTuple

import dem
from cases.consistency import checked
from cases.effects import effects
from cases.errors import SceneError, UnstableError
from cases.scene import Scene
from compare.effort import nanoseconds, whole
from compare.engines import Progress
from compare.metrics import misfit


class Worth(NamedTuple):
    """One effect of a scene.

    cost : ns of a block-step that it adds. share : of the scene's own step. misfit : of the answer
    without it. reason : why it cannot be left out; empty where it can.
    """

    effect: str
    cost: float
    share: float
    misfit: float
    reason: str


class Balance(NamedTuple):
    """All effects of a scene; own, everything : ns of a block-step with its own and with all."""

    scene: Scene
    own: float
    everything: float
    effects: list[Worth]


def balance(scene: Scene, progress: Progress | None = None) -> Balance:
    """Return what every effect that a scene calls for costs and is worth."""
    called = [effect.name for effect in effects(scene) if effect.active]
    own, answer, found = nanoseconds(scene), dem.simulate(scene), []
    for i, name in enumerate(called):
        found.append(_worth(scene, name, own, answer))
        if progress:
            progress((i + 1) / len(called))
    return Balance(scene, own, whole(), found)


def _worth(scene: Scene, name: str, own: float, answer: Any) -> Worth:
    try:
        without = left_out(scene, name)
        cost = own - nanoseconds(without)
        return Worth(name, cost, cost / own, misfit(dem.simulate(without), answer), "")
    except (SceneError, UnstableError) as error:
        return Worth(name, nan, nan, nan, getattr(error, "allowed", str(error)))


def left_out(scene: Scene, name: str) -> Scene:
    """Return a scene without one of its effects; raises SceneError where there is none."""
    if name not in WITHOUT:
        raise SceneError(scene.where, name, None, "is what the scene is about")
    return checked(WITHOUT[name](scene))


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
    "slip": _joints(friction_angle=None, cohesion=None, residual_cohesion=None),
    "softening": _joints(tensile_strength=None, fracture_energy=None),
    "mass damping": _table("damping", mass_proportional=None, rayleigh=None),
    "local damping": _table("damping", local=None),
    "gravity": lambda scene: scene.model_copy(update={"gravity": None}),
    "prestress": lambda scene: scene.model_copy(update={"prestress": None}),
}
