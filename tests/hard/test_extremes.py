"""Loads, sizes and shapes at the limits of numbers and elements."""

from math import pi, sqrt

import numpy as np
import pytest

from hard_runs import BLOCKS, CUBES, EPS, JOINT, ROCK, SCHEMES, HardRun, marked
from jointwave.compare.engines import solve
from jointwave.compare.misfit.metrics import relative_l2

SOLID = {
    "numerics.continuum.dim": 3,
    "numerics.continuum.elements_per_block": 1,
    "record.velocity": [],
    "step": 0.9,
    "time.duration": 0.01,
}
#: As in the short pillar, but that nothing changes its volume.
INCOMPRESSIBLE = {
    "rock": {
        "density": 2400.0,
        "equivalent_modulus": 4.374e9,
        "equivalent_poisson": 0.49999,
        "intact_modulus": 8.64e10,
        "intact_poisson": 0.49999,
    },
    "pillar.side": 0.05,
    "pillar.length": 4.0,
    "record.stress": [2.0],
}
SLENDER = {"pillar.side": 0.0005, "pillar.length": 2.0, "record.stress": [1.0]}


def test_joints_a_little_stiffer_are_beyond_the_phase_error():
    """A twentieth on every joint is seen: the bound is no wider than what it bounds."""
    run = HardRun("dem", "leapfrog")
    layers = [{"y": 0.5 * j, "normal_stiffness": 1.05 * JOINT} for j in range(1, 20)]
    assert run.referee()[1] < run.allowed()
    run.result = run.run(soft_layers=layers)
    assert run.referee()[1] > run.allowed()


@pytest.mark.parametrize(("engine", "scheme"), marked(SCHEMES))
def test_jump_in_stress_is_as_wrong_as_dispersion_makes_it(engine, scheme):
    """The spectrum of a jump is 1 / omega. A frequency beyond the w of `lost_after` is lost (twice
    its amplitude at worst), one below it is wrong by its phase: as this grows as the third power or
    more, Parseval gives the square of the error as (4 + 1/5) / (pi w). That of the signal is at
    least t / 4: each section is under stress for a quarter of the time or more."""
    step = {"load": {"shape": "step", "amplitude": 1e6}, "time.duration": 0.02}
    run = HardRun(engine, scheme, step)
    assert run.referee()[1] <= sqrt(4.2 / pi * run.lost_after() / (run.duration / 4))


@pytest.mark.parametrize(("engine", "scheme"), marked(SCHEMES))
@pytest.mark.parametrize("amplitude", [1e-30, 1e30])
def test_linear_results_scale_with_the_load(amplitude, engine, scheme):
    """Over the amplitude, the result is that of 1 Pa. Only the factor rounds, at the load and at
    the result, by an eps each; every step keeps its relative error, which a sum over steps
    multiplies by at most their number."""
    run = HardRun(engine, scheme)
    one, scaled = (run.run(load__amplitude=a) for a in (1.0, amplitude))
    for name in ("stress", "velocity"):
        found = relative_l2(scaled[name].values / amplitude, one[name].values)
        assert found <= EPS * (2 + float(one.attrs["steps"]))


@pytest.mark.parametrize(("engine", "scheme"), marked(SCHEMES))
def test_nothing_moves_without_a_load(engine, scheme):
    """Every number of the result is exactly zero."""
    result = HardRun(engine, scheme, {"load.amplitude": 0.0}).result
    assert not any(v.values.any() for v in result.data_vars.values() if v.dtype.kind == "f")


@pytest.mark.parametrize(
    ("engine", "scheme", "length", "orders"),
    [
        ("dem", "leapfrog", 5e5, 0),
        pytest.param("dem", "fourth-order", 5e5, 0, marks=pytest.mark.slow),
        pytest.param("continuum-jointed", "explicit", 5e4, 0, marks=pytest.mark.slow),
        ("continuum-equivalent", "explicit", 5e3, 0),
        pytest.param("continuum-equivalent", "explicit", 5e4, 1, marks=pytest.mark.slow),
    ],
)
def test_rock_that_no_wave_has_reached_has_no_influence(engine, scheme, length, orders):
    """The first blocks of a million (of a hundred thousand that deform) move like those of a
    thousand, bit for bit: explicit steps propagate by one block per step. A matrix of rock in one
    piece that exceeds the cache is added up in another order: by eps in each step at most."""
    changes = {"time.duration": 0.01, "record.velocity": [], "step": 0.9}
    run = HardRun(engine, scheme, changes)
    long, short = (run.run(pillar__length=one) for one in (length, 500.0))
    assert long.attrs["dt"] == short.attrs["dt"]
    off = np.abs(long["stress"].values - short["stress"].values).max()
    assert off <= orders * short.attrs["steps"] * EPS * np.abs(short["stress"].values).max()


@pytest.mark.parametrize(("engine", "scheme"), marked(ROCK))
@pytest.mark.parametrize("shape", [INCOMPRESSIBLE, SLENDER], ids=["Poisson 0.49999", "aspect 1000"])
def test_slender_column_of_solid_elements_is_a_bar(shape, engine, scheme):
    """Elements that lock are too stiff, and a poor condition shows as noise. Love's correction for
    the square section, nu^2 k^2 a^2 / 12 of the speed, is all that theory allows beside the steps'
    and the elements'."""
    run = HardRun(engine, scheme, SOLID | shape)
    name = "jointed-bar" if engine == "continuum-jointed" else "equivalent-bar"
    found = relative_l2(run.result["stress"].values, solve(name, run.scene)["stress"].values)
    p, omega = run.properties, run.peak
    poisson = max(p.poisson, run.scene.rock.intact_poisson)
    love = (poisson * omega / p.bar_speed * p.side) ** 2 / 12 * CUBES * omega * run.duration
    assert found <= run.allowed() + love


@pytest.mark.parametrize("ratio", [0.01, 0.1, 10, 100])
def test_row_of_blocks_of_any_shape_moves_as_the_exact_row(ratio):
    """Blocks so many times as wide as thick, loaded off their axis: stress, motion and rotation,
    each apart, as they differ in size, are within the phase error."""
    side = 0.5 * ratio
    changes = {
        "pillar.side": side,
        "load.at": [0.2 * side, 0.0],
        "load.amplitude": 1.0,
        "pillar.length": 4.0,
        "time.duration": 0.02,
        "record.stress": [2.0],
        "record.velocity": [3.75],
    }
    run = HardRun(*BLOCKS[0], changes)
    exact = solve("spatial-lattice", run.scene)
    for name in ("stress", "shear", "velocity", "rotation"):
        if exact[name].values.any():
            off = relative_l2(run.result[name].values, exact[name].values)
            assert off <= run.phase_error(), name
