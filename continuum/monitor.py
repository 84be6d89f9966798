"""The divergence monitor: how fast rock can become at most, and whether a run exceeds that.

No node can be faster than all forces together can make it, and no energy come from nowhere."""

import numpy as np

from jointwave.continuum.plane.discrete import blocks_of, motion_of_blocks, prestressed
from jointwave.continuum.run import Run
from jointwave.numerics.divergence import ENERGY, EVERY, audit, guard, look, speed_that
from jointwave.numerics.instability import Divergence, stopped
from jointwave.numerics.small_motion import (
    LARGEST,
    Moved,
    farthest,
    matters,
    overlapping,
    refuse_large_motion,
)


class Monitor:
    """Stops a run that exceeds its bounds; the kernel of leapfrog checks speeds by itself.

    Attributes
    ----------
    guard : `numerics.divergence.Guard`. energy : the whole ledger [term, sample], J; None when not
    kept.
    parts : arrays that change with the run.
    """

    def __init__(self, run: Run) -> None:
        self.run, self.time, self.communicator = run, run.choice.time, run.communicator
        self.explicit, energy = run.choice.scheme == "explicit", run.samples.energy
        self.guard, self.energy = guard(highest_speed(run)), energy
        self.parts: tuple = (self.guard,)
        if energy is not None and self.communicator.size > 1:
            self.energy = np.zeros_like(energy)
            self.parts = self.guard, self.energy

    def look(self, n: int) -> bool:
        """Check the speeds after n steps, and return whether the run diverges."""
        look(self.guard, np.abs(self.run.state.v).max(initial=0.0), n)
        return self.communicator.any(bool(self.guard.found[0] >= 0))

    def finds(self, n: int) -> bool:
        """Check implicit steps periodically, after step n, and return whether the run diverges.

        Their ledger is not exact, so that its imbalance is not an error.
        """
        return self.look(n) if n % EVERY == 0 else False

    def audit(self, first: int, last: int) -> None:
        """Look for energy from nowhere in samples first .. last - 1 of the ledger."""
        if self.energy is None or first == last:
            return
        if self.energy is not self.run.samples.energy:
            own = self.run.samples.energy[:, first:last]
            self.energy[:, first:last] = self.communicator.sum(own)
        audit(self.guard, self.energy, first, last, self.time.stride)

    def check(self, first: int, last: int) -> None:
        """Raise StoppedError where the run is lost when samples first .. last - 1 are taken, with
        what all processes saw."""
        n = (last - 1) * self.time.stride + 1
        if self.explicit:
            self.audit(first, last)
        if not self.look(n):
            self.check_small_motion(first, n)
            return
        step, what, sound = self.guard.found.tolist() if self.guard.found[0] >= 0 else (n, 0, n)
        key = "step_fraction" if self.explicit else "steps_per_period"
        seen = Divergence(
            "the continuum",
            f"numerics.continuum.{key}",
            int(-self.communicator.largest(-step)),
            int(-self.communicator.largest(-sound)),
            bool(self.communicator.any(what == ENERGY)),
            self.fastest(),
        )
        critical = self.run.critical if self.explicit else np.inf
        raise stopped(self.run.scene, self.time, critical, seen)

    def check_small_motion(self, first: int, n: int) -> None:
        """Raise StoppedError where blocks have moved further than small motion allows at step n,
        and samples up to `first` were taken at the look before."""
        run = self.run
        if not matters(run.scene):
            return
        found = farthest_joint(run)
        share = -1.0 if found is None else found.by / found.size
        found = self.communicator.of_largest(share, found)
        beyond = found is not None and found.by > LARGEST * found.size
        if run.scene.kind == "rock mass" and not beyond:
            moved = motion_of_blocks(run.discrete, run.state.u)
            found = overlapping(run.discrete.partition, moved) or found
        refuse_large_motion(run.scene, "the continuum", found, n * self.time.dt, first)

    def fastest(self) -> float:
        """Return where along the pillar (m) the fastest node is."""
        body = self.run.discrete.body
        freedoms = body.freedom(np.arange(len(body.x))[:, None], np.arange(body.section.components))
        speed = np.nan_to_num(np.abs(self.run.state.v[freedoms]).max(axis=1), nan=np.inf)
        node = int(speed.argmax())
        return self.communicator.of_largest(float(speed[node]), float(body.y[node]))


def farthest_joint(run: Run) -> Moved | None:
    """Return where a joint of this process has moved furthest over the size of its smaller block;
    along the axis of a pillar faces may part by any distance. None without such a joint."""
    across, jump = run.discrete.jumps, run.state.jump
    if across is None or not across.joint.size:
        return None
    if run.scene.kind == "rock mass":
        pairs = blocks_of(run.discrete)[across.joint]
        by = np.linalg.norm(jump, axis=0)
        size = np.sqrt(run.discrete.partition.area[pairs].min(axis=1))
    elif run.discrete.body.section.components == 1:
        return None
    else:
        pairs = across.joint[:, None] + np.arange(2)
        by = np.linalg.norm(jump[1:], axis=0)
        size = np.full(by.size, run.discrete.properties.side)
    k = farthest(by, size)
    i, j = pairs[k].tolist()
    x = across.x[k] if run.scene.kind == "rock mass" else across.x[k, 1:2]
    return Moved(i, j, float(by[k]), float(size[k]), tuple(x.tolist()))


def highest_speed(run: Run) -> float:
    """Return a bound on the speed of any node, m/s.

    Where forces F put energy in, d sqrt(2 E) / dt is at most |F| in the norm of 1 / m, and m v^2 of
    any node at most 2 E. Of a node that several processes share, the shares of F^2 / m add up to no
    less than the whole: (a + b)^2 / (m + n) <= a^2 / m + b^2 / n.
    """
    model, time, communicator = run.model, run.choice.time, run.communicator
    mass, loaded, fixed = model.rock.mass, model.ends.loaded, model.ends.fixed
    rock = mass > 0
    least = np.sqrt(communicator.largest(1 / mass[rock].min()))
    duration, stored, weight = time.dt * (time.steps + time.stride), 0.0, 0.0
    pushed = shaken = 0.0
    if loaded is not None:
        drive = communicator.sum((loaded.share**2 / mass[loaded.freedom]).sum())
        pushed = (model.dt * np.abs(loaded.pressure) * np.sqrt(drive)).sum()
    if model.ends.driven is not None:
        pushed += model.ends.driven.impulse(mass, time.steps)
    if fixed is not None and fixed.step is not None:
        speed = np.diff(fixed.step, prepend=0.0, append=0.0) / model.dt
        shaken = np.abs(speed).sum() * np.sqrt(communicator.sum(mass[rock].sum()))
    if model.weight is not None:
        weight = np.sqrt(communicator.sum((model.weight[rock] ** 2 / mass[rock]).sum()))
        stored = np.sqrt(2 * abs(communicator.sum(model.weight @ run.state.u)))
    with np.errstate(over="ignore"):
        pressed = _prestressed(run, duration * least)
        return least * speed_that(pushed, shaken, duration * weight, stored, pressed)


def _prestressed(run: Run, pushing: float) -> float:
    """Return the root of twice the energy (sqrt(J)) that a prestress keeps in rock and joints, and
    that rock gives off by pushing on both sides of a joint that opens, so long (s/sqrt(kg))."""
    if run.scene.prestress is None:
        return 0.0
    memory = run.model.rock.memory
    relaxed = 1.0 if memory is None else memory.relaxed
    if run.scene.kind == "rock mass":
        return prestressed(run.scene, run.discrete, pushing, relaxed)
    p, prestress = run.discrete.properties, abs(run.scene.prestress.normal)
    softness = p.block_count * p.spacing / p.modulus / relaxed + np.abs(p.excess_compliance).sum()
    return prestress * np.sqrt(p.area * softness) + pushing * 2 * prestress * p.area
