"""Bounds on the velocity of rock: no node is faster than all forces together make it."""

import numpy as np

from jointwave.cases.sampling import Clock
from jointwave.cases.scene_type import AnyScene
from jointwave.cases.schema.pulse import shortest_period
from jointwave.continuum.scene import SceneBody
from jointwave.continuum.stepping.problem import Problem
from jointwave.numerics.divergence import speed_that

IN_PERIOD = 50  # forces that are looked at in the period of a pulse, at least


def highest_speed(
    found: SceneBody, problem: Problem, time: Clock, u: np.ndarray | None = None
) -> float:
    """Return a bound on the speed of any node, m/s; u : displacements at the start, m.

    Where forces F put energy in, d sqrt(2 E) / dt is at most |F| in the norm of 1 / m, and m v^2 of
    any node at most 2 E.
    """
    body, duration = problem.body, time.dt * (time.steps + time.stride)
    mass = body.mass
    rock, pushed, shaken, weight, stored = mass > 0, 0.0, 0.0, 0.0, 0.0
    if problem.forces is not None:
        pushed = problem.forces.impulse(mass, time.steps, sampled(found.scene, time))
    if problem.held is not None and problem.held.moved is not None:
        moved = problem.held.moved(np.arange(time.steps + 1)) / time.dt
        speed = np.diff(moved, prepend=0.0, append=0.0)
        shaken = np.abs(speed).sum() * np.sqrt(mass.sum())
    if problem.steady is not None:
        weight = np.sqrt((problem.steady[rock] ** 2 / mass[rock]).sum())
        stored = 0.0 if u is None else np.sqrt(2 * abs(problem.steady @ u))
    least = np.sqrt((1 / mass[rock]).max())
    with np.errstate(over="ignore"):
        pressed = prestressed(found, problem, duration * least)
        return float(least * speed_that(pushed, shaken, duration * weight, stored, pressed))


def sampled(scene: AnyScene, time: Clock) -> int:
    """Return how many steps apart forces are looked at, which must not miss a pulse."""
    period = shortest_period(scene.pulses)
    most = time.stride if period is None else int(period / (IN_PERIOD * time.dt))
    return max(1, min(time.stride, most))


def prestressed(found: SceneBody, problem: Problem, pushing: float) -> float:
    """Return the root of twice the energy (sqrt(J)) that a prestress keeps in rock and joints, and
    that rock gives off by pushing on both sides of joints that open, so long (s/sqrt(kg))."""
    stress, joints, law = problem.stress, problem.body.joints, problem.law
    if stress is None:
        return 0.0
    softest = min(np.linalg.eigvalsh(one.stiffness).min() for one in found.materials)
    softest *= 1.0 if problem.mechanisms is None else problem.mechanisms.relaxed
    stored = float((stress**2).sum()) / softest * float(found.blocks.volume.sum())
    if joints is None or law is None:
        return float(np.sqrt(stored))
    size, area = float(np.abs(stress).max()), float(joints.weight.sum())
    springs = [k for k in (law.normal_stiffness, law.shear_stiffness) if k is not None]
    stored += 4 * size**2 * area * max(np.max(1 / k) for k in springs)
    return float(np.sqrt(stored)) + pushing * 4 * size * area
