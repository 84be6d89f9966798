"""One joint pulled apart: what it takes is the fracture energy."""

import numpy as np
import pytest

from jointwave.cases.sampling import Clock
from jointwave.continuum.build import build_model, critical_step_of, discretise
from jointwave.continuum.explicit.march import run
from jointwave.continuum.model import Fixed
from jointwave.continuum.space.body import rock_matrices
from jointwave.continuum.state import TERMS, empty_samples, state_at_rest

STRENGTH, ENERGY, AREA = 5e5, 30.0, 0.25
CRITICAL = 2 * ENERGY / STRENGTH


@pytest.fixture
def joint(pillar):
    """Return a function of the dimension that gives two blocks with the joint between them: the
    scene, and in space."""
    scene = pillar(
        pillar__length=1.0,
        joints={"tensile_strength": STRENGTH, "fracture_energy": ENERGY},
        load={"shape": "step", "amplitude": 0.0},
        record={"stress": [], "velocity": [0.0], "interval": 1e-3},
    )
    return lambda dim: (scene, discretise(scene, "jointed", dim))


def pulled(scene, discrete, freedom, way, step, dt):
    """Return every term of the ledger (J) at the last step: freedom [k] moves by way [k] times step
    [n] (m) from n to n + 1."""
    model = build_model(scene, discrete, "jointed", Clock(dt, step.size, 2))
    fixed = Fixed(freedom, way, step)
    model = model._replace(ends=model.ends._replace(fixed=fixed))
    state = state_at_rest(model, keep_ledger=True)
    samples = empty_samples(model, state, 2)
    run(model, state, samples, step.size - 1, 0, step.size)
    return dict(zip(TERMS, samples.energy[:, 1], strict=True))


def freedoms(body, nodes):
    """Return all freedoms of some nodes, and 1 for those along y, 0 for the others."""
    components = body.section.components
    freedom = np.concatenate([body.freedom(nodes, c) for c in range(components)])
    along = np.arange(components) == min(1, components - 1)
    return freedom, np.repeat(along, nodes.size).astype(float)


@pytest.mark.parametrize("dim", [1, 3])
def test_rigid_blocks_take_the_fracture_energy(joint, dim):
    """Work and fracture energy are G_c A to round-off.

    The trapezoid rule of the ledger is exact for tractions that are linear between steps, and the
    openings at which the law has its kinks are openings at a step. Round-off is that of K u, which
    for rigid blocks is a sum of large terms that cancel: on the way u, at most eps |K| u u.
    """
    scene, discrete = joint(dim)
    body, law = discrete.body, discrete.joints.law
    first = STRENGTH / law.normal_stiffness
    openings = np.concatenate([np.linspace(0, first, 11), np.linspace(first, CRITICAL, 31)[1:]])
    step = np.concatenate([np.diff(openings), np.full(5, CRITICAL / 10), np.zeros(3)])
    above = body.corners[:, :, min(1, dim - 1)].mean(axis=1) > 0.5
    still, _ = freedoms(body, np.unique(body.cells[~above]))
    moving, way = freedoms(body, np.unique(body.cells[above]))
    all_, way = np.concatenate([still, moving]), np.concatenate([np.zeros(still.size), way])
    ledger = pulled(scene, discrete, all_, way, step, 1e-3)
    round_off = np.finfo(float).eps * np.abs(rock_matrices(body)[0]).sum() * step.sum() ** 2
    assert round_off < 1e-9 * ENERGY * AREA
    assert ledger["work"] == pytest.approx(ENERGY * AREA, rel=1e-12, abs=round_off)
    assert ledger["fracture"] == pytest.approx(ENERGY * AREA, rel=1e-12)


def test_a_slow_pull_of_deformable_blocks_takes_the_fracture_energy(joint):
    """Work at the ends is G_c A within 1e-6: the kinetic energy of all the rock at the speed of the
    pull, 1e-4 m/s, is 4e-7 of it, and the blocks are stiffer than the softening joint is steep."""
    scene, discrete = joint(1)
    body = discrete.body
    dt = 0.5 * critical_step_of(scene, discrete, "jointed")
    ends = [np.flatnonzero(body.y == y) for y in (0.0, 1.0)]
    freedom = np.concatenate([body.freedom(node, 0) for node in ends])
    step = np.full(int(1.2 * CRITICAL / (1e-4 * dt)), 1e-4 * dt)
    ledger = pulled(scene, discrete, freedom, np.array([0.0, 1.0]), step, dt)
    assert ledger["fracture"] == pytest.approx(ENERGY * AREA, rel=1e-12)
    assert ledger["work"] == pytest.approx(ENERGY * AREA, rel=1e-6)
