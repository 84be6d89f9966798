"""The no-tension chain against the lattice while nothing opens, and the contact's closed form."""

from math import pi

import numpy as np
import pytest

from closed_forms import opening_joint
from jointwave.cases.histories import Recorded, Sine
from jointwave.cases.loads import load_history
from jointwave.cases.material.calibrate import calibrate
from jointwave.cases.sampling import sample_times
from jointwave.compare.exact.blocks import row_of_blocks
from jointwave.compare.exact.blocks.events import integrate
from jointwave.compare.exact.blocks.pillar import system_of
from jointwave.compare.exact.blocks.row_of_blocks import receivers

FIELDS = ("stress", "velocity", "displacement")


@pytest.mark.parametrize("end", ["free", "quiet", "matched", "fixed"])
def test_with_tension_it_is_the_lattice(scene, misfit, soft, end):
    """One model, two solvers, each to the round-off of some hundred steps."""
    at = scene(
        soft_layers=soft,
        joints={"damping_ratio": 0.05},
        ends={"start": "quiet", "end": end},
        time={"duration": 0.08},  # beyond the end's echo
    )
    model, times = system_of(at), sample_times(at)
    states = integrate(model, load_history(at), times, at.load.period).states
    a, b = receivers(at, model, states), row_of_blocks.solve(at)
    assert max(misfit(a[name], b[name].values.reshape(a[name].shape)) for name in FIELDS) < 1e-11


def test_joints_that_are_only_compressed_are_the_lattice_s(scene, misfit):
    """Half a sine of pressure, read before anything turns to tension."""
    tables = {"time": {"duration": 5e-3}, "record": {"stress": [1.0], "velocity": [0.25]}}
    barred = row_of_blocks.solve(scene(joints={"tension": False}, **tables))
    linear = row_of_blocks.solve(scene(**tables))
    assert linear.stress.min() >= 0
    assert max(misfit(barred, linear, variable) for variable in FIELDS) < 1e-11


@pytest.mark.parametrize("zeta", [None, 0.05])
def test_barred_joints_never_pull_and_pass_nothing_while_open(scene, zeta):
    points = [19.75, 20.25]
    at = scene(
        joints={"tension": False} | ({} if zeta is None else {"damping_ratio": zeta}),
        time={"duration": 0.03},
        record={"velocity": points},
    )
    result = row_of_blocks.solve(at)
    stress, u = result.stress.values[0], result.displacement.values[..., 0]
    gap = u[1] - u[0]
    assert stress.min() == 0
    assert stress.max() > 0.5e6
    assert (stress[gap > 0] == 0).all()
    assert (gap > 0).sum() > 100
    if zeta is None:
        closed = gap < 0
        assert np.allclose(stress[closed], -calibrate(at).regular_stiffness * gap[closed])


def test_momentum_is_the_load_s_impulse_between_free_ends(scene):
    at = scene(joints={"tension": False}, time={"duration": 0.03})
    model, load, times = system_of(at), load_history(at), sample_times(at)
    velocity = integrate(model, load, times).states @ model.velocity.T
    momentum = calibrate(at).block_mass * velocity.sum(axis=1)
    impulse = load.impulse(times) * at.pillar.area
    assert np.abs(momentum - impulse).max() < 1e-12 * impulse.max()


def test_the_contact_passes_the_compressive_half_and_stays_open():
    """One cycle: the gap ends at 2 p0 T / (pi Z), what the tensile half cycle moves at 2 v_I."""
    load, times, Z = Sine(1e6, 0.01), np.linspace(0, 0.02, 2001), 3e6
    passed, first = opening_joint.transmitted(load, times), times <= 0.005
    assert np.array_equal(passed[first], load.value(times[first]))
    assert not passed[~first].any()
    assert opening_joint.gap(load, times, Z)[-1] == pytest.approx(
        2 * 1e6 * 0.01 / (pi * Z), rel=1e-12
    )


def test_the_gap_grows_at_twice_the_incident_velocity():
    load, times, Z = Sine(1e6, 0.01, cycles=2), np.linspace(0, 0.02, 20_001), 3e6
    gap = opening_joint.gap(load, times, Z)
    rate, opened = np.gradient(gap, times), (times > 0.0051) & (times < 0.0149)
    assert np.allclose(rate[opened], -2 * load.value(times[opened]) / Z, atol=1e-6 * 2e6 / Z)
    assert gap[times == 0.015] == pytest.approx(0, abs=1e-12)


def test_it_closes_when_the_gap_is_back_at_zero():
    """A trough of area 1e3 Pa s, then a crest of 4e3: closed once a quarter of the crest is in."""
    load = Recorded(np.array([0, 1e-3, 2e-3, 6e-3]), np.array([0, -1e6, 0, 0]))
    crest = Recorded(np.array([0, 1e-3, 2e-3, 4e-3, 6e-3]), np.array([0, -1e6, 0, 2e6, 0]))
    times = np.linspace(0, 8e-3, 8001)
    assert not opening_joint.transmitted(load, times).any()
    passed = opening_joint.transmitted(crest, times)
    closes = times[np.flatnonzero(passed)[0]]
    assert closes == pytest.approx(2e-3 + np.sqrt(2 * 1e3 / 1e9), abs=2e-6)
    late = times > closes
    assert np.allclose(passed[late], crest.value(times[late]))


@pytest.mark.parametrize("block", [1.0, 0.5, 0.25])
def test_one_barred_joint_of_the_chain_opens_as_the_contact_does(scene, block):
    """The incident pulse is half the load (matched start). The chain's dispersion, a lag of
    (omega d/c)^2 / 24 of the phase omega y/c gathered on the way, bounds what the gap is off."""
    at = scene(
        pillar={"block": block},
        soft_layers=[{"y": 25.0, "tension": False}],
        load={"period": 0.02},
        ends={"start": "matched", "end": "matched"},
        time={"duration": 0.06},
        record={"velocity": [25.0 - block / 2, 25.0 + block / 2]},
    )
    p, u = calibrate(at), row_of_blocks.solve(at).displacement.values[..., 0]
    gap = 2 * 0.5 * 1e6 * 0.02 / (pi * p.impedance)
    omega = 2 * pi / 0.02
    lag = (omega * block / p.bar_speed) ** 2 / 24 * omega * 25.0 / p.bar_speed
    assert abs((u[1, -1] - u[0, -1]) / gap - 1) < lag


def test_a_chain_of_several_rocks_that_stays_closed_is_the_linear_one(scene, misfit):
    """Under a prestress that no wave lifts; blocks of two masses."""
    rock = {"density": 2000.0, "p_speed": 1500.0, "s_speed": 600.0}
    tables = {
        "segments": [{"y": [20.0, 35.0], **rock}],
        "prestress": {"normal": 5e6},
        "time": {"duration": 0.05},
    }
    linear = row_of_blocks.solve(scene(**tables))
    found = row_of_blocks.solve(scene(**tables, joints={"tension": False}))
    for variable in ("stress", "velocity", "displacement"):
        assert misfit(found, linear, variable) < 1e-11
