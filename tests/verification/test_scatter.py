"""Joints at random: what is drawn, and that every solution takes it."""

import numpy as np
import pytest

from jointwave.cases.material.calibrate import calibrate
from jointwave.compare.engines import solve
from jointwave.compare.misfit.metrics import misfit

SMOOTH = {"load": {"shape": "ricker", "amplitude": 1e6, "period": 0.01}, "ends__end": "matched"}


def scattered(pillar, seed=1, **changes):
    scatter = {"spacing": 0.3, "compliance": 0.3, "seed": seed}
    return pillar(**{**SMOOTH, "time__duration": 0.04, "scatter": scatter, **changes})


def test_a_seed_gives_the_same_joints_everywhere(pillar):
    """PCG64 by SeedSequence([seed, what, region]): the first draws, worked out by numpy alone."""
    p = calibrate(scattered(pillar, seed=7))
    draws = np.array(
        [np.random.Generator(np.random.PCG64([7, what, 0])).random(100) for what in (0, 1)]
    )
    wide = 1 + 0.3 * np.sqrt(3) * (2 * draws - 1)
    assert np.diff(p.contact_y) == pytest.approx(50.0 * wide[0] / wide[0].sum(), rel=1e-12)
    mean = 0.5 * (1 / p.modulus - 1 / p.intact_modulus)
    assert 1 / p.own_stiffness == pytest.approx(mean * wide[1][:99], rel=1e-9)
    rock = (np.diff(p.contact_y)[1:] + np.diff(p.contact_y)[:-1]) / 2 / p.intact_modulus
    assert 1 / p.stiffness == pytest.approx(mean * wide[1][:99] + rock, rel=1e-9)
    assert p.contact_y[[1, 2]].round(6).tolist() == [0.574627, 1.29306]  # by numpy 1.26 on x86-64
    assert p.masses.sum() == pytest.approx(2400.0 * 0.25 * 50.0)


def test_members_and_segments_differ(pillar):
    """Another seed gives other joints; those of an intact segment stay, and each has its length."""
    bar = {"y": [10.0, 20.0], "joints": False, "block": 0.25}
    one, other = (calibrate(scattered(pillar, seed, segments=[bar])) for seed in (1, 2))
    assert (one.contact_y[[0, 20, 60, -1]] == [0.0, 10.0, 20.0, 50.0]).all()
    assert np.diff(one.contact_y)[20:60] == pytest.approx(0.25)
    assert not np.isfinite(one.own_stiffness[20:59]).any()
    jointed = [*range(20), *range(60, 120)]
    assert (np.diff(one.contact_y)[jointed] != np.diff(other.contact_y)[jointed]).all()


@pytest.mark.parametrize(
    "engine, exact, bound",
    [
        ("dem", "lattice", 5e-4),
        ("continuum-jointed", "jointed-bar", 5e-4),
        ("continuum-equivalent", "equivalent-bar", 2e-3),
    ],
)
def test_engines_meet_their_exact_solutions(pillar, engine, exact, bound):
    scene = scattered(pillar, joints__damping_ratio=0.05)
    assert misfit(solve(engine, scene), solve(exact, scene)) < bound


def test_soft_layers_take_the_nearest_joint(pillar):
    scene = scattered(pillar, soft_layers=[{"y": 20.1, "normal_stiffness": 1e9}])
    p = calibrate(scene)
    assert p.soft.tolist() == [int(np.abs(p.joint_y - 20.1).argmin())]
    assert p.own_stiffness[p.soft[0]] == pytest.approx(1e9)
