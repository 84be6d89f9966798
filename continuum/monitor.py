"""The monitor of a run: stops it if speeds, energy or motion exceed their bounds."""

import numpy as np

from jointwave.cases.geometry.periodic import of_all
from jointwave.cases.schema.pulse import shortest_period
from jointwave.continuum.plan import Plan
from jointwave.continuum.scene import SceneBody
from jointwave.continuum.space.evaluation import nodes_of_cells, places_of_nodes
from jointwave.continuum.stepping.implicit import Implicit
from jointwave.continuum.stepping.leapfrog import Leapfrog
from jointwave.numerics import small_motion
from jointwave.numerics.divergence import Guarded, check, guard, speed_that

IN_PERIOD = 50  # least number of samples of forces in the period of a pulse


class Monitor:
    """Stops a run that exceeds its bounds; guard : `numerics.divergence.Guard` of the run."""

    def __init__(
        self, plan: Plan, steps: Leapfrog | Implicit, start: np.ndarray | None = None
    ) -> None:
        """start : initial displacements [freedoms], m; None if zero."""
        self.found, _, choice, critical = plan
        self.scene, self.steps, self.time = plan.found.scene, steps, choice.time
        self.explicit = choice.scheme == "explicit"
        key = "numerics.continuum." + ("step_fraction" if self.explicit else "steps_per_period")
        critical = critical if self.explicit else np.inf
        self.run = Guarded(self.scene, "the continuum", key, self.time, critical)
        self.guard = guard(self._highest_speed(start))

    def check(self, first: int, last: int) -> None:
        """Raise StoppedError if a run leaves its bounds in samples first .. last - 1."""
        steps, body = self.steps, self.found.body
        exact = self.scene.record.energy and self.explicit  # implicit ledgers are not exact
        speed = np.abs(steps.v).reshape(-1, body.components).max(axis=1)
        energy = steps.samples.energy if exact else None
        check(self.guard, self.run, (first, last), energy, speed, body.x)
        t = last * self.time.stride * self.time.dt
        small_motion.refuse_large_motion(self.scene, self.run.engine, self._moved, t, first)

    def _moved(self) -> small_motion.Moved | None:
        """Return the joint with the largest motion over the size of its smaller block, or blocks
        that overlap without a contact; None without joints."""
        u = self.steps.u
        found = farthest_joint(self.found, u)
        if not self.scene.in_plane or (
            found is not None and found.by > small_motion.LARGEST * found.size
        ):
            return found
        if not small_motion.may_overlap(self.found.blocks, u.reshape(-1, 2)):
            return found
        return small_motion.overlapping(self.found.blocks, motion_of_blocks(self.found, u)) or found

    def _highest_speed(self, u: np.ndarray | None) -> float:
        """Return a bound on the speed of any node, m/s; u : initial displacements, m.

        d sqrt(2 E) / dt is at most |F| in the norm of 1 / m, and m v^2 of any node at most 2 E.
        """
        problem, time, mass = self.steps.problem, self.time, self.found.body.mass
        duration, pushed, shaken, weight, stored = time.dt * (time.steps + time.stride), *[0.0] * 4
        if problem.forces is not None:
            period, apart = shortest_period(self.scene.pulses), time.stride
            if period is not None:  # often enough for the shortest pulse
                apart = max(1, min(apart, int(period / (IN_PERIOD * time.dt))))
            pushed = problem.forces.impulse(mass, time.steps, apart)
        if problem.held.moved is not None:
            moved = problem.held.moved(np.arange(time.steps + 1)) / time.dt
            speed = np.diff(moved, axis=0, prepend=0.0, append=0.0)
            shaken = np.abs(speed).sum() * np.sqrt(mass.sum())
        if problem.steady is not None:
            weight = np.sqrt((problem.steady**2 / mass).sum())
            stored = 0.0 if u is None else np.sqrt(2 * abs(problem.steady @ u))
        least = np.sqrt((1 / mass).max())
        with np.errstate(over="ignore"):
            pressed = self._prestressed(duration * least)
            return float(least * speed_that(pushed, shaken, duration * weight, stored, pressed))

    def _prestressed(self, pushing: float) -> float:
        """Return the root of twice the energy (sqrt(J)) that a prestress stores in rock and joints,
        plus what prestressed rock can add by pushing on both sides of joints that open; pushing :
        duration over the root of the smallest mass, s/sqrt(kg)."""
        problem = self.steps.problem
        stress, joints, law = problem.stress, problem.body.joints, problem.law
        if stress is None:
            return 0.0
        softest = min(np.linalg.eigvalsh(one.stiffness).min() for one in self.found.materials)
        softest *= 1.0 if problem.mechanisms is None else problem.mechanisms.relaxed
        stored = float((stress**2).sum()) / softest * float(self.found.blocks.volume.sum())
        if law is None:
            return float(np.sqrt(stored))
        size, area = float(np.abs(stress).max()), float(joints.weight.sum())
        springs = [k for k in (law.normal_stiffness, law.shear_stiffness) if k is not None]
        stored += 4 * size**2 * area * max(np.max(1 / k) for k in springs)
        return float(np.sqrt(stored)) + pushing * 4 * size * area


def farthest_joint(found: SceneBody, u: np.ndarray) -> small_motion.Moved | None:
    """Return the joint with the largest motion over the size of its smaller block under
    displacements u [freedoms], m; of a pillar only slip counts. None without such a joint."""
    body, scene, joints = found.body, found.scene, found.body.joints
    if not joints.weight.size:
        return None
    jump = joints.jumps(u)
    if scene.is_column:
        if body.components == 1:
            return None
        pairs, jump = joints.column[:, None] + np.arange(2), jump[:, 1:]
        size = np.full(len(jump), scene.pillar.side)
        places = joints.place[:, [body.x.shape[1] // 2]]
    else:
        pairs = of_all(found.blocks, found.across, "blocks")[joints.column]
        size = found.blocks.volume[pairs].min(axis=1) ** (1 / body.components)
        places = joints.place
    return small_motion.farthest(pairs, np.linalg.norm(jump, axis=1), size, places)


def motion_of_blocks(found: SceneBody, u: np.ndarray) -> np.ndarray:
    """Return displacement (m) and rotation (rad) of each block in the plane [n, 3]: the rigid
    motion nearest to the displacements u [freedoms] of its nodes."""
    nodes, count = nodes_of_cells(found.body), found.blocks.count
    block = np.repeat(found.body.block, nodes.shape[1])

    def means(values: np.ndarray) -> np.ndarray:
        sums = [np.bincount(block, one, count) for one in values.T]
        return np.stack(sums, axis=1) / np.bincount(block, minlength=count)[:, None]

    arm = places_of_nodes(found.body).reshape(-1, 2) - found.blocks.centroid[block]
    moved = u.reshape(-1, 2)[nodes.ravel()]
    middle, mean = means(arm), means(moved)
    arm, moved = arm - middle[block], moved - mean[block]
    twist = arm[:, 0] * moved[:, 1] - arm[:, 1] * moved[:, 0]
    turn = np.bincount(block, twist, count) / np.bincount(block, (arm**2).sum(axis=1), count)
    return np.column_stack([mean + turn[:, None] * middle[:, ::-1] * [1, -1], turn])
