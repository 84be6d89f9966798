"""Pillars of several rocks, by d'Alembert's waves: reflected, transmitted, late and trapped.

Where two rocks of impedances Z1 and Z2 meet, R = (Z2 - Z1)/(Z2 + Z1) of the stress is reflected and
T = 2 Z2/(Z1 + Z2) passes (Graff, Wave Motion in Elastic Solids, 1975); a layer between two others
sends out what runs to and fro in it, a sum of delayed copies.
"""

from itertools import pairwise

import numpy as np
import pytest

from jointwave import continuum, dem
from jointwave.cases.loads import load_history
from jointwave.cases.material.calibrate import calibrate
from jointwave.cases.sampling import sample_times
from jointwave.compare.engines import solve
from jointwave.compare.exact.bar.bars import EQUIVALENT, bar_of
from jointwave.compare.exact.bar.transfer import transfer
from jointwave.compare.misfit.metrics import misfit

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


def two_bars(scene, one, other) -> np.ndarray:
    """Return the stress 2 m from the start and 0.2 m from the end of two bars."""
    Z1, Z2 = impedance(one), impedance(other)
    first, meet = 2.0 * slowness(one), LENGTHS[0] * slowness(one)
    front = wave(scene, first) + (Z2 - Z1) / (Z2 + Z1) * wave(scene, 2 * meet - first)
    far = scene.pillar.length - LENGTHS[0] - 0.2
    return np.stack([front, 2 * Z2 / (Z1 + Z2) * wave(scene, meet + far * slowness(other))])


def three_bars(scene, one, layer, other) -> np.ndarray:
    """Return the same of three, with all that runs to and fro in the layer."""
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


PAIRS = [(STEEL, GRANITE), (GRANITE, STEEL), (SALT, STEEL)]


#: Solutions of smooth bars, and what they may differ from d'Alembert's waves by: round-off, and
#: the error of the steps of quadratic elements.
SMOOTH = [
    *(("jointed-bar", 1e-10), ("equivalent-bar", 1e-10)),
    *(("continuum-jointed", 5e-5), ("continuum-equivalent", 5e-5)),
]


def relative(found: np.ndarray, exact: np.ndarray) -> float:
    return float(np.linalg.norm(found - exact) / np.linalg.norm(exact))


@pytest.mark.parametrize("rocks", PAIRS)
@pytest.mark.parametrize("solution, bound", SMOOTH)
def test_two_bars_reflect_and_pass(bars, rocks, solution, bound):
    scene = bars(*rocks)
    assert relative(solve(solution, scene).stress.values, two_bars(scene, *rocks)) < bound


@pytest.mark.parametrize("solution, bound", SMOOTH)
def test_a_layer_rings(bars, solution, bound):
    """What the layer of salt between steel and granite sends out, forty times to and fro."""
    rocks = STEEL, SALT, GRANITE
    scene = bars(*rocks)
    assert relative(solve(solution, scene).stress.values, three_bars(scene, *rocks)) < bound


@pytest.mark.parametrize("solution", ["lattice", "dem"])
@pytest.mark.parametrize("rocks", PAIRS)
def test_rigid_blocks_tend_to_two_bars(bars, solution, rocks):
    """With the square of their thickness: the chain's dispersion, at most 1.5 % of waves that are
    70 blocks long in salt. All of the load enters a free start, which nothing comes back to yet.
    """
    free = {"ends": {"start": "free", "end": "matched"}, "time": {"duration": 1.5e-3}}
    error = []
    for block in (0.02, 0.01):
        y = [[0.0, 4.0], [4.0, 4.6]]
        cut = [bar(ends, one, block) for ends, one in zip(y, rocks, strict=True)]
        scene = bars(*rocks, segments=cut, **free)
        exact = 2 * two_bars(scene, *rocks)
        error.append(relative(solve(solution, scene).stress.values, exact))
    assert error[0] < 0.015
    assert error[0] / error[1] == pytest.approx(4, rel=0.05)


def test_harmonic_waves_through_a_layer(bars):
    """The stress that passes is 2 Z3 / ((Z1 + Z3) cos q + i (Z2 + Z1 Z3 / Z2) sin q) of what comes,
    q = omega h / c (Brekhovskikh 1980), of any frequency, to round-off."""
    rocks = STEEL, GRANITE, SALT
    scene, (Z1, Z2, Z3) = bars(*rocks), (impedance(rock) for rock in rocks)
    omega = 2 * np.pi * np.array([10.0, 500.0, 2500.0, 7000.0])
    stress, _ = transfer(bar_of(scene, resolved=True), 1j * omega, np.array([4.0, 4.6]))
    q = omega * 0.6 * slowness(GRANITE)
    passed = 2 * Z3 / ((Z1 + Z3) * np.cos(q) + 1j * (Z2 + Z1 * Z3 / Z2) * np.sin(q))
    incoming = np.exp(-1j * omega * 4.0 * slowness(STEEL)) / 2
    assert stress[1] == pytest.approx(passed * incoming, rel=1e-12)


def test_a_quarter_wave_layer_matches_two_rocks(bars):
    """Of sqrt(Z1 Z3) and a quarter of a wavelength it lets all energy pass: |sigma|^2 / Z."""
    Z1, Z3 = impedance(STEEL), impedance(SALT)
    between = 5000.0, Z1 * Z3 / 5000.0
    scene = bars(STEEL, between, SALT)
    omega = np.pi / 2 / (0.6 * slowness(between))
    (stress,), _ = transfer(bar_of(scene, resolved=True), np.array([1j * omega]), np.array([8.0]))
    assert abs(stress[0]) ** 2 / Z3 == pytest.approx(0.25 / Z1, rel=1e-12)


def test_energy_of_what_meets_two_bars_is_kept(bars):
    scene = bars(STEEL, SALT)
    for result in (dem.simulate(scene), continuum.simulate(scene, "jointed", dim=1)):
        energy = result.energy.sel(term=["kinetic", "elastic", "boundary"]).sum("term")
        work = float(np.abs(result.energy.sel(term="work")).max())
        assert float(np.abs(energy - result.energy.sel(term="work")).max()) < 1e-10 * work


@pytest.mark.parametrize("dim", [2, 3])
def test_a_column_of_two_rocks(bars, dim):
    """Where nothing widens (Poisson's ratio 0) it is the bar, to the round-off of 1,000 steps: an
    interval below the critical step is the step in every dimension."""
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
    flat, solid = (continuum.simulate(scene, "jointed", dim=d) for d in (1, dim))
    assert flat.attrs["dt"] == solid.attrs["dt"]
    assert misfit(solid, flat) < 1e-10


#: What [rock] of the pillar says already, in other words.
SAME = {"density": 2400.0, "p_speed": 2200.0, "s_speed": 800.0, "intact_modulus": 8.64e10}
JOINTED = {"joints__damping_ratio": 0.02, "time__duration": 0.03, "ends__end": "matched"}


@pytest.mark.parametrize("changes", [JOINTED, {"time__duration": 0.03, "ends__end": "fixed"}])
@pytest.mark.parametrize(
    "solution, bound",
    [
        *(("dem", 1e-9), ("lattice", 1e-9), ("jointed-bar", 1e-6), ("equivalent-bar", 1e-6)),
        *(("continuum-jointed", 1e-9), ("continuum-equivalent", 1e-9)),
    ],
)
def test_segments_of_the_same_rock_change_nothing(pillar, changes, solution, bound):
    """But round-off, and in the exact bars where kinks of the load are summed apart."""
    same = [{"y": [10.0, 20.0], **SAME}, {"y": [20.0, 31.5]}]
    scene = pillar(**changes)
    assert misfit(solve(solution, pillar(segments=same, **changes)), solve(solution, scene)) < bound


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
