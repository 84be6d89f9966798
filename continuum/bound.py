"""How fast any node of the rock can become at most: what a run is held to."""

import numpy as np

from cases.calibrate import Properties
from cases.sampling import Clock
from cases.scene import Scene
from continuum.model import Model, State
from continuum.parallel.serial import Alone
from joints.guard import speed_that


def highest_speed(
    scene: Scene, p: Properties, model: Model, state: State, time: Clock, team: Alone
) -> float:
    """Return a bound on the speed of any node, m/s.

    Where forces F put energy in, d sqrt(2 E) / dt is at most |F| in the norm of 1 / m, and m v^2 of
    any node at most 2 E. Of a node that several processes share, the shares of F^2 / m add up to no
    less than the whole: (a + b)^2 / (m + n) <= a^2 / m + b^2 / n.
    """
    mass, loaded, fixed = model.rock.mass, model.ends.loaded, model.ends.fixed
    rock = mass > 0
    least = np.sqrt(team.largest(1 / mass[rock].min()))
    duration, stored, weight = time.dt * (time.steps + time.stride), 0.0, 0.0
    pushed = shaken = 0.0
    if loaded is not None:
        drive = team.sum((loaded.share**2 / mass[loaded.freedom]).sum())
        pushed = (model.dt * np.abs(loaded.pressure) * np.sqrt(drive)).sum()
    if fixed is not None and fixed.step is not None:
        speed = np.diff(fixed.step, prepend=0.0, append=0.0) / model.dt
        shaken = np.abs(speed).sum() * np.sqrt(team.sum(mass[rock].sum()))
    if model.weight is not None:
        weight = np.sqrt(team.sum((model.weight[rock] ** 2 / mass[rock]).sum()))
        stored = np.sqrt(2 * abs(team.sum(model.weight @ state.u)))
    with np.errstate(over="ignore"):
        pressed = _prestressed(scene, p) + duration * least * _pressing(scene, p)
        return least * speed_that(pushed, shaken, duration * weight, stored, pressed)


def _prestressed(scene: Scene, p: Properties) -> float:
    """Return the root of twice the energy that a prestress keeps in rock and joints, sqrt(J)."""
    if scene.prestress is None:
        return 0.0
    softness = p.block_count * p.spacing / p.modulus + np.abs(p.excess_compliance).sum()
    return abs(scene.prestress.normal) * np.sqrt(p.area * softness)


def _pressing(scene: Scene, p: Properties) -> float:
    """Return what prestressed rock can push with on the two sides of a joint that opens, N."""
    return 0.0 if scene.prestress is None else 2 * abs(scene.prestress.normal) * p.area
