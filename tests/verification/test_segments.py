"""Pillars of several rocks, by d'Alembert's waves, reflected, transmitted, late and trapped, and of
joints at random.

Where two rocks of impedances Z1 and Z2 meet, R = (Z2 - Z1)/(Z2 + Z1) of the stress is reflected and
T = 2 Z2/(Z1 + Z2) passes (Graff, Wave Motion in Elastic Solids, 1975); a layer between two others
sends out what runs to and fro in it, a sum of delayed copies."""

from itertools import pairwise

import numpy as np
import pytest

from jointwave.cases.loads import load_history
from jointwave.cases.material.calibrate import calibrate
from jointwave.cases.sampling import sample_times
from jointwave.compare.engines import solve
from jointwave.compare.exact.bar.bars import EQUIVALENT
from jointwave.compare.misfit.metrics import misfit, relative_l2

#: Density (kg/m3) and Young's modulus (Pa) of steel, a stiff rock and a soft one.
STEEL, GRANITE, SALT = (7850.0, 2.1e11), (2650.0, 6.0e10), (2200.0, 3.0e10)
LENGTHS = 4.0, 0.6, 4.0  # m
PERIOD = 4e-4  # s, of the Ricker wavelet's peak frequency


def bar(y: list[float], rock: tuple[float, float], block: float = 0.02) -> dict:
    density, modulus = rock
    return {"y": y, "joints": False, "density": density, "intact_modulus": modulus, "block": block}


@pytest.fixture
def bars(pillar):
    """Return a function that gives intact bars of rocks between matched ends, keys changed."""

    def scene(*rocks, **changes):
        y = np.cumsum([0.0, *LENGTHS[: len(rocks)]]).round(9).tolist()
        tables = {
            "pillar": {"length": y[-1], "side": 0.05, "block": 0.1},
            "segments": [bar([*ends], one) for ends, one in zip(pairwise(y), rocks, strict=True)],
            "load": {"shape": "ricker", "amplitude": 2e8, "period": PERIOD},
            "ends": {"start": "matched", "end": "matched"},
            "time": {"duration": 4e-3},
            "record": {"stress": [2.0, y[-1] - 0.2], "velocity": [], "interval": 4e-6},
        }
        return pillar(**{**tables, **changes})

    return scene


def wave(scene, delay: float) -> np.ndarray:
    """Return half of the load, which enters a matched start, late by a delay (s)."""
    return load_history(scene).value(sample_times(scene) - delay) / 2


def three_bars(scene, rocks) -> np.ndarray:
    """Return the stress 2 m from the start and 0.2 m from the end of three bars, with all that runs
    to and fro in the layer."""
    density, modulus = np.transpose(rocks)
    (Z1, Z2, Z3), slowness = np.sqrt(density * modulus), np.sqrt(density / modulus)
    first, meet, crossing = 2.0 * slowness[0], LENGTHS[0] * slowness[0], 0.6 * slowness[1]
    R12, R23, R21 = (Z2 - Z1) / (Z2 + Z1), (Z3 - Z2) / (Z3 + Z2), (Z1 - Z2) / (Z1 + Z2)
    T12, T23, T21 = 2 * Z2 / (Z1 + Z2), 2 * Z3 / (Z2 + Z3), 2 * Z1 / (Z1 + Z2)
    front = wave(scene, first) + R12 * wave(scene, 2 * meet - first)
    behind, far = np.zeros_like(front), 3.8 * slowness[2]
    for k in range(40):
        echo = (R23 * R21) ** k
        front += T12 * R23 * T21 * echo * wave(scene, 2 * meet - first + 2 * (k + 1) * crossing)
        behind += T12 * T23 * echo * wave(scene, meet + (2 * k + 1) * crossing + far)
    return np.stack([front, behind])


#: Two bars, and a layer between two others.
BARS = [(STEEL, GRANITE, GRANITE), (SALT, STEEL, STEEL), (STEEL, SALT, GRANITE)]


@pytest.mark.parametrize(
    "solution, bound",
    [("jointed-bar", 1e-10), ("continuum-jointed", 5e-5), ("continuum-equivalent", 5e-5)],
)
def test_bars_reflect_and_pass_and_layers_ring(bars, solution, bound):
    """What salt between steel and granite sends out, forty times to and fro: to round-off, and the
    error of the steps of quadratic elements."""
    for rocks in BARS:
        scene = bars(*rocks)
        assert relative_l2(solve(solution, scene).stress.values, three_bars(scene, rocks)) < bound


#: What [rock] of the pillar says already, in other words.
SAME = {"density": 2400.0, "p_speed": 2200.0, "s_speed": 800.0, "intact_modulus": 8.64e10}
JOINTED = {"joints__damping_ratio": 0.02, "time__duration": 0.03, "ends__end": "matched"}
JOINTED["soft_layers"] = [{"y": 25.0, "spacing_stiffness": 4.375e8, "damping_ratio": 0.02}]


@pytest.mark.parametrize(
    "solution, bound",
    [
        *(("dem", 1e-9), ("jointed-bar", 1e-6), ("equivalent-bar", 1e-6)),
        *(("continuum-jointed", 1e-9), ("continuum-equivalent", 1e-9)),
    ],
)
def test_segments_of_the_same_rock_change_nothing(pillar, solution, bound):
    """But round-off, and in the exact bars where kinks of the load are summed apart."""
    same = [{"y": [10.0, 20.0], **SAME}, {"y": [20.0, 31.5]}]
    one, other = (pillar(**JOINTED, **changes) for changes in ({}, {"segments": same}))
    assert misfit(solve(solution, other), solve(solution, one)) < bound


def test_blocks_of_another_thickness_are_the_same_rock_mass(pillar):
    """One E_eq: the homogenised bar is the same, and blocks of half the thickness have joints of
    twice the stiffness. Between both there is half of each joint."""
    thin, load = [{"y": [20.0, 30.0], "block": 0.25}], RICKER["load"]
    scene = pillar(segments=thin, load=load)
    assert misfit(EQUIVALENT.run(scene), EQUIVALENT.run(pillar(load=load))) < 1e-7
    p, q = calibrate(scene), calibrate(pillar())
    assert (p.block_count, p.contact_y[-1]) == (120, 50.0)
    k, (thick, half) = q.regular_stiffness, (q.regular_own_stiffness, 2 * q.regular_own_stiffness)
    assert p.stiffness[[0, 39, 50, 79]] == pytest.approx([k, k / 0.75, 2 * k, k / 0.75])
    between = 1 / (0.5 / thick + 0.5 / half)
    assert p.own_stiffness[[0, 39, 50, 79]] == pytest.approx([thick, between, half, between])


RICKER = {"load": {"shape": "ricker", "amplitude": 1e6, "period": 0.01}, "ends__end": "matched"}


def scattered(pillar, seed=1, **changes):
    scatter = {"spacing": 0.3, "compliance": 0.3, "seed": seed}
    return pillar(**{**RICKER, "time__duration": 0.04, "scatter": scatter, **changes})


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


def test_soft_layers_take_the_nearest_joint(pillar):
    scene = scattered(pillar, soft_layers=[{"y": 20.1, "normal_stiffness": 1e9}])
    p = calibrate(scene)
    assert p.soft.tolist() == [int(np.abs(p.joint_y - 20.1).argmin())]
    assert p.own_stiffness[p.soft[0]] == pytest.approx(1e9)


@pytest.mark.parametrize(
    ("engine", "exact"),
    [
        ("dem", "lattice"),
        ("continuum-jointed", "jointed-bar"),
        ("continuum-equivalent", "equivalent-bar"),
    ],
)
def test_engines_meet_their_exact_solutions(bars, engine, exact):
    """Jointed rock between bars, with damped joints in the specimen and a soft one where the bar
    meets it; a shipped scene has joints at random."""
    specimen = {"y": [4.0, 4.6], "block": 0.05, "density": 2650.0, "intact_modulus": 6e10}
    specimen |= {"normal_stiffness": 5e11, "damping_ratio": 0.05}
    segments = [bar([0.0, 4.0], STEEL), specimen, bar([4.6, 8.6], STEEL)]
    layers = [{"y": 4.0, "normal_stiffness": 4e11, "damping_ratio": 0.1}]
    between = bars(STEEL, GRANITE, STEEL, segments=segments, soft_layers=layers)
    assert misfit(solve(engine, between), solve(exact, between)) < 5e-4
