"""The plan of a run: the body of a scene, constant loads and boundaries, and the time steps."""

import logging
from collections.abc import Iterator
from math import ceil
from typing import Any, NamedTuple

import numpy as np
from scipy.sparse import csr_matrix
from scipy.sparse.csgraph import reverse_cuthill_mckee

from jointwave.cases.errors import SceneError
from jointwave.cases.material.rock_mass import refuse_beyond_strength
from jointwave.cases.run_memory import load_bytes, refuse_beyond_memory, waveform_bytes
from jointwave.cases.sampling import MOST_STEPS, Clock, clock, resolved_period, sample_times
from jointwave.cases.scene_type import AnyScene
from jointwave.continuum.mesh.size import of_coarse_cells
from jointwave.continuum.problem import problem_of
from jointwave.continuum.scene import SceneBody, body_of
from jointwave.continuum.space import compat
from jointwave.continuum.space.model import Body
from jointwave.continuum.space.rock import Rock
from jointwave.continuum.stepping.problem import Problem
from jointwave.continuum.stepping.scaling import scaled_mass
from jointwave.continuum.validity import refuse

log = logging.getLogger("jointwave")
STEPS_PER_IMPLICIT = 20  # explicit steps that one implicit step must replace to be considered
#: Matrix entries a second in products, and in triangular solves.
PRODUCT_RATE, FACTOR_RATE = 1e9, 3e8
#: Operations a second of a factorisation, and the overhead of an implicit step, s.
FACTORISATION_RATE, OVERHEAD = 1e9, 1e-3
STIFFER = 1.2  # stiffness of linear elements, over the exact one, from which to warn
ITERATIONS = 3  # of Newton's method where joints open, slide or break


class Choice(NamedTuple):
    """The time steps of a scene: "explicit" or "implicit", clock, and the reason in a phrase."""

    scheme: str
    time: Clock
    reason: str


class Plan(NamedTuple):
    """The plan of a run.

    found : the scene as a body. problem : the body with its constant loads and boundaries. choice :
    the time steps. critical : critical step of explicit steps, s.
    """

    found: SceneBody
    problem: Problem
    choice: Choice
    critical: float


def plan_of(
    scene: AnyScene,
    model: str = "jointed",
    rock: Rock | None = None,
    dim: int | None = None,
    comm: Any = None,
) -> Plan:
    """Return the plan of a run; arguments and errors as in `continuum.run.simulate`."""
    refuse(scene, model, dim)
    found = body_of(scene, model, rock, dim)
    if found.scripted or scene.mesh_path is not None:
        cells = compat.cell_corners(found.body.mesh), *map(found.of_cells, ("stiffness", "density"))
        what = "the mesh" if model == "jointed" else "the mesh of homogenised rock"
        what = "rock of a script" if found.scripted else what
        for line in of_coarse_cells(scene, what, *cells):
            log.warning(line)
    for line in of_stiff_elements(found):
        log.warning(line)
    refuse_beyond_strength(found.scene)
    problem = problem_of(scene, found)
    if problem.held.freedom.size == problem.body.mass.size:
        allowed = "hold every node of the mesh, so that nothing moves: it needs smaller elements"
        raise SceneError(scene.where, scene.side_table, None, allowed)
    implicit = scene.numerics.continuum.scheme == "implicit"
    scaled, plain = None if implicit else scaled_mass(problem), (found, problem)
    if scaled is not None:
        found = found._replace(body=found.body._replace(mass=scaled.mass))
        problem = problem_of(scene, found)
    critical = problem.critical_step()
    if comm is not None:
        critical = comm.bcast(critical)
    choice = choose(scene, problem, critical)
    if scaled is not None and choice.scheme == "explicit":
        log.warning(scaled.gained(critical))
    elif scaled is not None:
        found, problem = plain
    parts = {
        "record.interval": waveform_bytes(scene, problem.body.components > 1),
        "time.duration": load_bytes(scene, choice.time.steps),
    }
    refuse_beyond_memory(scene, parts)
    return Plan(found, problem._replace(comm=comm), choice, critical)


def of_stiff_elements(found: SceneBody) -> Iterator[str]:
    """Warn of linear elements that are too stiff in scenes where blocks rotate or pillars bend."""
    scene, body = found.scene, found.body
    if scene.is_column:
        turns = scene.is_spatial and scene.motion.rotation != "none" and not scene.mesh_path
    else:
        turns = len(scene.joint_sets) > 1 or not scene.boundaries.sides("periodic")
    if scene.numerics.continuum.order > 1 or body.x.shape[1] == 1 or not turns:
        return
    ratios = {"joints": _joint_ratio(found)} if len(body.joints.column) else {}
    if scene.is_column:
        ratios["rock"] = _bending_ratio(body, scene.pillar.side)
    if max(ratios.values(), default=0.0) > STIFFER:
        times = " and ".join(f"{name} {ratio:.3g}" for name, ratio in ratios.items())
        yield (
            f"numerics.continuum.order = 1: these elements make {times} times as stiff as they are "
            "where blocks turn or bend; order 2 is exact there"
        )


def _joint_ratio(found: SceneBody) -> float:
    """Return the second moments of the joints' points over those of their faces."""
    faces, joints = found.blocks.contacts, found.body.joints
    exact = np.trace(faces.second_moment, axis1=1, axis2=2)
    inner = joints.column < len(exact)  # not across periodic sides
    column, weight = joints.column[inner], joints.weight[inner]
    away = ((joints.place[inner] - faces.centroid[column]) ** 2).sum(axis=1)
    return float(weight @ away / exact[np.unique(column)].sum()) if len(column) else 0.0


def _bending_ratio(body: Body, side: float) -> float:
    """Return the bending stiffness of a pillar's rock at constant width, over that of a beam."""
    x, across, along = body.x, np.zeros_like(body.x), np.zeros_like(body.x)
    along[:, 1], across[:, 1], across[:, 0] = x[:, 1], x[:, 0] * x[:, 1], -(x[:, 1] ** 2) / 2
    bent, longer = (u.ravel() @ (body.stiffness @ u.ravel()) for u in (across, along))
    return float(12 * bent / longer / side**2)


def choose(scene: AnyScene, problem: Problem, critical: float) -> Choice:
    """Return the time steps of a scene, for "auto" by the faster scheme; critical : of explicit
    steps, s. Raises SceneError for an unstable step or too many steps."""
    numerics = scene.numerics.continuum

    def explicit(reason: str) -> Choice:
        given = numerics.step_fraction, numerics.allow_unstable
        return Choice("explicit", clock(scene, critical, *given, "continuum"), reason)

    by_key = f"numerics.continuum.scheme = '{numerics.scheme}'"
    if numerics.scheme == "explicit":
        return explicit(by_key)
    implicit = Choice("implicit", _implicit(scene), by_key)
    if numerics.scheme == "implicit":
        return implicit
    many, few = scene.time.duration / (critical * numerics.step_fraction), implicit.time.steps
    if many < STEPS_PER_IMPLICIT * few:
        few_more = f"{STEPS_PER_IMPLICIT} x {few:,} implicit ones"
        return explicit(f"{many:,.0f} explicit steps are fewer than {few_more}")
    stiffness, parts = problem.stiffness, problem.parts
    bends = parts is not None and (parts.no_tension or parts.softening or parts.slip)
    cheap = many * (stiffness.nnz + 10 * stiffness.shape[0]) / PRODUCT_RATE
    costly = _implicit_seconds(stiffness, bends, few)
    reason = (
        f"{many:,.0f} explicit steps, some {cheap:.2g} s, against {few:,} implicit ones, some "
        f"{costly:.2g} s"
    )
    return explicit(reason) if cheap <= costly else implicit._replace(reason=reason)


def _implicit(scene: AnyScene) -> Clock:
    many = scene.numerics.continuum.steps_per_period
    stride = max(1, ceil(scene.interval * many / resolved_period(scene) * (1 - 1e-12)))
    time = Clock(scene.interval / stride, stride, len(sample_times(scene)))
    if time.steps > MOST_STEPS:
        key = "numerics.continuum.steps_per_period"
        raise SceneError(scene.where, key, many, f"gives {time.steps:.3g} steps")
    return time


def _implicit_seconds(stiffness: csr_matrix, bends: bool, steps: int) -> float:
    """Return an estimate of the time of implicit steps, s, with triangular factors that fill the
    envelope of a narrow numbering."""
    order = reverse_cuthill_mckee(stiffness, symmetric_mode=True)
    narrow = stiffness[order][:, order].tocoo()
    reach = np.zeros(stiffness.shape[0], dtype=np.int64)
    np.maximum.at(reach, narrow.row, narrow.row - narrow.col)
    entries = float(2 * reach.sum() + reach.size)
    solve = entries / FACTOR_RATE + OVERHEAD
    factorise = entries**2 / max(stiffness.shape[0], 1) / FACTORISATION_RATE
    return steps * ITERATIONS * (solve + factorise) if bends else steps * solve + factorise
