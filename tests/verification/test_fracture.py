"""One joint pulled apart: what it takes is the fracture energy."""

import numpy as np
import pytest

from jointwave.continuum.plan import plan_of
from jointwave.continuum.receivers.sections import extent_of
from jointwave.continuum.space.evaluation import blocks_of_nodes
from jointwave.continuum.stepping.leapfrog import Leapfrog
from jointwave.continuum.stepping.problem import Held
from jointwave.results.rock_mass import TERMS

STRENGTH, ENERGY, AREA = 5e5, 30.0, 0.25
CRITICAL = 2 * ENERGY / STRENGTH


@pytest.fixture
def joint(pillar):
    """Return a function of the dimension that gives two blocks with the joint between them: the
    scene, and what its steps are made of."""
    scene = pillar(
        pillar__length=1.0,
        joints={"tensile_strength": STRENGTH, "fracture_energy": ENERGY},
        load={"shape": "step", "amplitude": 0.0},
        record={"stress": [], "velocity": [0.0], "interval": 1e-3},
    )
    return lambda dim: (scene, plan_of(scene, "jointed", dim=dim))


def pulled(scene, problem, nodes, way, step, dt):
    """Return every term of the ledger (J) at the last step: nodes [k] move along the pillar by way
    [k] times step [n] (m) from n to n + 1, and not across it."""
    size = problem.body.components
    freedom = (size * nodes[:, None] + np.arange(size)).ravel()
    given = np.outer(way, np.arange(size) == min(1, size - 1)).ravel()
    steps = Leapfrog(problem._replace(held=Held(freedom, given, step.__getitem__)), dt, 2)
    steps.take(0, step.size, step.size - 1)
    energy = extent_of(scene, problem.body) * steps.samples.energy[:, 1]
    return dict(zip(TERMS, energy, strict=True))


@pytest.mark.parametrize("dim", [1, 3])
def test_rigid_blocks_take_the_fracture_energy(joint, dim):
    """Work and fracture energy are G_c A to round-off.

    The trapezoid rule of the ledger is exact for tractions that are linear between steps, and the
    openings at which the law has its kinks are openings at a step. Round-off is that of K u, which
    for rigid blocks is a sum of large terms that cancel: on the way u, at most eps |K| u u.
    """
    scene, (_, problem, _, _) = joint(dim)
    body, first = problem.body, STRENGTH / problem.law.normal_stiffness
    openings = np.concatenate([np.linspace(0, first, 11), np.linspace(first, CRITICAL, 31)[1:]])
    step = np.concatenate([np.diff(openings), np.full(5, CRITICAL / 10), np.zeros(3)])
    above = blocks_of_nodes(body) == 1
    ledger = pulled(scene, problem, np.arange(len(body.x)), above.astype(float), step, 1e-3)
    round_off = np.finfo(float).eps * np.abs(body.stiffness).sum() * step.sum() ** 2
    assert round_off < 1e-9 * ENERGY * AREA
    assert ledger["work"] == pytest.approx(ENERGY * AREA, rel=1e-12, abs=round_off)
    assert ledger["fracture"] == pytest.approx(ENERGY * AREA, rel=1e-12)


def test_a_slow_pull_of_deformable_blocks_takes_the_fracture_energy(joint):
    """Work at the ends is G_c A within 1e-6: the kinetic energy of all the rock at the speed of the
    pull, 1e-4 m/s, is 4e-7 of it, and the blocks are stiffer than the softening joint is steep."""
    scene, (_, problem, _, critical) = joint(1)
    dt, sides = 0.5 * critical, problem.body.sides
    ends = np.concatenate([sides[end].node for end in ("start", "end")])
    step = np.full(int(1.2 * CRITICAL / (1e-4 * dt)), 1e-4 * dt)
    ledger = pulled(scene, problem, ends, np.array([0.0, 1.0]), step, dt)
    assert ledger["fracture"] == pytest.approx(ENERGY * AREA, rel=1e-12)
    assert ledger["work"] == pytest.approx(ENERGY * AREA, rel=1e-6)
