"""Joints at random: what is drawn, and that every solution takes it."""

import numpy as np
import pytest

from jointwave.cases.material.calibrate import calibrate
from jointwave.compare.engines import solve
from jointwave.compare.misfit.metrics import misfit

SMOOTH = {"load": {"shape": "ricker", "amplitude": 1e6, "period": 0.01}, "ends__end": "matched"}
SHORT = {**SMOOTH, "time__duration": 0.04}


def scattered(pillar, seed=1, **changes):
    return pillar(
        **{**SHORT, "scatter": {"spacing": 0.3, "compliance": 0.3, "seed": seed}, **changes}
    )


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
    assert p.contact_y[[1, 2]].round(6).tolist() == FIRST
    assert p.masses.sum() == pytest.approx(2400.0 * 0.25 * 50.0)


#: Of seed 7, m: as numpy 1.26 draws them on x86-64.
FIRST = [0.574627, 1.29306]


def test_spread_and_mean_are_those_asked_for(pillar):
    """Of 20,000 blocks, within four standard errors: 0.3 (1 +- 4 / sqrt(2 n)) at most."""
    p = calibrate(scattered(pillar, pillar__length=10_000.0, record={"stress": [20.0]}))
    for values in (np.diff(p.contact_y), 1 / p.own_stiffness):
        assert values.std() / values.mean() == pytest.approx(0.3, rel=0.02)
        assert values.max() / values.mean() < 1 + 0.3 * np.sqrt(3) * 1.01
    mean = 0.5 * (1 / p.modulus - 1 / p.intact_modulus)
    assert (1 / p.own_stiffness).mean() == pytest.approx(mean, rel=4 * 0.3 / np.sqrt(20_000))


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
@pytest.mark.parametrize("changes", [{}, {"joints__damping_ratio": 0.05}])
def test_engines_meet_their_exact_solutions(pillar, engine, exact, bound, changes):
    scene = scattered(pillar, **changes)
    assert misfit(solve(engine, scene), solve(exact, scene)) < bound


@pytest.mark.parametrize("solution", ["dem", "jointed-bar", "continuum-jointed"])
def test_a_scatter_of_next_to_nothing_changes_as_much(pillar, solution):
    none = solve(solution, pillar(**SHORT))
    some = [
        misfit(solve(solution, pillar(**SHORT, scatter={key: 1e-5, "seed": 1})), none)
        for key in ("spacing", "compliance")
    ]
    assert max(some) < 1e-4


def test_long_waves_see_the_mean(pillar):
    """The homogenised bar is that of the mean compliance: what a random pillar differs by falls
    with the length of the wave, here from some 27 to some 270 blocks, to what the mean of a hundred
    joints is off by."""
    found = []
    for period in (0.01, 0.1):
        load = {"shape": "ricker", "amplitude": 1e6, "period": period}
        scene = scattered(pillar, load=load, time__duration=4 * period)
        found.append(misfit(solve("equivalent-bar", scene), solve("jointed-bar", scene)))
    assert found[1] < 0.6 * found[0]


def test_soft_layers_take_the_nearest_joint(pillar):
    scene = scattered(pillar, soft_layers=[{"y": 20.1, "normal_stiffness": 1e9}])
    p = calibrate(scene)
    assert p.soft.tolist() == [int(np.abs(p.joint_y - 20.1).argmin())]
    assert p.own_stiffness[p.soft[0]] == pytest.approx(1e9)
