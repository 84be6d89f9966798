"""Ranking of solutions by what they resolve of a scene, and its reference.

The reference of a scene is the solution that leaves out the least: the finest rock first, then an
exact one before a computed one. A solution that lacks an effect of the scene is never a reference.
What no solution at least as fine has checked independently is "not checked".
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
    """What a scene's solutions are held against, and why in words."""

    name: str
    reason: str


NOT_CHECKED = "not checked independently"


def lacks(name: str, scene: AnyScene) -> str:
    """Return the effect of a scene that a solution which applies to it leaves out, "" where none.

    The thickness of a soft layer: rigid blocks take it for a joint. The inertia across the axis of
    a column of two or three dimensions: a bar has none.
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
    """Return the solution among `names` that leaves out the least; None where none is complete."""
    complete = [name for name in names if not lacks(name, scene)]
    if not complete:
        return None
    name = max(complete, key=_fineness)
    of = solver(name)
    how = "exact" if of.exact else "computed; no exact solution of this scene exists"
    return Reference(name, f"{of.rock.words}, {how}")


def reference_of(name: str, names: Iterable[str], scene: AnyScene) -> Reference | None:
    """Return what one solution is held against: the finest of the others.

    None where none of them is finer, or as fine and exact: it is not checked independently.
    """
    found = finest([other for other in names if other != name], scene)
    if found is None:
        return None
    return found if _fineness(found.name) > _fineness(name) else None


def own_exact(name: str, names: Iterable[str], scene: AnyScene) -> str | None:
    """Return the exact solution of an engine's own model among `names`, what its numerical error is
    measured from; None where there is none."""
    rock, own = solver(name).rock, []
    for other in names:
        of = solver(other)
        if other != name and of.rock is rock and of.exact and of.discretised:
            own.append(other)
    found = finest(own, scene)
    return found.name if found else None


def deciding(scene: AnyScene) -> dict[str, Answer]:
    """Return whether each of the solutions that verdicts rest on applies to a scene: the engines,
    of each the reference and the exact solution of its own model, and those that [expect] names.
    All of them where no engine applies."""
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
    """Return of every engine and exact solution of a scene's kind whether it applies to it."""
    return {name: applies(name, scene) for name in names(scene.kind)}
