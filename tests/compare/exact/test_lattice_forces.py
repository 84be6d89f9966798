"""Gravity, prestress, mass-proportional damping and shaken bases of the axial chains."""

import numpy as np
import pytest

from closed_forms import leapfrog
from jointwave.cases.histories import Integrated, Recorded
from jointwave.cases.material.calibrate import calibrate
from jointwave.compare.exact.blocks import row_of_blocks
from jointwave.compare.exact.blocks.pillar import system_of
from jointwave.compare.exact.linear import twins

FIELDS = ("stress", "velocity", "displacement")
DOWN = {"direction": [0.0, 1.0, 0.0]}
STILL = {"load": {"amplitude": 0.0}, "time": {"duration": 0.01}}
RECORD = {"stress": [0.0, 1.0, 20.0, 50.0], "velocity": [0.25, 20.25, 49.75]}
BARRED = {"joints": {"tension": False}}


def test_a_column_carries_its_own_weight(scene):
    """rho g y in every section; a block sinks by what the joints below it close, and the half
    block of intact rock at the wall: g rho S^2 (sum_{j = i}^{N - 1} j / E_eq + N / 2 E). Two
    solves, condition 1e4: 1e-11."""
    at = scene(**STILL, gravity=DOWN, ends={"end": "fixed"}, record=RECORD)
    p, result = calibrate(at), row_of_blocks.solve(at)
    weight = 2400 * 9.81 * np.array(RECORD["stress"])
    assert np.allclose(result.stress.values, weight[:, None], rtol=1e-11, atol=1e-5)
    below = np.array([sum(range(i, 100)) for i in (1, 41, 100)])
    sunk = 9.81 * 2400 * 0.25 * (below / p.modulus + 50 / 8.64e10)
    assert np.allclose(result.displacement.values[..., 0], sunk[:, None], rtol=1e-11)


def test_the_static_state_adds_to_what_the_load_does(scene, misfit):
    common = {"ends": {"start": "quiet", "end": "fixed"}, "record": RECORD}
    pressed = {"prestress": {"normal": 2e5}}
    both = row_of_blocks.solve(scene(**common, gravity=DOWN, **pressed))
    load = row_of_blocks.solve(scene(**common, **pressed))
    rest = row_of_blocks.solve(scene(**common, gravity=DOWN, load={"amplitude": 0.0}))
    for variable in FIELDS:
        assert misfit(both[variable], load[variable] + rest[variable]) < 1e-12


@pytest.mark.parametrize("ends", [("free", "fixed"), ("fixed", "quiet"), ("free", "matched")])
def test_a_prestressed_row_stands_still_where_displacement_counts_from(scene, ends):
    """Its own state is the origin of displacement, and its stress is the prestress."""
    at = scene(
        **STILL | {"load": {"amplitude": 0.0}},
        prestress={"normal": 2e5},
        ends={"start": ends[0], "end": ends[1]},
        record=RECORD,
    )
    result = row_of_blocks.solve(at)
    assert not result.displacement.any()
    assert np.allclose(result.stress, 2e5, rtol=1e-12)


@pytest.mark.parametrize("joints", [{}, {"tension": False}])
def test_an_accelerated_base_is_gravity_in_its_own_frame(scene, misfit, joints):
    """With a from t = 0 the strains are those of a sudden weight -m a, which presses the joints
    until the echo of the free end is back, at L/c = 37 ms. Lattice: round-off of displacements; no
    tension: 1e-9 a step, gathered."""
    common = {
        "joints": {"damping_ratio": 0.05} | joints,
        "ends": {"start": "fixed"},
        "time": {"duration": 0.03},
        "record": RECORD | {"interval": 1e-4},
    }
    step = {"shape": "step", "period": None}
    motion = step | {"quantity": "acceleration", "amplitude": 7.0}
    shaken = row_of_blocks.solve(scene(**common, load=motion))
    gravity = {"direction": [0.0, -1.0, 0.0], "acceleration": 7.0, "static": False}
    heavy = row_of_blocks.solve(
        scene(
            **common | {"joints": {"damping_ratio": 0.05}},
            load=step | {"amplitude": 0.0},
            gravity=gravity,
        )
    )
    way = 7.0 * heavy.time.values**2 / 2
    bound = 1e-6 if joints else 1e-10
    assert misfit(shaken.stress, heavy.stress) < bound
    assert misfit(shaken.displacement[..., 0], heavy.displacement[..., 0] + way) < bound


def test_a_base_s_acceleration_is_the_velocity_that_it_integrates_to(scene, misfit):
    """A step of acceleration for 5 ms, then none, is a ramp of velocity, then a constant one."""
    common = {"ends": {"start": "fixed", "end": "matched"}, "time": {"duration": 0.02}}
    pulse = Recorded(np.array([0.0, 0.005]), np.array([7.0, 7.0]))
    ramp = Recorded(np.array([0.0, 0.005, 1.0]), np.array([0.0, 0.035, 0.035]))
    at = scene(**common, load={"quantity": "acceleration"})
    model, times = system_of(at), np.linspace(0, 0.02, 101)
    one, other = (twins(model.matrix, model.load, f, times)[0] for f in (Integrated(pulse), ramp))
    assert misfit(one, other) < 1e-12


def test_mass_proportional_damping_damps_each_mode_by_alpha_over_two_omega(scene):
    """lambda^2 + (alpha + eta omega_n^2) lambda + omega_n^2 = 0; 0 and -alpha if rigid."""
    at = scene(joints={"damping_ratio": 0.02}, damping={"mass_proportional": 50.0})
    p = calibrate(at)
    omega = leapfrog.frequencies(p.regular_stiffness * p.area, p.block_mass, 100)
    roots = np.linalg.eigvals(system_of(at).matrix.toarray())
    found = np.sort(roots[roots.imag > 1].imag)
    rate = (50.0 + p.time_constant * omega[1:] ** 2) / 2
    assert np.abs(found / np.sort(np.sqrt(omega[1:] ** 2 - rate**2)) - 1).max() < 1e-9
    decay = np.sort(-roots.real[roots.imag > 1])
    assert np.abs(decay / np.sort(rate) - 1).max() < 1e-7
    assert np.abs(roots + 50.0).min() < 1e-6


def test_rayleigh_damping_has_its_ratios_at_its_frequencies(scene):
    """zeta = alpha / 2 omega + eta omega / 2 with the two parts that the scene is given."""
    at = scene(damping={"rayleigh": {"frequencies": [20.0, 200.0], "ratios": [0.05, 0.02]}})
    p = calibrate(at)
    for f, zeta in ((20.0, 0.05), (200.0, 0.02)):
        w = 2 * np.pi * f
        found = p.mass_damping / (2 * w) + p.time_constant * w / 2
        assert found == pytest.approx(zeta, rel=1e-12)


@pytest.mark.parametrize("end", ["free", "quiet", "matched", "fixed"])
def test_joints_pressed_beyond_the_wave_s_tension_are_the_lattice_s(scene, misfit, end):
    """1 MPa and its echoes, at most twice as large, never open joints under 3 MPa."""
    common = {
        "ends": {"start": "free" if end == "free" else "quiet", "end": end},
        "prestress": {"normal": 3e6},
        "gravity": DOWN | {"static": end == "fixed"},
        "time": {"duration": 0.06},
        "record": RECORD,
    }
    a = row_of_blocks.solve(scene(**common, **BARRED))
    b = row_of_blocks.solve(scene(**common))
    assert max(misfit(a[variable], b[variable]) for variable in FIELDS) < 1e-6


def test_prestress_delays_opening_until_the_tension_exceeds_it(scene):
    """At the first joint, which the wave pulls before any other: linear until it opens."""
    common = {"time": {"duration": 0.008}, "record": {"stress": [0.5], "velocity": []}}
    at = scene(**common, **BARRED, prestress={"normal": 2e5})
    pressed = row_of_blocks.solve(at).stress.values[0]
    linear = row_of_blocks.solve(scene(**common)).stress.values[0] + 2e5
    opens = int(np.argmax(linear <= 0))
    assert pressed.min() == 0 and linear.min() < -5e5
    assert np.abs(pressed - linear)[:opens].max() < 1e-6 * 1e6


@pytest.mark.parametrize(
    "tables", [{"prestress": {"normal": -1.0}}, {"gravity": {"direction": [0.0, -1.0, 0.0]}}]
)
def test_joints_that_bar_tension_are_not_pulled_at_rest(scene, tables):
    answer = row_of_blocks.applies_without_tension(scene(**BARRED, ends={"end": "fixed"}, **tables))
    assert answer.reason == "a no-tension joint is in tension at rest"


def test_a_load_against_the_axis_pulls(scene, misfit):
    there = row_of_blocks.solve(scene())
    back = row_of_blocks.solve(scene(load={"direction": [0.0, -1.0, 0.0]}))
    assert misfit(back.stress, -there.stress) == 0
