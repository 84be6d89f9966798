"""The homogenised bar stepped with plain dolfinx, in the manner of its tutorial.

Leapfrog with a lumped mass in plain Python; in every step dolfinx assembles the form

    f(w) = -int E (u + eta v)' w' dy,   v in the middle of the step before (Kelvin-Voigt)

so that the critical step is (2/omega) (sqrt(1 + xi^2) - xi), xi = eta omega / 2 (Belytschko, Liu &
Moran, Nonlinear Finite Elements for Continua and Structures, 2000, section 6.2). Elements and the
fraction of that step are the scene's `numerics.continuum`. All is per area of the section.
"""

from math import sqrt
from time import perf_counter
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from jointwave.cases.material.calibrate import calibrate
from jointwave.cases.sampling import Clock, clock
from jointwave.cases.schema.scene import Scene
from jointwave.compare.exact.bar import equivalent_bar
from jointwave.compare.exact.conditions import drive, joints_are_damped
from jointwave.compare.solvers.continuum import EQUIVALENT_ROCK
from jointwave.compare.solvers.record import YES, Answer, no
from jointwave.results.dataset import dataset

NAME = "plain-dolfinx"
ENGINE = EQUIVALENT_ROCK.name
ARGUMENTS: tuple[str, ...] = ()


class PlainBar(NamedTuple):
    """The bar in space.

    space, form : of dolfinx; the form assembles the internal force of `motion`, u + eta v.
    mass, dashpot : float arrays [freedoms], kg/m2 and Pa s/m. start, end : freedoms of the ends.
    held : fixed freedoms. eta : s. critical : s.
    """

    space: Any
    form: Any
    motion: Any
    mass: np.ndarray
    dashpot: np.ndarray
    start: int
    held: list[int]
    eta: float
    critical: float


def applies(scene: Scene) -> Answer:
    """Return whether the scene is a plain homogenised bar, stepped explicitly."""
    if not (answer := equivalent_bar.applies(scene)):
        return answer
    p, numerics = calibrate(scene), scene.numerics.continuum
    if p.excess_compliance.any():
        return no("a soft layer cuts the bar")
    if joints_are_damped(p) and not p.time_constant:
        return no("a joint has its own dashpot")
    if numerics.dim not in (None, 1) or numerics.mesh is not None:
        return no("it solves a bar on its own mesh")
    if numerics.scheme == "implicit" or numerics.mass == "consistent":
        return no("its steps are explicit")
    try:
        import dolfinx  # noqa: F401
    except ImportError as error:
        return no(f"dolfinx cannot be imported ({error})")
    return YES


def solve(scene: Scene) -> xr.Dataset:
    """Return stress, velocity and displacement of the scene's homogenised bar."""
    from jointwave.continuum.space.dolfinx_export import quiet_logging

    began = perf_counter()
    with quiet_logging():
        bar = _bar(scene)
    numerics = scene.numerics.continuum
    time = clock(scene, bar.critical, numerics.step_fraction, numerics.allow_unstable, "continuum")
    record = scene.record
    slopes = np.array([_row(bar, y, 1) for y in record.stress]).reshape(-1, len(bar.mass))
    values = np.array([_row(bar, y, 0) for y in record.velocity]).reshape(-1, len(bar.mass))
    ready = perf_counter()
    u, v = _march(scene, bar, time)
    done = perf_counter()
    stress = -calibrate(scene).modulus * slopes @ (u + bar.eta * v).T
    return dataset(
        scene,
        NAME,
        time.times,
        stress,
        values @ v.T,
        values @ u.T,
        dt=time.dt,
        critical_dt=bar.critical,
        steps=time.steps,
        degrees_of_freedom=len(bar.mass),
        bytes=bar.mass.nbytes * 5,
        seconds_setup=ready - began,
        seconds_stepping=done - ready,
    )


def _march(scene: Scene, bar: PlainBar, time: Clock) -> tuple[np.ndarray, np.ndarray]:
    """Return displacements and velocities [samples, freedoms] at the sample times."""
    from dolfinx import fem

    dt, gain = time.dt, scene.load.direction[1]
    load = gain * drive(scene).value(dt * np.arange(time.steps + 1))
    u, v, force = np.zeros((3, len(bar.mass)))
    below, above = bar.mass - dt / 2 * bar.dashpot, bar.mass + dt / 2 * bar.dashpot
    sampled = np.zeros((2, time.samples, len(bar.mass)))
    for n in range(time.steps + 1):
        bar.motion.x.array[:] = u + bar.eta * v
        force[:] = 0.0
        fem.assemble_vector(force, bar.form)
        force[bar.start] += load[n]
        before, v = v, (below * v + dt * force) / above
        v[bar.held] = 0.0
        if n % time.stride == 0:
            sampled[:, n // time.stride] = u, (before + v) / 2
        u += dt * v
    return sampled[0], sampled[1]


def _bar(scene: Scene) -> PlainBar:
    import ufl
    from dolfinx import fem

    from jointwave.continuum.build import elements_for
    from jointwave.continuum.space import dolfinx_export

    p, order = calibrate(scene), scene.numerics.continuum.order
    per_block = scene.numerics.continuum.elements_per_block
    count = p.block_count * (per_block or elements_for(scene, p, str(EQUIVALENT_ROCK.model)))
    y = np.linspace(0.0, scene.pillar.length, count + 1)[:, None]
    cells = np.arange(count)[:, None] + np.arange(2)
    space = dolfinx_export.lagrange_space(dolfinx_export.cell_mesh("interval", cells, y), order)
    w, motion = ufl.TestFunction(space), fem.Function(space, dtype=np.float64)
    stiffness = p.modulus * ufl.inner(ufl.grad(ufl.TrialFunction(space)), ufl.grad(w)) * ufl.dx
    rule = {"quadrature_rule": "GLL", "quadrature_degree": max(2 * order - 1, 1)}
    mass = dolfinx_export.vector(p.density * w * ufl.dx(metadata=rule))
    form = fem.form(-ufl.action(stiffness, motion), dtype=np.float64)
    at = space.tabulate_dof_coordinates()[:, 0]
    places = (scene.ends.start, int(at.argmin())), (scene.ends.end, int(at.argmax()))
    dashpot = np.zeros_like(mass)
    for kind, freedom in places:
        dashpot[freedom] = p.impedance if kind in ("quiet", "matched") else 0.0
    held = [freedom for kind, freedom in places if kind == "fixed"]
    eta = p.time_constant or 0.0
    critical = _critical(dolfinx_export.matrix(stiffness), mass, eta)
    return PlainBar(space, form, motion, mass, dashpot, int(at.argmin()), held, eta, critical)


def _critical(stiffness, mass: np.ndarray, eta: float) -> float:
    """Return the critical step of leapfrog with dashpots that lag by half a step, s."""
    from scipy.sparse import diags
    from scipy.sparse.linalg import eigsh

    scale = diags(1 / np.sqrt(mass))
    first = np.random.default_rng(0).standard_normal(len(mass))  # the same in every run
    (square,) = eigsh(scale @ stiffness @ scale, 1, v0=first, return_eigenvectors=False)
    omega = sqrt(square)
    xi = eta * omega / 2
    return 2 / omega * (sqrt(1 + xi**2) - xi)


def _row(bar: PlainBar, y: float, derivative: int) -> np.ndarray:
    from jointwave.continuum.space import basix_versions, dolfinx_export

    nodes = dolfinx_export.cell_nodes(bar.space)
    at = bar.space.tabulate_dof_coordinates()[:, 0][nodes]
    low, length = at.min(axis=1), np.ptp(at, axis=1)
    local = (y - low) / length
    cells = np.flatnonzero(np.abs(local - 0.5) <= 0.5 + 1e-9)
    order, row = nodes.shape[1] - 1, np.zeros(len(bar.mass))
    for cell in cells:
        # The reference cell's first corner is the lower one: cells are given so.
        found = basix_versions.tabulate("interval", order, np.array([[local[cell]]]))
        weight = found[1][0, :, 0] / length[cell] if derivative else found[0][0]
        row[nodes[cell]] += weight / cells.size
    return row
