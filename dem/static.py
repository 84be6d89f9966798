"""Static states by dynamic relaxation: damped motion until equilibrium.

Mass-proportional damping alpha is critical for a mode omega at alpha = 2 omega. The mode that still
moves shows itself in the change of displacement du and of unbalanced force dF over a few steps,

    omega^2 = -du . dF / (du . M du),

Rayleigh's quotient, so the damping follows from fast modes to the slowest, which takes
some ln(1 / tolerance) / (omega dt) steps. Underwood, Dynamic relaxation, in: Computational Methods
for Transient Analysis (1983).
"""

from math import sqrt
from typing import Any, NamedTuple

import numpy as np

from jointwave.cases.errors import SceneError
from jointwave.cases.scene_type import AnyScene

STEPS_BETWEEN_LOOKS = 10
STEP_FRACTION = 0.9  # of the critical step: only the final state matters
NEVER = 1 << 60  # steps between samples where none are taken
UNBORNE = "what quiet boundaries bear of the weight is not found: fix the one below"
#: A stall is this part of the most steps without progress, and at least as many as led there: what
#: bears on ever fewer points comes to rest ever more slowly.
PATIENCE = 80
STEADY = 0.9  # of a way to that in the same time before: 1 at a constant speed, 3 from rest


class Rest(NamedTuple):
    """How a static state was reached: steps taken, largest unbalanced force over the scale; moving,
    the block that moves ever farther, None where none does."""

    steps: int
    ratio: float
    moving: str | None = None

    @property
    def attributes(self) -> dict[str, Any]:
        """Attributes of a result."""
        return {"static_steps": self.steps, "static_out_of_balance": self.ratio}


def settle(scene: AnyScene, system: Any, unborne: str = "") -> Rest:
    """Bring a scene's blocks to rest under gravity and prestress.

    unborne : what to do where sudden gravity does not come to rest on sides that bear it. Raises
    SceneError where there is no static state within numerics.dem.static_tolerance.
    """
    tolerance = scene.numerics.dem.static_tolerance
    rest = relax(system, tolerance, system.most_steps)
    if not rest.ratio <= tolerance:
        key, remedy = "gravity", unborne or "static = false starts without it"
        if not unborne and (scene.gravity is None or not scene.gravity.static):
            where = " around the openings" if scene.excavated else ""
            key, remedy = "prestress", f"the joints{where} cannot carry it"
        raise SceneError(scene.where, key, None, _why(rest, tolerance, remedy))
    return rest


def _why(rest: Rest, tolerance: float, remedy: str) -> str:
    """Return why there is no static state: a block that moves on is another thing than a residual
    that is still too large."""
    if rest.moving is None:
        return (
            f"has not come to rest: out-of-balance ratio {rest.ratio:.1e} after {rest.steps} steps,"
            f" above numerics.dem.static_tolerance = {tolerance:.1e}: raise it to accept this state"
        )
    return (
        f"no static state: {rest.moving} moves on after {rest.steps} steps of dynamic relaxation: "
        f"it slides, tips or is unsupported; {remedy}"
    )


def relax(system: Any, tolerance: float, most_steps: int) -> Rest:
    """Relax a system until its out-of-balance ratio is within the tolerance.

    It ends earlier after `most_steps`, or once the ratio no longer falls and the system moves: it
    goes farther in as many steps as led there than until then, or on the same way at no less speed.
    """
    steps, damped = 0, Damped(system)
    start, ratio = damped.u, _ratio(damped.force, system.scale)
    best, begin, moving = ratio, 0, None
    at_begin = at_half = start
    while tolerance < ratio and steps < most_steps and moving is None:
        before = damped.u
        damped.advance()
        steps += STEPS_BETWEEN_LOOKS
        ratio = _ratio(damped.force, system.scale)
        patience = max(most_steps / PATIENCE, begin)
        if steps - begin <= patience / 2:
            at_half = damped.u
        elif steps - begin > patience:
            first, second = at_half - at_begin, damped.u - at_half
            if _moves(first, second, at_begin - start, system.mass):
                moving = system.fastest(damped.u - before)
        if ratio < 0.9 * best or steps - begin > patience:
            best, begin, at_begin = min(best, ratio), steps, damped.u
    system.stop()
    return Rest(steps, ratio, None if ratio <= tolerance else moving)


def _moves(first: np.ndarray, second: np.ndarray, until: np.ndarray, mass: np.ndarray) -> bool:
    """Return whether two changes of displacement, in as many steps, are of one that moves, which
    had been displaced by `until`."""
    farther = mass @ (first + second) ** 2 > mass @ until**2
    return bool(farther or mass @ (first * (second - STEADY * first)) > 0)


class Damped:
    """Motion under damping that is critical for the mode that still moves: `system.alpha`, 1/s, at
    first that of the motion before.

    force : unbalanced, on every freedom, N and N m.
    """

    def __init__(self, system: Any) -> None:
        self.system = system
        self.u, self.force = system.displacement().copy(), system.unbalanced().copy()

    def advance(self) -> None:
        """Take `STEPS_BETWEEN_LOOKS` steps, and look."""
        self.system.advance(STEPS_BETWEEN_LOOKS, self.system.alpha)
        u, force = self.system.displacement().copy(), self.system.unbalanced().copy()
        self.system.alpha = 2 * _frequency(u - self.u, self.force - force, self.system.mass)
        self.u, self.force = u, force


def _frequency(change: np.ndarray, resistance: np.ndarray, mass: np.ndarray) -> float:
    """Return the frequency (rad/s) of the remaining motion; zero without stiffness."""
    inertia = float(change @ (mass * change))
    return sqrt(max(float(change @ resistance), 0.0) / inertia) if inertia > 0 else 0.0


def _ratio(force: np.ndarray, scale: float) -> float:
    largest = float(np.abs(force).max())
    return largest / scale if largest else 0.0
