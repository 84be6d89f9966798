"""Joints that break: what it costs, where and when it happens."""

import numpy as np
import pytest

from closed_forms.spall import lattice_spall
from jointwave import dem
from jointwave.cases.material.calibrate import calibrate
from jointwave.dem.axial.build import build
from jointwave.dem.axial.leapfrog import make_stepper, march
from jointwave.dem.axial.samples import buffers, terms
from jointwave.results.dataset import energy_residual

STRENGTH, ENERGY = 1e6, 500.0  # Pa, J/m2


def pulled(pillar, **changes):
    """Return two blocks whose outer walls are pulled apart at 0.02 m/s, past the break."""
    return pillar(
        pillar__length=1.0,
        ends={"start": "fixed", "end": "fixed"},
        load={"shape": "step", "amplitude": 0.02, "quantity": "velocity", "direction": [0, -1, 0]},
        joints={"tensile_strength": STRENGTH, "fracture_energy": ENERGY, **changes},
        record={"stress": [0.5], "interval": 1e-4},
    )


def test_breaking_a_joint_takes_its_fracture_energy(pillar):
    """G_c A by what the pull puts in and nothing else holds, within 1e-6, and never above s_t."""
    scene = pulled(pillar)
    result = dem.simulate(scene)
    last = result.energy[:, -1] - result.energy[:, 0]
    others = sum(float(last.sel(term=k)) for k in ("kinetic", "elastic", "viscous", "boundary"))
    spent = ENERGY * calibrate(scene).area
    assert float(last.sel(term="work")) - others == pytest.approx(spent, rel=1e-6)
    assert float(last.sel(term="fracture")) == pytest.approx(spent, rel=1e-12)
    assert result.stress.values.min() >= -STRENGTH * (1 + 1e-12)
    assert result.stress.values[0, -1] == 0.0


@pytest.mark.parametrize("ratio", [None, 0.05])
def test_ledger_closes_but_for_the_corners_of_the_law(pillar, ratio):
    """The trapezoid is exact along straight lines; each corner inside a step costs a little.

    A corner that changes the slope by at most K + K_soft, passed in a step of the gap delta, is
    cut by at most (K + K_soft) delta^2 / 8 per unit area: the chord under two lines. Corners are
    at zero gap, at the strength, at the break and where a joint comes back to its largest opening.
    """
    changes = {} if ratio is None else {"damping_ratio": ratio}
    scene = pillar(joints={"tensile_strength": STRENGTH / 2, "fracture_energy": 50.0, **changes})
    model, state, time, _ = build(scene)
    samples, gaps = buffers(model, state, time.steps), np.zeros((time.steps, len(state.opening)))
    take = make_stepper(model, state, samples, 1)
    for n in range(time.steps):
        gaps[n] = np.diff(state.u)
        take(n, n + 1)
    kinetic, elastic, viscous, fracture, boundary, work = samples.energy
    lost = np.abs(kinetic + elastic + viscous + fracture + boundary - work).max()
    assert terms(model.effects) == ("kinetic", "elastic", "viscous", "fracture", "boundary", "work")
    assert fracture[-1] > 0.02 * work.max() and (state.broke >= 0).any()
    assert lost <= corner_cost(calibrate(scene), gaps) + 1e-10 * work.max()


def corner_cost(p, gaps):
    """Return the sum over joints and steps of A (K + K_soft) delta^2 / 8 for each corner passed."""
    largest = np.maximum.accumulate(np.maximum(gaps, 0.0))[:-1]
    first, last = p.tensile_strength / p.stiffness, p.critical_opening
    steepest = p.stiffness + p.tensile_strength / (last - first)
    low, high = np.minimum(gaps[1:], gaps[:-1]), np.maximum(gaps[1:], gaps[:-1])
    corners = (0.0, first, last, np.maximum(largest, first))
    passed = sum(((low < corner) & (corner < high)).astype(int) for corner in corners)
    return float((p.area * steepest / 8 * (high - low) ** 2 * passed).sum())


@pytest.mark.parametrize("shape", ["sine", "ricker"])
def test_first_break_is_where_the_exact_chain_says(pillar, shape):
    """A brittle joint breaks where the linear chain's tension first reaches the strength.

    The pulse returns from the free end in tension. The opening from w_0 to w_c = 1.001 w_0 and the
    step that notices it come on top of the time.
    """
    probe = pillar()
    least = (STRENGTH / 2) ** 2 / (2 * calibrate(probe).regular_stiffness)
    scene = pillar(
        load={"shape": shape, "amplitude": 1e6, "period": 0.01},
        joints={"tensile_strength": STRENGTH / 2, "fracture_energy": 1.001 * least},
        time__duration=0.08,
    )
    expected = lattice_spall(scene)
    model, state, time, _ = build(scene)
    march(model, state, 0, time.steps)
    broken = np.flatnonzero(state.broke >= 0)
    first = broken[np.argmin(state.broke[broken])]
    p = calibrate(scene)
    assert p.spacing * p.block_count - p.joint_y[first] == pytest.approx(expected.distance)
    assert state.broke[first] * time.dt == pytest.approx(expected.time, abs=3 * time.dt)


def test_strong_joints_leave_the_linear_chain(pillar):
    """A strength that the wave never reaches changes nothing, and nothing is spent."""
    strong = dem.simulate(
        pillar(joints={"tensile_strength": 2.0e6, "fracture_energy": 500.0}, ends__end="quiet")
    )
    linear = dem.simulate(pillar(ends__end="quiet"))
    assert (strong.stress.values == linear.stress.values).all()
    assert not strong.energy.sel(term="fracture").values.any()
    assert energy_residual(strong) < 1e-10
