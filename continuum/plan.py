"""A run before its first step: the body of a scene, what acts on it, and how it is stepped."""

from __future__ import annotations

import logging
from typing import Any, NamedTuple

from jointwave.cases.material.rock_mass import refuse_beyond_strength
from jointwave.cases.run_memory import load_bytes, refuse_beyond_memory, waveform_bytes
from jointwave.cases.scene_type import AnyScene
from jointwave.continuum.problem import problem_of
from jointwave.continuum.scene import SceneBody, body_of
from jointwave.continuum.scheme import Choice, choose
from jointwave.continuum.space.rock import Rock
from jointwave.continuum.stepping.problem import Problem
from jointwave.continuum.stepping.scaling import scaled_mass
from jointwave.continuum.validity import refuse

log = logging.getLogger("jointwave")


class Plan(NamedTuple):
    """A run before its first step.

    found : the scene as a body. problem : the body and what acts on it all the time. choice : how
    it is stepped. critical : the critical step of explicit steps, s.
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
    """Return the run of a scene; arguments and errors as of `continuum.run.simulate`."""
    refuse(scene, model, dim)
    found = body_of(scene, model, rock, dim)
    refuse_beyond_strength(found.scene)
    problem = problem_of(scene, found)
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
