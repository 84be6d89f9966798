"""Ranking of solutions by the detail that they resolve, and the reference of a scene.

The reference of a scene is its most complete solution: the finest rock first, then an exact one
before a computed one. A solution that lacks an effect of the scene is never a reference. A solution
that no other, at least as fine, checks independently is "not checked".
"""

from collections.abc import Iterable
from typing import NamedTuple

from cases.kinds import AnyScene
from cases.material.calibrate import calibrate
from cases.schema.scene import Scene
from compare.engines import ENGINES, applies, names, solver
from compare.exact.conditions import has_thick_layer
from compare.solvers.record import Answer, Rock


class Reference(NamedTuple):
    """The reference of a scene's solutions, and the reason in words."""

    name: str
    reason: str


NOT_CHECKED = "not checked independently"


def lacks(name: str, scene: AnyScene) -> str:
    """Return the effect of a scene that an applicable solution leaves out, "" if none.

    The thickness of a soft layer: rigid blocks model it as a joint. The lateral inertia of a column
    in two or three dimensions: a bar has none.
    """
    of = solver(name)
    if not isinstance(scene, Scene):
        return ""
    if has_thick_layer(scene) and of.rock is Rock.RIGID_BLOCKS:
        return "the thickness of a soft layer"
    dim, free_sides = scene.numerics.continuum.dim or 1, scene.motion.rotation != "none"
    if dim > 1 and of.dimension == 1 and free_sides and of.rock in (Rock.JOINTED, Rock.HOMOGENISED):
        poisson = scene.rock.intact_poisson if of.rock is Rock.JOINTED else calibrate(scene).poisson
        return "lateral inertia" if poisson else ""
    return ""


def finest(names: Iterable[str], scene: AnyScene) -> Reference | None:
    """Return the most complete solution among `names`; None if none has all effects."""
    complete = [name for name in names if not lacks(name, scene)]
    if not complete:
        return None
    name = max(complete, key=_fineness)
    of = solver(name)
    how = "exact" if of.exact else "computed; no exact solution of this scene exists"
    return Reference(name, f"{of.rock.words}, {how}")


def reference_of(name: str, names: Iterable[str], scene: AnyScene) -> Reference | None:
    """Return the reference of one solution: the finest of the others.

    None if none of them is finer, or equally fine and exact: it is not checked independently.
    """
    found = finest([other for other in names if other != name], scene)
    if found is None:
        return None
    return found if _fineness(found.name) > _fineness(name) else None


def own_exact(name: str, names: Iterable[str], scene: AnyScene) -> str | None:
    """Return the exact solution of an engine's own model among `names`, the reference of its
    numerical error; None if there is none."""
    rock, own = solver(name).rock, []
    for other in names:
        of = solver(other)
        if other != name and of.rock is rock and of.exact and of.discretised:
            own.append(other)
    found = finest(own, scene)
    return found.name if found else None


def deciding(scene: AnyScene) -> dict[str, Answer]:
    """Return whether each of the solutions that verdicts need applies to a scene: the engines, the
    reference and the exact solution of each engine's own model, and those named by [expect]. All
    solutions if no engine applies."""
    answers = applicable(scene)
    able = [name for name, answer in answers.items() if answer]
    if not ENGINES.keys() & able:
        return answers
    wanted: set[str | None] = {*ENGINES}
    for engine in (name for name in ENGINES if name in able):
        reference = reference_of(engine, able, scene)
        wanted |= {reference and reference.name, own_exact(engine, able, scene)}
    wanted |= {name for pair in scene.expect for name in pair.split(" ~ ")}
    return {name: answer for name, answer in answers.items() if name in wanted}


def _fineness(name: str) -> tuple[int, int]:
    of = solver(name)
    return int(of.rock), int(of.form)


def applicable(scene: AnyScene) -> dict[str, Answer]:
    """Return whether each engine and exact solution of a scene's kind applies to it."""
    return {name: applies(name, scene) for name in names(scene.kind)}
