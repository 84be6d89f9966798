"""Explicit steps of a problem: constants, state and forces for the kernel."""

from collections.abc import Iterator
from typing import Any, ClassVar

import numpy as np
from scipy.sparse import csr_matrix

from jointwave.continuum.space.evaluation import blocks_of_nodes
from jointwave.continuum.space.model import Body
from jointwave.continuum.stepping import arrays
from jointwave.continuum.stepping.explicit import leapfrog_for
from jointwave.continuum.stepping.memory import memory_of
from jointwave.continuum.stepping.problem import OF_POINTS, Problem, Readings
from jointwave.continuum.stepping.product import ROWS, Product, Table, product_of, table_of
from jointwave.continuum.stepping.tractions import history_at_rest
from jointwave.numerics.cache_lines import zeros
from jointwave.results.arrays import size_of

BUFFER = 500_000  # components of forces with a history in memory at a time


class Leapfrog:
    """Explicit steps of a problem.

    state : `arrays.State`, in the order of `product.place`. samples : recorded ones. dt : s.
    halo : places of other processes' freedoms, which follow in vectors.
    """

    work_of_a_step = 1
    attributes: ClassVar[dict[str, Any]] = {}  #: of a result

    def __init__(self, problem: Problem, dt: float, samples: int, energy: bool = True) -> None:
        self.problem, self.dt, body, parts = problem, dt, problem.body, problem.parts
        self.product, self._damping = products_for_steps(body)
        own, every = body.stiffness.shape
        self.halo = self.product.beyond(every - own, body.components)
        self.samples = arrays.samples_for(problem.readings, samples, energy)
        self.constants = c = self._constants()
        many, springs, damped = c.memory.share.size, c.quiet.stiffness, body.damping.nnz > 0
        jumps = len(c.jumps.first) * body.components
        self.flags = arrays.StepFlags(
            dim=body.components,
            product=self.product.kind,
            law=parts,
            stressed=c.points.carried.size > 0,
            damped=damped,
            relaxing=many > 0,
            ledger=energy,
            sprung=len(springs) > 0,
        )
        n = max(self.product.size, self.halo.max(initial=0) + 1)
        dashpots, limited = (parts.dashpots, parts.limited) if parts else (False, False)
        viscous, relaxing = n * (damped or dashpots), n * (many > 0)
        of_points = jumps, jumps * limited, jumps * dashpots, jumps, jumps * dashpots
        vectors = [zeros(size) for size in (n, viscous, viscous, relaxing, relaxing, *of_points)]
        self.work = arrays.Work(*vectors, np.zeros(c.quiet.freedom.shape))  # type: ignore[call-arg]
        history = np.zeros((0, 0))
        if parts is not None:
            history = history_at_rest(c.points, parts, body.components)
        memory = zeros((many, n)), history, np.zeros(4), np.zeros_like(springs)
        self.state = arrays.State(zeros(n), zeros(n), zeros(n), *memory)

    def take(self, first: int, last: int, stride: int) -> None:
        """Take the steps first .. last - 1, with a sample at each multiple of `stride`."""
        kernel = leapfrog_for(self.flags)
        for begin, drive, moved in self._driven(self.problem, first, last):
            span = begin, begin + len(moved), stride
            kernel(self.constants, self.state, self.work, self.samples, drive, moved, span)

    def _driven(
        self, problem: Problem, first: int, last: int
    ) -> Iterator[tuple[int, np.ndarray, np.ndarray]]:
        """Yield batches of steps: the first step, and the forces and prescribed moves of each."""
        forces, held = problem.forces, problem.held
        size = max(1, BUFFER // max(1, self.constants.driven.size))
        for begin in range(first, max(last, first + 1), size):
            end = min(begin + size, last)
            drive, moved = np.zeros((2, end - begin, 0))
            if forces is not None:
                drive = np.ascontiguousarray(forces.at(begin, end))
            if held.moved is not None:
                moved = np.ascontiguousarray(held.moved(np.arange(begin, end)))
            yield begin, drive, moved

    def whole(self, vector: np.ndarray) -> np.ndarray:
        """Return the values of the body's freedoms from a vector."""
        return vector[self.product.place]

    def place(self, values: np.ndarray, vector: np.ndarray) -> None:
        """Set a vector from the values of the body's freedoms."""
        vector[self.product.place] = values

    @property
    def u(self) -> np.ndarray:
        """Displacement of the body's freedoms, m."""
        return self.whole(self.state.u)

    @property
    def v(self) -> np.ndarray:
        """Velocity of the body's freedoms half a step before, m/s."""
        return self.whole(self.state.v)

    @property
    def last(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Displacement, m, and velocity, m/s, at the last step, and the displacement at which
        elastic rock would have the same stress, m."""
        u, v = self.u - self.dt * self.v, (self.whole(self.state.v_before) + self.v) / 2
        return u, v, self.whole(self.work.strained) if self.flags.relaxing else u

    @property
    def parts(self) -> tuple:
        """All arrays that change."""
        return (self.state,)

    @property
    def bytes(self) -> int:
        """Bytes of constants and state."""
        return size_of(self.constants, self.state, self.work)

    def start(self, u: np.ndarray, history: np.ndarray | None = None) -> None:
        """Start at rest at displacements u (m), with the history of points."""
        self.place(u, self.state.u)
        if self.flags.relaxing:
            stored = self.constants.memory.relaxed * (u @ (self.problem.body.stiffness @ u)) / 2
            self.state.sums[arrays.VISCOUS] = stored
        if history is not None:
            self.state.history[:] = history

    def drop(self, force: np.ndarray) -> None:
        """Set the velocities before t = 0 for rest at t = 0 under forces (N) that start then."""
        fall = 0.5 * self.dt * force / self.problem.body.mass
        fall[self.problem.held.freedom] = 0.0
        self.place(-fall, self.state.v)
        self.place(-3 * fall, self.state.v_before)

    def _constants(self) -> arrays.Constants:
        problem, place, dt = self.problem, self.product.place, self.dt
        body, held, forces = problem.body, problem.held, problem.forces
        braked = 1 + problem.alpha * dt / 2
        inverse = self._placed(dt / (body.mass * braked))
        return arrays.Constants(
            dt=dt,
            mass=self._placed(body.mass),
            inverse=inverse,
            keep=(1 - problem.alpha * dt / 2) / braked,
            alpha=problem.alpha,
            memory=memory_of(problem.mechanisms, dt),
            stiffness=self.product.table,
            damping=self._damping,
            jumps=self._jumps(),
            points=problem.points(),
            steady=np.zeros(0) if problem.steady is None else self._placed(problem.steady),
            driven=np.zeros(0, np.int64) if forces is None else place[forces.freedom],
            quiet=self._quiet(inverse),
            fixed=place[held.freedom],
            direction=held.direction,
            receivers=receivers(problem.readings, place),
        )

    def _placed(self, values: np.ndarray) -> np.ndarray:
        found = zeros(self.product.size)
        found[self.product.place] = values
        return found

    def _jumps(self) -> arrays.Jumps:
        joints, dim = self.problem.body.joints, self.problem.body.components
        first = np.append(self.product.place, self.halo)[dim * joints.node]
        return arrays.Jumps(first.astype(np.uint32), joints.frame)

    def _quiet(self, inverse: np.ndarray) -> arrays.Quiet:
        quiet, dim = self.problem.quiet, self.problem.body.components
        own, springs = quiet.freedom, 3 * (np.zeros((0, dim)),)
        if quiet.springs is not None:
            half = quiet.springs(self.dt)
            springs = half.stiffness, half.decay, half.gain
        moves = ~np.isin(own, self.problem.held.freedom)
        viscosity = quiet.viscosity * (moves[:, :, None] & moves[:, None, :])
        freedom = self.product.place[own]
        beta = inverse[freedom][:, :, None] * viscosity / 2
        return arrays.Quiet(freedom, viscosity, beta, np.linalg.inv(np.eye(dim) + beta), *springs)


def products_for_steps(body: Body) -> tuple[Product, Table]:
    """Return the product with the stiffness, and the damping (may be empty) for the same kind."""
    dim, of_nodes = body.components, (blocks_of_nodes(body), body.x)
    own = product_of(body.stiffness, dim, *of_nodes)
    if not body.damping.nnz:
        return own, Table(np.zeros(0, np.int64), np.zeros(0, np.uint32), np.zeros(0))
    other = product_of(body.damping, dim, *of_nodes)
    if other.kind == own.kind:  # then vectors have the same order
        return own, other.table
    n = body.stiffness.shape[0]
    rows = Product(ROWS, table_of(body.stiffness, dim), np.arange(n), n)
    return rows, table_of(body.damping, dim)


def receivers(readings: Readings, place: np.ndarray) -> Readings:
    """Return readings with a `Table` for each matrix, empty if absent."""
    found: dict[str, Any] = {}
    for name, value in readings._asdict().items():
        if not isinstance(value, np.ndarray):
            own = csr_matrix((0, 0)) if value is None else value
            column = own.indices if name in OF_POINTS else place[own.indices]
            found[name] = Table(own.indptr.astype(np.int64), column.astype(np.uint32), own.data)
    return readings._replace(**found)
