"""Jointed rock stepped as in a dolfinx tutorial, with the internal force assembled in every step.

Body, UFL form, joints and loads are the engine's. The force is assembled from a form compiled with
-O2, or is the product of a scipy matrix; numpy moves the nodes.
"""

import inspect
from collections.abc import Callable

import numpy as np
import ufl
from dolfinx import fem

from jointwave.continuum.plan import Plan
from jointwave.continuum.space.build import by_rule, rock_rule
from jointwave.continuum.space.compiling import compiled
from jointwave.continuum.space.rock import rock_of_cells
from jointwave.continuum.stepping.problem import Problem


class Steps:
    """Leapfrog in numpy, for any function that computes the rock's internal force.

    Attributes
    ----------
    u, v : of all freedoms, m and m/s.
    """

    def __init__(
        self,
        problem: Problem,
        dt: float,
        internal: Callable[[np.ndarray], None],
        u: np.ndarray | None = None,
    ) -> None:
        """`internal(force)` sets the force (N) on every freedom at the displacements u (m)."""
        assert problem.law is not None and problem.forces is not None
        self.problem, self.dt, self.internal, self.n = problem, dt, internal, 0
        self.u = np.zeros(problem.body.stiffness.shape[0]) if u is None else u
        self.v, self.force = np.zeros((2, self.u.size))
        law = problem.law
        self.springs = problem.of_joints(law.normal_stiffness, law.shear_stiffness)
        self.step_over_mass = dt / problem.body.mass

    def march(self, count: int) -> None:
        """Take some steps."""
        forces, u, v, force = self.problem.forces, self.u, self.v, self.force
        assert forces is not None
        for drive in forces.at(self.n, self.n + count):
            self.internal(force)
            force -= self.springs @ u
            force[forces.freedom] += drive
            force *= self.step_over_mass
            v += force
            np.multiply(v, self.dt, out=force)
            u += force
        self.n += count


def assembled(plan: Plan, problem: Problem) -> Steps:
    """Return the steps with an assembled internal force."""
    found, space = plan.found, problem.body.space
    u = fem.Function(space, dtype=np.float64)
    region = found.blocks.body.region[problem.body.block]
    form = rock_of_cells(space, found.materials, region).stiffness
    rule = rock_rule(problem.body.cell.kind, found.scene.numerics.continuum.order)
    made = plainly(by_rule(ufl.action(-form, u), rule))

    def internal(force: np.ndarray) -> None:
        force[:] = 0.0
        fem.assemble_vector(force, made)

    return Steps(problem, plan.choice.time.dt, internal, u.x.array)


def multiplied(plan: Plan, problem: Problem) -> Steps:
    """Return the steps with the internal force from scipy's matrix."""
    matrix, u = -problem.body.stiffness, np.zeros(problem.body.stiffness.shape[0])

    def internal(force: np.ndarray) -> None:
        force[:] = matrix @ u

    return Steps(problem, plan.choice.time.dt, internal, u)


def plainly(form: ufl.Form):
    """Return a form compiled with -O2 only."""
    key = "jit_params" if "jit_params" in inspect.signature(fem.form).parameters else "jit_options"
    options = {"cffi_extra_compile_args": ["-O2"]}
    return compiled(lambda: fem.form(form, dtype=np.float64, **{key: options}))
