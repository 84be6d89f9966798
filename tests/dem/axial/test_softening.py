"""Joints that break: what it costs, where and when it happens."""

import pytest

from jointwave import dem
from jointwave.cases.material.calibrate import calibrate
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


def test_strong_joints_leave_the_linear_chain(pillar):
    """A strength that the wave never reaches changes nothing, and nothing is spent."""
    strong = dem.simulate(
        pillar(joints={"tensile_strength": 2.0e6, "fracture_energy": 500.0}, ends__end="quiet")
    )
    linear = dem.simulate(pillar(ends__end="quiet"))
    assert (strong.stress.values == linear.stress.values).all()
    assert not strong.energy.sel(term="fracture").values.any()
    assert energy_residual(strong) < 1e-10
