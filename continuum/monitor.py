"""What holds a run in rock to its bounds, for all processes that share it."""

import numpy as np

from cases.runaway import Sighting, stopped
from cases.scene import Scene
from continuum.bound import highest_speed
from continuum.build import Discrete
from continuum.model import Model, Samples, State
from continuum.scheme import Choice
from continuum.space.body import axis
from joints.guard import ENERGY, EVERY, audit, guard, look


class Watch:
    """Looks at a run: kernels that run alone look by themselves at `guard`, and stop.

    Attributes
    ----------
    guard : `joints.guard.Guard`. energy : the whole ledger [term, sample], J; None when not kept.
    parts : arrays that change with the run. time : its clock.
    """

    def __init__(
        self,
        scene: Scene,
        discrete: Discrete,
        model: Model,
        state: State,
        samples: Samples,
        choice: Choice,
        critical: float,
    ) -> None:
        self.scene, self.discrete, self.state = scene, discrete, state
        self.team, self.time = discrete.body.team, choice.time
        self.explicit, self.critical = choice.scheme == "explicit", critical
        self.samples = samples
        speed = highest_speed(scene, discrete.properties, model, state, self.time, self.team)
        self.guard = guard(speed)
        self.energy = samples.energy
        self.parts: tuple = (self.guard,)
        if samples.energy is not None and self.team.size > 1:
            self.energy = np.zeros_like(samples.energy)
            self.parts = self.guard, self.energy

    def look(self, n: int) -> bool:
        """Look at the speeds after n steps, and return whether the run is lost."""
        look(self.guard, np.abs(self.state.v).max(initial=0.0), n)
        return self.team.any(bool(self.guard.found[0] >= 0))

    def finds(self, n: int) -> bool:
        """Look now and then at implicit steps, after step n, and return whether the run is lost.

        Their ledger is not exact, and what it is out by is no fault.
        """
        return self.look(n) if n % EVERY == 0 else False

    def audit(self, first: int, last: int) -> None:
        """Look at the ledger in samples first .. last - 1."""
        if self.energy is None:
            return
        if self.energy is not self.samples.energy:
            self.energy[:, first:last] = self.team.sum(self.samples.energy[:, first:last])
        audit(self.guard, self.energy, first, last, self.time.stride)

    def check(self, first: int, last: int) -> None:
        """Raise StoppedError where the run is lost when samples first .. last - 1 are taken, with
        what all processes saw."""
        n = (last - 1) * self.time.stride + 1
        if self.explicit and self.team.size > 1:
            self.audit(first, last)
        if not self.look(n):
            return
        step, what, sound = self.guard.found.tolist() if self.guard.found[0] >= 0 else (n, 0, n)
        key = "step_fraction" if self.explicit else "steps_per_period"
        seen = Sighting(
            "the continuum",
            f"numerics.continuum.{key}",
            int(-self.team.largest(-step)),
            int(-self.team.largest(-sound)),
            bool(self.team.any(what == ENERGY)),
            self.fastest(),
        )
        raise stopped(self.scene, self.time, self.critical if self.explicit else np.inf, seen)

    def fastest(self) -> float:
        """Return where along the pillar (m) the fastest node is."""
        body = self.discrete.body
        freedoms = body.freedom(np.arange(len(body.x))[:, None], np.arange(body.section.components))
        speed = np.nan_to_num(np.abs(self.state.v[freedoms]).max(axis=1), nan=np.inf)
        node = int(speed.argmax())
        return self.team.of_largest(float(speed[node]), float(body.x[node, axis(body.x.shape[1])]))
