"""A compliant base: what comes up from the rock behind a quiet start is the motion given."""

import numpy as np
import pytest

from jointwave.cases.histories import Gabor, Integrated
from jointwave.cases.material.calibrate import calibrate
from jointwave.cases.read import load_tables
from jointwave.compare.engines import solve

PERIOD, PEAK = 0.01, 0.02  # s, m/s
GABOR = {"shape": "gabor", "period": PERIOD, "cycles": 2, "amplitude": PEAK}


def column(quantity="velocity", direction=(0, 1, 0), **numerics):
    """Return a column of uniform rock between quiet ends."""
    return load_tables(
        {
            "title": "a column",
            "pillar": {"length": 20.0, "side": 0.5, "block": 0.25},
            "rock": {"density": 2400.0, "p_speed": 2200.0, "s_speed": 800.0},
            "motion": {"rotation": "none"},
            "load": GABOR | {"quantity": quantity, "direction": list(direction)},
            "ends": {"start": "quiet", "end": "matched"},
            "time": {"duration": 0.06},
            "record": {"velocity": [0.0, 10.0], "interval": 1e-4},
            "numerics": numerics,
        }
    )


def expected(scene, speed):
    """Return the wave that the record gives, at the receivers."""
    pulse = Gabor(PEAK, PERIOD, 2)
    history = Integrated(pulse) if scene.load.quantity == "acceleration" else pulse
    t = 1e-4 * np.arange(601)
    return np.array([history.value(t - y / speed) for y in scene.record.velocity])


@pytest.mark.parametrize("quantity", ["velocity", "acceleration"])
def test_the_exact_bar_has_the_record_that_is_given(quantity):
    """To what the inversion of the bar's Laplace transform says of its own error; deformable rock
    passes it on, too."""
    scene = column(quantity)
    found = solve("equivalent-bar", scene)
    wave = expected(scene, calibrate(scene).bar_speed)
    off = np.sqrt(np.mean((found.velocity.values[..., 0] - wave) ** 2, axis=1))
    assert (off < found.velocity_error.values[:, 0]).all()
    assert (off < 1e-7 * np.abs(wave).max()).all()
    rock = solve("continuum-equivalent", scene).velocity.values[1, :, -1]
    assert np.linalg.norm(rock - wave[1]) < 1e-3 * np.linalg.norm(wave[1])


@pytest.mark.parametrize(
    ("quantity", "direction"),
    [("velocity", (0, 1, 0)), ("acceleration", (0, 1, 0)), ("velocity", (1, 0, 0))],
    ids=["velocity along", "acceleration along", "velocity across"],
)
def test_rigid_blocks_pass_the_record_on(quantity, direction):
    """The first block feels the record at its centre, d / 2 too far in, and delays it by d / 4 c,
    as half of its mass is more than a chain has there: the record acts d / 4 c later. What is left
    is of the second order, at the period pi^3 N (d / lambda)^2 / 3 of phase over N waves, (omega d
    / 4 c)^2 of the first block; over the pulse's spectrum, a Gaussian of deviation 0.225 / T, the
    root mean squares of f^3 and f^2 are 1.37 and 1.14 of that."""
    scene = column(quantity, direction)
    p = calibrate(scene)
    speed = p.shear_speed if direction[0] else p.bar_speed
    component = 0 if direction[0] else -1
    found = solve("dem", scene).velocity.values[1, :, component]
    wave = expected(scene, speed)[1]
    way, block = 10.0 / (speed * PERIOD), 0.25 / (speed * PERIOD)
    second = 1.37 * np.pi**3 * way * block**2 / 3 + 1.14 * (np.pi * block / 2) ** 2
    assert np.linalg.norm(found - wave) < second * np.linalg.norm(wave)


@pytest.fixture
def strip(one_joint):
    """The tables of rock with a level joint between a quiet base and a free surface."""
    tables = one_joint(
        domain={"size": [2.0, 12.0]},
        boundaries={"bottom": "quiet"},
        time={"duration": 0.012},
        record={"points": [[1.0, 2.1], [1.0, 10.1]], "interval": 5e-5},
        numerics={"dem": {"block": 0.5}, "continuum": {"size": 0.5}},
    )
    tables["joint_sets"][0] |= {"dip": 0.0, "through": [1.0, 6.0]}
    return tables


@pytest.mark.parametrize("solver", ["dem", "continuum-jointed"])
@pytest.mark.parametrize("kind, moved", [("P", [0.0, 1.0]), ("S", [-1.0, 0.0])])
def test_a_compliant_base_is_a_wave_that_enters_upwards(strip, solver, kind, moved):
    """The wave enters by its field beneath the joint and the free surface, known at samples h apart
    to h^4 / 384 of a fourth derivative, for a Ricker wavelet at most 60 (pi / T)^4 of its peak,
    which the surface doubles. Elements take it at the middle of a step, too: 6 (pi / T)^2 dt^2 / 24
    off, doubled."""
    pulse = {"shape": "ricker", "period": 2e-3, "amplitude": PEAK, "quantity": "velocity"}
    wave = {"waves": [pulse | {"kind": kind, "direction": [0.0, 1.0]}]}
    base = {"loads": [pulse | {"kind": "base", "side": "bottom", "direction": moved}], "waves": []}
    one, other = (solve(solver, load_tables(strip | action)) for action in (wave, base))
    off = 2 * 60 * (np.pi * 5e-5 / 2e-3) ** 4 / 384
    if solver != "dem":
        off += 2 * (np.pi * one.attrs["dt"] / 2e-3) ** 2 / 4
    assert np.abs(one.velocity).max() > PEAK / 2
    assert np.abs(one.velocity - other.velocity).max() < off * PEAK
