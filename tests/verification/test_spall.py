"""A pulse that comes back from a free end as tension and tears deformable jointed rock apart."""

import numpy as np
import pytest

from closed_forms.jointed_spall import jointed_spall
from closed_forms.spall import spall
from jointwave import cases, continuum
from jointwave.cases.loads import load_history
from jointwave.cases.material.calibrate import calibrate
from jointwave.cases.sampling import clock
from jointwave.compare.scenes import SHIPPED
from jointwave.continuum.build import build_model, critical_step_of, discretise
from jointwave.continuum.explicit.march import march
from jointwave.continuum.state import empty_samples, state_at_rest
from jointwave.results.dataset import energy_residual

SAW_TOOTH = SHIPPED / "beyond" / "spall.toml"


@pytest.fixture
def saw_tooth():
    """The shipped scene in deformable blocks."""
    return cases.load_variant(SAW_TOOTH, "", {"rock.intact_modulus": 8.64e10, "variants": []})


def first_break(scene, after):
    """Return the joints (int array) and the time (s) of the first step at which any of them is
    open beyond where it reaches its strength; none before `after` (s)."""
    discrete = discretise(scene, "jointed", 1)
    critical = critical_step_of(scene, discrete, "jointed")
    time = clock(scene, critical, 0.5, False, "continuum")
    model = build_model(scene, discrete, "jointed", time)
    state = state_at_rest(model, keep_ledger=True)
    samples = empty_samples(model, state, time.samples)
    law, start = model.interfaces.law, int(after / time.dt)
    limit = law.tensile_strength / law.normal_stiffness
    steps = march(model, state, samples, time.stride, None)
    steps(0, start)
    assert (state.opening <= limit).all()
    for n in range(start, time.steps):
        steps(n, n + 1)
        broken = np.flatnonzero(state.opening > limit)
        if broken.size:
            return discrete.jumps.joint[broken], n * time.dt
    raise AssertionError("nothing breaks")


@pytest.mark.parametrize("strength", [5e5, 6e5, 8e5])  # the wave's own tension is 4.5e5
@pytest.mark.parametrize("period", [0.02, 0.03])
def test_a_smooth_pulse_breaks_the_joint_beside_the_bars_place(pillar, period, strength):
    """The exact jointed bar names the joint, and its time to a sample; the homogenised bar's place
    is within one joint spacing.

    The matched start takes half of the load; two joints can fail in one step. The wavelet is 54 or
    80 blocks long, so that the dispersion of the jointed rock, (k d)^2 / 24 of the way, is below
    one joint spacing.
    """
    p = calibrate(pillar())
    least = strength**2 / (2 * p.regular_stiffness)
    scene = pillar(
        load={"shape": "ricker", "amplitude": 2e6, "period": period},
        ends__start="matched",
        joints={"tensile_strength": strength, "fracture_energy": 1.001 * least},
        time__duration=0.12,
        record__interval=2e-5,
    )
    bar = spall(load_history(scene), 2 * strength, 50.0, p.bar_speed, 0.12)
    exact = jointed_spall(scene)
    joints, time = first_break(scene, bar.time - 2e-3)
    distance = 50.0 - p.joint_y[joints]
    assert np.abs(distance - exact.distance).min() < 1e-9
    assert abs(time - exact.time) <= scene.interval
    assert np.abs(distance - bar.distance).max() <= p.spacing


def test_a_saw_tooth_breaks_the_jointed_bars_joint(saw_tooth):
    """Its front rises within five blocks, and the ripples that jointed rock trails behind it break
    a joint nearer to the end than the homogenised bar would; the exact jointed bar knows which."""
    exact = jointed_spall(saw_tooth)
    joints, time = first_break(saw_tooth, exact.time - 2e-3)
    assert 20.0 - calibrate(saw_tooth).joint_y[joints] == pytest.approx([exact.distance])
    assert abs(time - exact.time) <= saw_tooth.interval


def test_the_ledger_of_the_saw_tooth_closes(saw_tooth):
    """Within 1e-6 of the work, where 1e-4 is promised: a joint that reaches its strength or breaks
    between two steps costs an energy of second order in the step."""
    result = continuum.simulate(saw_tooth, "jointed", dim=1)
    spent = result.energy.sel(term="fracture").values
    assert spent[-1] > 0.01 * float(result.energy.sel(term="work").max())
    assert (np.diff(spent) >= 0).all()
    assert energy_residual(result) < 1e-6
