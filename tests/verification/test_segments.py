"""Pillars of several rocks, by d'Alembert's waves: reflected, transmitted, late and trapped.

Where two rocks of impedances Z1 and Z2 meet, R = (Z2 - Z1)/(Z2 + Z1) of the stress is reflected and
T = 2 Z2/(Z1 + Z2) passes (Graff, Wave Motion in Elastic Solids, 1975); a layer between two others
sends out what runs to and fro in it, a sum of delayed copies.
"""

from itertools import pairwise

import numpy as np
import pytest

from jointwave import continuum
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
    """Return an intact segment."""
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


def impedance(rock: tuple[float, float]) -> float:
    return float(np.sqrt(rock[0] * rock[1]))


def slowness(rock: tuple[float, float]) -> float:
    return float(np.sqrt(rock[0] / rock[1]))


def three_bars(scene, one, layer, other) -> np.ndarray:
    """Return the stress 2 m from the start and 0.2 m from the end of three bars, with all that runs
    to and fro in the layer."""
    Z1, Z2, Z3 = (impedance(rock) for rock in (one, layer, other))
    first, meet, crossing = 2.0 * slowness(one), LENGTHS[0] * slowness(one), 0.6 * slowness(layer)
    R12, R23, R21 = (Z2 - Z1) / (Z2 + Z1), (Z3 - Z2) / (Z3 + Z2), (Z1 - Z2) / (Z1 + Z2)
    T12, T23, T21 = 2 * Z2 / (Z1 + Z2), 2 * Z3 / (Z2 + Z3), 2 * Z1 / (Z1 + Z2)
    front = wave(scene, first) + R12 * wave(scene, 2 * meet - first)
    behind, far = np.zeros_like(front), 3.8 * slowness(other)
    for k in range(40):
        echo = (R23 * R21) ** k
        front += T12 * R23 * T21 * echo * wave(scene, 2 * meet - first + 2 * (k + 1) * crossing)
        behind += T12 * T23 * echo * wave(scene, meet + (2 * k + 1) * crossing + far)
    return np.stack([front, behind])


#: Solutions of smooth bars, and what they may differ from d'Alembert's waves by: round-off, and
#: the error of the steps of quadratic elements.
SMOOTH = [("jointed-bar", 1e-10), ("continuum-jointed", 5e-5), ("continuum-equivalent", 5e-5)]


#: Two bars, and a layer between two others.
BARS = [(STEEL, GRANITE, GRANITE), (SALT, STEEL, STEEL), (STEEL, SALT, GRANITE)]


@pytest.mark.parametrize("solution, bound", SMOOTH)
def test_bars_reflect_and_pass_and_layers_ring(bars, solution, bound):
    """What salt between steel and granite sends out, forty times to and fro."""
    for rocks in BARS:
        scene = bars(*rocks)
        exact = three_bars(scene, *rocks)
        assert relative_l2(solve(solution, scene).stress.values, exact) < bound


def test_a_column_of_two_rocks(bars):
    """Where nothing widens (Poisson's ratio 0) it is the bar, to the round-off of 1,000 steps: an
    interval below the critical step is the step in both."""
    one, other = (
        {**bar([0.0, 1.0], STEEL, 0.1), "intact_poisson": 0.0},
        {**bar([1.0, 1.6], GRANITE, 0.1), "intact_poisson": 0.0},
    )
    scene = bars(
        *(STEEL, GRANITE),
        pillar__length=1.6,
        segments=[one, other],
        load__period=2e-4,
        time__duration=5e-4,
        record={"stress": [0.5, 1.4], "velocity": [0.25, 1.6], "interval": 5e-7},
    )
    flat, solid = (continuum.simulate(scene, "jointed", dim=d) for d in (1, 3))
    assert flat.attrs["dt"] == solid.attrs["dt"]
    assert misfit(solid, flat) < 1e-10


#: What [rock] of the pillar says already, in other words.
SAME = {"density": 2400.0, "p_speed": 2200.0, "s_speed": 800.0, "intact_modulus": 8.64e10}
JOINTED = {"joints__damping_ratio": 0.02, "time__duration": 0.03, "ends__end": "matched"}


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
    load = {"shape": "ricker", "amplitude": 1e6, "period": 0.01}
    thin = [{"y": [20.0, 30.0], "block": 0.25}]
    scene = pillar(segments=thin, load=load)
    assert misfit(EQUIVALENT.run(scene), EQUIVALENT.run(pillar(load=load))) < 1e-7
    p, q = calibrate(scene), calibrate(pillar())
    assert (p.block_count, p.contact_y[-1]) == (120, 50.0)
    k, (thick, half) = q.regular_stiffness, (q.regular_own_stiffness, 2 * q.regular_own_stiffness)
    assert p.stiffness[[0, 39, 50, 79]] == pytest.approx([k, k / 0.75, 2 * k, k / 0.75])
    between = 1 / (0.5 / thick + 0.5 / half)
    assert p.own_stiffness[[0, 39, 50, 79]] == pytest.approx([thick, between, half, between])


def test_jointed_rock_between_bars(bars):
    """Rigid blocks, jointed rock and the homogenised bar each meet their exact solution, with
    damped joints in the specimen and a soft one where the bar meets it."""
    specimen = {"y": [4.0, 4.6], "block": 0.05, "density": 2650.0, "intact_modulus": 6e10}
    specimen |= {"normal_stiffness": 5e11, "damping_ratio": 0.05}
    segments = [bar([0.0, 4.0], STEEL), specimen, bar([4.6, 8.6], STEEL)]
    layers = [{"y": 4.0, "normal_stiffness": 4e11, "damping_ratio": 0.1}]
    scene = bars(STEEL, GRANITE, STEEL, segments=segments, soft_layers=layers)
    for engine, exact, bound in (
        ("dem", "lattice", 5e-4),
        ("continuum-jointed", "jointed-bar", 5e-4),
        ("continuum-equivalent", "equivalent-bar", 5e-4),
    ):
        assert misfit(solve(engine, scene), solve(exact, scene)) < bound
