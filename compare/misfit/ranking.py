"""Ranking of solutions by the detail that they resolve, and the reference of a scene.

The reference of a scene is its most complete solution: the finest rock first, then exact before
computed solutions. If the intact rock is unknown, rigid blocks and homogenised rock are two models
of the same wave speeds: exact solutions then come first. A solution that lacks an effect of the
scene is never a reference. A solution is "not checked" if no other, at least as fine, checks it
independently. Only solutions of the same model differ by a numerical error.
"""

from collections.abc import Iterable
from typing import Any, NamedTuple

from jointwave.cases.errors import SceneError
from jointwave.cases.material.calibrate import calibrate
from jointwave.cases.scene_type import AnyScene
from jointwave.compare.engines import ENGINES, applies, names, solver
from jointwave.compare.exact.conditions import has_thick_layer
from jointwave.compare.scenes import AnySource, bound_of, load
from jointwave.compare.solvers.incident import incident
from jointwave.compare.solvers.record import Answer, Kind, Rock


class Reference(NamedTuple):
    """The reference of a scene's solutions, and the reason as text."""

    name: str
    reason: str


NOT_CHECKED = "not checked independently"


def lacks(name: str, scene: Any) -> str:
    """Return the effect of a scene that an applicable solution leaves out, "" if none.

    Rigid blocks model a soft layer's thickness as a joint; bars have no lateral inertia.
    """
    of, mesh = solver(name), scene.numerics.continuum
    if of.rock is Rock.RIGID_BLOCKS:
        return "the thickness of a soft layer" if has_thick_layer(scene) else ""
    is_bar = of.dimension == 1 and of.rock in (Rock.JOINTED, Rock.HOMOGENISED)
    if not is_bar or scene.rotation == "none" or (mesh.dim in (None, 1) and mesh.mesh is None):
        return ""
    poisson = scene.rock.intact_poisson if of.rock is Rock.JOINTED else calibrate(scene).poisson
    return "lateral inertia" if poisson else ""


def finest(names: Iterable[str], scene: AnyScene) -> Reference | None:
    """Return the most complete solution among `names`; None if each lacks an effect."""
    complete = [name for name in names if not lacks(name, scene)]
    if not complete:
        return None
    name = max(complete, key=lambda one: _fineness(one, scene))
    of = solver(name)
    how = "exact" if of.exact else "computed, its own error unknown"
    return Reference(name, f"{of.rock.words}, {how}")


def reference_of(name: str, names: Iterable[str], scene: AnyScene) -> Reference | None:
    """Return the reference of one solution: the finest of the others. None if none of them is
    finer, or equally fine and exact: the solution is not checked independently."""
    found = finest([other for other in names if other != name], scene)
    if found is None:
        return None
    return found if _fineness(found.name, scene) > _fineness(name, scene) else None


def own_exact(name: str, names: Iterable[str], scene: AnyScene) -> str | None:
    """Return the exact solution of an engine's own model among `names`, the reference for its
    numerical error; None without one."""
    own = [n for n in names if n != name and solver(n).exact and same_model(name, n, scene)]
    found = finest(own, scene)
    return found.name if found else None


def same_model(one: str, other: str, scene: AnyScene) -> bool:
    """Return whether two solutions resolve the same model of a scene, so that their distance is a
    numerical error: the same rock with the same effects, not a single mechanism."""
    a, b = solver(one), solver(other)
    whole = a.discretised and b.discretised
    return a.rock is b.rock and whole and lacks(one, scene) == lacks(other, scene)


def kind_of(one: str, other: str, scene: AnyScene) -> Kind:
    """Return the meaning of the distance of two solutions in a scene."""
    if not (solver(one).exact or solver(other).exact):
        return Kind.BETWEEN
    return Kind.NUMERICAL if same_model(one, other, scene) else Kind.MODELLING


def deciding(scene: AnyScene) -> dict[str, Answer]:
    """Return whether each solution needed for verdicts applies to a scene: engines, their
    references, the exact solutions of their models, and those named in [expect]; all solutions if
    no engine applies."""
    answers = applicable(scene)
    able = [name for name, answer in answers.items() if answer]
    if not ENGINES.keys() & able:
        return answers
    wanted: set[str | None] = {*ENGINES}
    for engine in (name for name in ENGINES if name in able):
        reference = reference_of(engine, able, scene)
        wanted |= {reference and reference.name, own_exact(engine, able, scene)}
    wanted |= {name for key in scene.expect for name in bound_of(key)[:2]}
    return {name: answer for name, answer in answers.items() if name in wanted}


def _fineness(name: str, scene: AnyScene) -> tuple[bool, int, int]:
    of = solver(name)
    known = scene.rock.intact_modulus is not None
    first = not known and of.exact and of.rock is not Rock.ONE_BODY
    return first, int(of.rock), int(of.form)


def solvers(scene: AnySource) -> dict[str, str]:
    """Return all engines and exact solutions for a scene's kind by name, with the reason why one
    does not apply, or ""."""
    scene = load(scene)
    found = {name: answer.reason for name, answer in applicable(scene).items()}
    try:
        incident(scene)
    except SceneError as error:  # engines need the field of the waves
        found |= {name: found[name] or f"{error.key} {error.allowed}" for name in ENGINES}
    return found


def applicable(scene: AnyScene) -> dict[str, Answer]:
    """Return whether each engine and exact solution for a scene's kind applies to it."""
    return {name: applies(name, scene) for name in names(scene.kind)}
