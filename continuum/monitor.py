"""The monitor of a run, which stops it where speeds, energy or motion exceed their bounds."""

from __future__ import annotations

import numpy as np

from jointwave.cases.errors import StoppedError
from jointwave.cases.geometry.periodic import of_all
from jointwave.cases.scene_type import AnyScene
from jointwave.continuum.bounds import highest_speed
from jointwave.continuum.scene import SceneBody
from jointwave.continuum.scheme import Choice
from jointwave.continuum.space.evaluation import nodes_of_cells, places_of_nodes
from jointwave.continuum.stepping.implicit import Implicit
from jointwave.continuum.stepping.leapfrog import Leapfrog
from jointwave.numerics.divergence import ENERGY, SPEED, audit, guard
from jointwave.numerics.instability import Divergence, stopped
from jointwave.numerics.small_motion import (
    LARGEST,
    Moved,
    farthest,
    matters,
    may_overlap,
    overlapping,
    refuse_large_motion,
)


class Monitor:
    """Stops a run that exceeds its bounds.

    guard : `numerics.divergence.Guard`, which changes with the run.
    """

    def __init__(
        self,
        scene: AnyScene,
        found: SceneBody,
        steps: Leapfrog | Implicit,
        choice: Choice,
        critical: float,
        start: np.ndarray | None = None,
    ) -> None:
        """critical : step, s. start : displacements at the start, m; None where at rest."""
        self.scene, self.found, self.steps, self.time = scene, found, steps, choice.time
        self.explicit, self.critical = choice.scheme == "explicit", critical
        self.guard = guard(highest_speed(found, steps.problem, choice.time, start))

    def check(self, first: int, last: int) -> None:
        """Raise StoppedError where a run leaves its bounds in samples first .. last - 1."""
        steps, stride = self.steps, self.time.stride
        if self.scene.record.energy and self.explicit:  # the ledger of implicit steps is not exact
            audit(self.guard, steps.samples.energy, first, last, stride)
        speed = np.abs(steps.v)
        found, (limit,) = self.guard.found, self.guard.limit.view(np.float64)
        if found[0] < 0 and not speed.max(initial=0.0) <= limit:
            found[:] = last * stride, SPEED, first * stride - 1
        if found[0] >= 0:
            raise self._diverged(speed.reshape(-1, self.found.body.components).max(axis=1))
        if matters(self.scene):
            t = last * stride * self.time.dt
            refuse_large_motion(self.scene, "the continuum", self._moved(), t, first)

    def _diverged(self, speed: np.ndarray) -> StoppedError:
        """Return the error of a run with these speeds of its nodes, m/s."""
        step, what, sound = self.guard.found.tolist()
        place = self.found.body.x[int(np.nan_to_num(speed, nan=np.inf).argmax())]
        at = float(place[len(place) // 2]) if self.scene.is_column else tuple(place.tolist())
        key = f"numerics.continuum.{'step_fraction' if self.explicit else 'steps_per_period'}"
        seen = Divergence("the continuum", key, step, sound, what == ENERGY, at)
        critical = self.critical if self.explicit else np.inf
        return stopped(self.scene, self.time, critical, seen)

    def _moved(self) -> Moved | None:
        """Return the joint that has moved furthest over the size of its smaller block, or blocks
        that overlap without a contact; None without joints."""
        u = self.steps.u
        found = farthest_joint(self.found, u)
        if not self.scene.in_plane or (found is not None and found.by > LARGEST * found.size):
            return found
        if not may_overlap(self.found.blocks, u.reshape(-1, 2)):
            return found
        return overlapping(self.found.blocks, motion_of_blocks(self.found, u)) or found


def farthest_joint(found: SceneBody, u: np.ndarray) -> Moved | None:
    """Return where a joint has moved furthest over the size of its smaller block, under
    displacements u [freedoms] (m); along the axis of a pillar faces may part by any distance. None
    without such a joint."""
    body, scene, joints = found.body, found.scene, found.body.joints
    if joints is None or not joints.weight.size:
        return None
    jump = (joints.matrix @ u).reshape(-1, body.components)
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
    by = np.linalg.norm(jump, axis=1)
    k = farthest(by, size)
    i, j = pairs[k].tolist()
    return Moved(i, j, float(by[k]), float(size[k]), tuple(places[k].tolist()))


def motion_of_blocks(found: SceneBody, u: np.ndarray) -> np.ndarray:
    """Return displacement (m) and rotation of each block in the plane [n, 3], those of a rigid
    block that are nearest to the displacements u [freedoms] of its nodes."""
    body, count = found.body, found.blocks.count
    nodes, block = nodes_of_cells(body), found.body.block
    block = np.repeat(block, nodes.shape[1])
    arm = places_of_nodes(body).reshape(-1, 2) - found.blocks.centroid[block]
    moved = u.reshape(-1, 2)[nodes.ravel()]
    middle, mean = (_means(block, one, count) for one in (arm, moved))
    arm, moved = arm - middle[block], moved - mean[block]
    twist = arm[:, 0] * moved[:, 1] - arm[:, 1] * moved[:, 0]
    turn = np.bincount(block, twist, count) / np.bincount(block, (arm**2).sum(axis=1), count)
    return np.column_stack([mean + turn[:, None] * middle[:, ::-1] * [1, -1], turn])


def _means(group: np.ndarray, values: np.ndarray, count: int) -> np.ndarray:
    """Return the means of values [n, d] of each group [count, d]."""
    sums = [np.bincount(group, one, count) for one in values.T]
    return np.stack(sums, axis=1) / np.bincount(group, minlength=count)[:, None]
