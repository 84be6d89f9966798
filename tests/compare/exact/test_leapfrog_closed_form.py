"""The closed form of leapfrog against leapfrog itself, the lattice, and the bar at c dt = d."""

import numpy as np
import pytest

from closed_forms import leapfrog
from jointwave.cases.loads import load_history, step_means
from jointwave.cases.material.calibrate import calibrate
from jointwave.compare.exact.bar import images
from jointwave.compare.exact.blocks import row_of_blocks


def stepped(force, dt, k, m, count):
    """Return the displacements [steps + 1, count] of leapfrog, step by step."""
    u, v, out = np.zeros(count), np.zeros(count), [np.zeros(count)]
    for F in force:
        contact = np.concatenate([[F], -k * np.diff(u), [0.0]])
        v += dt / m * (contact[:-1] - contact[1:])
        u = u + dt * v
        out.append(u)
    return np.array(out)


@pytest.mark.parametrize("fraction", [0.05, 0.5, np.sin(99 * np.pi / 200)])
def test_ten_thousand_steps_agree_to_round_off(fraction):
    """Both gather round-off: a phase of 1e4 steps is known to 1e4 eps, about 2e-12. The last
    fraction of the critical step is c dt = d."""
    k, m, rng = 2.2e9, 300.0, np.random.default_rng(1)
    dt = fraction * 2 / leapfrog.frequencies(k, m, 100).max()
    force = rng.standard_normal(10_000)
    steps = np.array([1, 2, 17, 5000, 10_000])
    found = leapfrog.displacements(force, steps, dt, k, m, 100)
    expected = stepped(force, dt, k, m, 100)[steps].T
    assert np.linalg.norm(found - expected) / np.linalg.norm(expected) < 1e-11


def test_a_step_above_the_critical_one_is_refused():
    with pytest.raises(ValueError, match="must be below the critical"):
        leapfrog.displacements(np.ones(3), np.array([3]), 2.1, 1.0, 1.0, 100)


def test_it_converges_to_the_lattice_at_order_two(scene):
    """The load sampled at the steps and the central difference are both of second order."""
    centres = [0.25, 19.75, 49.75]
    at = scene(time={"duration": 0.04}, record={"velocity": centres, "interval": 0.005})
    p, exact = calibrate(at), row_of_blocks.solve(at).displacement.values[..., 0]
    errors = []
    for count in (2000, 4000, 8000):
        dt = 0.04 / count
        force = load_history(at).value(dt * np.arange(count)) * p.area
        steps = np.arange(9) * count // 8
        k, m = p.regular_stiffness * p.area, p.block_mass
        u = leapfrog.displacements(force, steps, dt, k, m, 100)[[0, 39, 99]]
        errors.append(np.linalg.norm(u - exact))
    assert np.log2(np.divide(errors[:-1], errors[1:])) == pytest.approx([2, 2], abs=0.01)


def test_at_c_dt_equal_d_it_is_the_bar_at_the_block_centres(scene):
    """Exact to round-off if the load enters as its mean over the step, 3e-3 if sampled."""
    at = scene()
    p, load = calibrate(at), load_history(at)
    dt, steps = p.spacing / p.bar_speed, np.arange(324)
    centres = 0.5 * np.arange(100) + 0.25
    there, back = images.images(load.impulse, centres, dt * steps, 50.0, p.bar_speed)
    bar = (there - back) / p.impedance
    errors = []
    for stress in (step_means(load, dt, 324), load.value(dt * steps)):
        k, m = p.regular_stiffness * p.area, p.block_mass
        u = leapfrog.displacements(stress * p.area, steps, dt, k, m, 100)
        errors.append(np.linalg.norm(u - bar) / np.linalg.norm(bar))
    assert errors[0] < 1e-12
    assert 1e-4 < errors[1] < 1e-2
