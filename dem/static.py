"""Static states by dynamic relaxation, for any engine: damped motion until equilibrium.

Mass-proportional damping alpha is critical for a mode omega at alpha = 2 omega. The mode that still
moves shows itself in the change of displacement du and of unbalanced force dF over a few steps,

    omega^2 = -du . dF / (du . M du),

Rayleigh's quotient, so the damping follows from fast modes to the slowest, which takes
some ln(1 / tolerance) / (omega dt) steps. Underwood, Dynamic relaxation, in: Computational Methods
for Transient Analysis (1983).
"""

from dataclasses import replace
from math import sqrt
from typing import Any, NamedTuple, Protocol

import numpy as np

from jointwave.cases.errors import SceneError
from jointwave.cases.material.calibrate import Properties
from jointwave.cases.sampling import Interpolation
from jointwave.cases.scene_type import AnyScene
from jointwave.cases.schema.scene import Scene
from jointwave.joints.law import Law, parts_of
from jointwave.joints.law import stiffest as stiffest_springs
from jointwave.joints.normal import gap_under

STEPS_BETWEEN_LOOKS = 10
STEP_FRACTION = 0.9  # of the critical step: only the final state matters
NEVER = 1 << 60  # steps between samples where none are taken
UNBORNE = "what quiet boundaries bear of the weight is not found: fix the one below"
#: A stall is this part of the most steps without progress, and at least as many as led there: what
#: bears on ever fewer points comes to rest ever more slowly.
PATIENCE = 80
STEADY = 0.9  # of a way to that in the same time before: 1 at a constant speed, 3 from rest


class System(Protocol):
    """The system to be relaxed. Vectors have every freedom, displacements and rotations."""

    @property
    def mass(self) -> np.ndarray:
        """Masses and moments of inertia, kg and kg m2."""

    @property
    def scale(self) -> float:
        """The largest force at work, N: the weight of the pillar or what its prestress carries."""

    @property
    def most_steps(self) -> int:
        """The largest number of steps."""

    def advance(self, steps: int, alpha: float) -> None:
        """Take steps under mass-proportional damping alpha (1/s), a stable step long."""

    def unbalanced(self) -> np.ndarray:
        """Return the net force (N) and moment (N m) on every freedom."""

    def displacement(self) -> np.ndarray:
        """Return displacements (m) and rotations (rad)."""

    def stop(self) -> None:
        """Set all velocities to zero."""

    def fastest(self, change: np.ndarray) -> tuple[str, float]:
        """Return the block that moves farthest in a change of displacement, in words, and how
        fast it would be if that took one step, m/s."""


class Rest(NamedTuple):
    """How a static state was reached: steps taken, largest unbalanced force over the scale; moving,
    the block that moves ever farther and how fast, m/s, None where none does."""

    steps: int
    ratio: float
    moving: tuple[str, float] | None = None

    @property
    def attributes(self) -> dict[str, Any]:
        """Attributes of a result."""
        return {"static_steps": self.steps, "static_out_of_balance": self.ratio}


def fastest_of_row(p: Properties, change: np.ndarray, dt: float) -> tuple[str, float]:
    """Return the block of a pillar that moves farthest in a step dt (s), in words, and how fast
    (m/s); change : [directions, blocks], m."""
    moved = np.linalg.norm(change, axis=0)
    k = int(moved.argmax())
    y = (p.contact_y[k] + p.contact_y[k + 1]) / 2
    return f"the block at y = {y:.4g} m", float(moved[k]) / dt


def prestressed(scene: Scene, p: Properties) -> np.ndarray:
    """Return the displacement of every block under the prestress alone [N], m: where results count
    displacement from.

    A held end does not move (the far one if both are); between two free ends the displacement has
    zero mean.
    """
    start, end = held_ends(scene)
    normal = scene.prestress.normal if scene.prestress else 0.0
    u = np.append(0.0, np.cumsum(gaps_under(p, normal)))
    if end == "fixed":
        return u - u[-1] + normal / p.at_end.wall_stiffness
    half = normal / p.at_start.wall_stiffness
    return u - half if start == "fixed" else u - u.mean()


def held_ends(scene: Scene) -> tuple[str, str]:
    """Return how the ends are held while a static state is sought: fixed where they bear it."""
    kinds, weighed = (scene.ends.start, scene.ends.end), scene.gravity and scene.gravity.static
    start, end = (
        "fixed" if kind == "fixed" or (weighed and bears) else "free"
        for kind, bears in zip(kinds, scene.bears, strict=True)
    )
    return start, end


def gaps_under(p: Properties, stress: float | np.ndarray) -> np.ndarray:
    """Return the gaps of joints whose springs carry a normal stress (Pa), or each its own, m."""
    law = _springs(p)
    return gap_under(law, parts_of(law), stress)


def undamped(p: Properties) -> Properties:
    """Return the numbers of a scene without dashpots and damping."""
    return replace(
        p, time_constant=None, joint_time_constant=None, mass_damping=None, local_damping=None
    )


def stiffest(scene: Scene, p: Properties) -> Properties:
    """Return the numbers of a scene with its joints as stiff as they become within reach, dashpots
    as they are; p itself where none stiffens."""
    (stiffness, _), eta = stiffest_springs(_springs(p), scene), p.joint_time_constant
    if stiffness is p.stiffness:
        return p
    if eta is None:
        return replace(p, stiffness=stiffness)
    eta = eta * p.stiffness / stiffness
    return replace(p, stiffness=stiffness, joint_time_constant=eta, time_constant=float(eta.max()))


def _springs(p: Properties) -> Law:
    rock = p.rock_compliance
    return Law(p.stiffness, rock_compliance=rock, **p.strengths(shears=False))


def since_prestress(
    scene: Scene, p: Properties, displacement: np.ndarray, points: Interpolation
) -> np.ndarray:
    """Return displacements along y [points, n] (m) as results count them: from the prestressed
    state."""
    if scene.prestress is None:
        return displacement
    u = prestressed(scene, p)
    at_rest = (1 - points.weight) * u[points.left] + points.weight * u[points.right]
    return displacement - at_rest[:, None]


def settle(scene: AnyScene, system: System, unborne: str = "") -> Rest:
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
    block, speed = rest.moving
    return (
        f"no static state: {block} moves on, at {speed:.2g} m/s after {rest.steps} steps of "
        f"dynamic relaxation: it slides, tips or is unsupported; {remedy}"
    )


def relax(system: System, tolerance: float, most_steps: int) -> Rest:
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
                moving = system.fastest((damped.u - before) / STEPS_BETWEEN_LOOKS)
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
    """Motion under damping that is critical for the mode that still moves.

    force : unbalanced, on every freedom, N and N m.
    """

    def __init__(self, system: System) -> None:
        self.system, self.alpha = system, 0.0
        self.u, self.force = system.displacement().copy(), system.unbalanced().copy()

    def advance(self) -> None:
        """Take `STEPS_BETWEEN_LOOKS` steps, and look."""
        self.system.advance(STEPS_BETWEEN_LOOKS, self.alpha)
        u, force = self.system.displacement().copy(), self.system.unbalanced().copy()
        self.alpha = 2 * _frequency(u - self.u, self.force - force, self.system.mass)
        self.u, self.force = u, force


def _frequency(change: np.ndarray, resistance: np.ndarray, mass: np.ndarray) -> float:
    """Return the frequency (rad/s) of the remaining motion; zero without stiffness."""
    inertia = float(change @ (mass * change))
    return sqrt(max(float(change @ resistance), 0.0) / inertia) if inertia > 0 else 0.0


def _ratio(force: np.ndarray, scale: float) -> float:
    largest = float(np.abs(force).max())
    return largest / scale if largest else 0.0
