"""A pulse that comes back from a free end as tension and tears deformable jointed rock apart."""

import numpy as np
import pytest

from closed_forms.spall import jointed_spall, spall
from jointwave import cases, continuum
from jointwave.cases.loads import load_history
from jointwave.cases.material.calibrate import calibrate
from jointwave.compare.scenes import SHIPPED
from jointwave.continuum.plan import plan_of
from jointwave.continuum.problem import in_time
from jointwave.continuum.stepping.leapfrog import Leapfrog
from jointwave.results.dataset import energy_residual

EXPLICIT = {"numerics.continuum.scheme": "explicit", "numerics.continuum.step_fraction": 0.5}


def first_break(scene, after):
    """Return the joints (int array) and the time (s) of the first step at which any of them is
    open beyond where it reaches its strength; none before `after` (s)."""
    _, problem, choice, _ = plan_of(scene, "jointed", dim=1)
    own, dt = in_time(scene, problem, choice.time, None, "jointed"), choice.time.dt
    steps, start = Leapfrog(own, dt, 1), int(after / choice.time.dt)
    joints = problem.body.joints
    limit = problem.law.tensile_strength / problem.law.normal_stiffness

    def broken():
        return np.flatnonzero(joints.jumps(steps.last[0]) > limit)

    steps.take(0, start, choice.time.steps)
    assert not broken().size
    for n in range(start, choice.time.steps):
        steps.take(n, n + 1, choice.time.steps)
        if broken().size:
            return joints.column[broken()], n * dt
    raise AssertionError("nothing breaks")


# The wave's own tension is 4.5e5 Pa.
@pytest.mark.parametrize(("period", "strength"), [(0.02, 5e5), (0.03, 6e5), (0.02, 8e5)])
def test_a_smooth_pulse_breaks_the_joint_beside_the_bars_place(pillar, period, strength):
    """The exact jointed bar names the joint, and its time to a sample; the homogenised bar's place
    is within one joint spacing. The matched start takes half of the load; two joints can fail in
    one step. The wavelet is 54 or 80 blocks long, so that the dispersion of the jointed rock, (k
    d)^2 / 24 of the way, is below one joint spacing."""
    p = calibrate(pillar())
    least = strength**2 / (2 * p.regular_stiffness)
    scene = pillar(
        load={"shape": "ricker", "amplitude": 2e6, "period": period},
        ends__start="matched",
        joints={"tensile_strength": strength, "fracture_energy": 1.001 * least},
        time__duration=0.12,
        record__interval=2e-5,
        **EXPLICIT,
    )
    bar = spall(load_history(scene), 2 * strength, 50.0, p.bar_speed, 0.12)
    exact = jointed_spall(scene)
    joints, time = first_break(scene, bar.time - 2e-3)
    distance = 50.0 - p.joint_y[joints]
    assert np.abs(distance - exact.distance).min() < 1e-9
    assert abs(time - exact.time) <= scene.interval
    assert np.abs(distance - bar.distance).max() <= p.spacing


def test_a_saw_tooth_breaks_the_jointed_bars_joint():
    """Its front rises within five blocks, and the ripples that jointed rock trails behind it break
    a joint nearer to the end than the homogenised bar would; the exact jointed bar knows which. The
    ledger closes within 1e-6 of the work, where 1e-4 is promised: a joint that reaches its strength
    or breaks between two steps costs an energy of second order in the step."""
    keys = {"rock.intact_modulus": 8.64e10, "variants": [], **EXPLICIT}
    scene = cases.load_variant(SHIPPED / "beyond" / "spall.toml", "", keys)
    exact = jointed_spall(scene)
    joints, time = first_break(scene, exact.time - 2e-3)
    assert 20.0 - calibrate(scene).joint_y[joints] == pytest.approx([exact.distance])
    assert abs(time - exact.time) <= scene.interval
    result = continuum.simulate(scene, "jointed", dim=1)
    spent = result.energy.sel(term="fracture").values
    assert spent[-1] > 0.01 * float(result.energy.sel(term="work").max())
    assert (np.diff(spent) >= 0).all()
    assert energy_residual(result) < 1e-6
