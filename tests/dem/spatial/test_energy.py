"""The energy ledger closes: nothing appears, nothing is lost."""

import numpy as np
import pytest

from jointwave import dem
from jointwave.results.dataset import energy_residual, imbalance

DOWN = {"direction": [0.6, 0.8, 0.0]}
SOFT = [{"y": 3.0, "spacing_stiffness": 4e8, "shear_stiffness": 5e8, "damping_ratio": 0.1}]
SHAKEN = {
    "shape": "sine",
    "amplitude": 0.1,
    "period": 0.01,
    "quantity": "velocity",
    "direction": [0.48, 0.6, -0.64],
}
SLIP = {"friction_angle": 20.0, "cohesion": 1e4}
BREAK = {**SLIP, "tensile_strength": 5e4, "fracture_energy": 1.0}
LINEAR = {
    "free": {},
    "large step": {"numerics__dem__step_fraction": 0.9},
    "quiet, matched, dashpots": {
        "ends": {"start": "quiet", "end": "matched"},
        "joints__damping_ratio": 0.05,
    },
    "soft layer, mass damping": {
        "soft_layers": SOFT,
        "ends": {"start": "matched", "end": "quiet"},
        "joints__damping_ratio": 0.02,
        "damping__mass_proportional": 50.0,
    },
    "shaken base": {
        "ends": {"start": "fixed", "end": "matched"},
        "load": SHAKEN,
        "joints__damping_ratio": 0.05,
    },
    "all": {
        "ends": {"start": "quiet", "end": "fixed"},
        "soft_layers": SOFT,
        "joints__damping_ratio": 0.05,
        "damping__mass_proportional": 30.0,
        "gravity": {**DOWN, "static": False},
        "prestress": {"normal": 1e5},
    },
    "static gravity": {
        "ends__end": "fixed",
        "joints__damping_ratio": 0.05,
        "gravity": DOWN,
    },
    "local damping": {"damping__local": 0.3},
    "slip": {"joints": SLIP},
    "slip, dashpots, prestress": {
        "joints": {**SLIP, "damping_ratio": 0.05},
        "prestress": {"normal": 1e5},
        "ends": {"start": "quiet", "end": "matched"},
    },
}


@pytest.mark.parametrize("changes", LINEAR.values(), ids=LINEAR)
def test_ledger_closes_to_round_off(row, changes):
    """Below 1e-10 of the work, in the form of the energy that leapfrog conserves at any step.

    Friction books the mean of the spring force before and after the step, which closes as well.
    """
    result = dem.simulate(row(**changes))
    assert energy_residual(result) < 1e-10
    for term in ("viscous", "friction"):
        if term in result.term:
            never_falls(result.energy.sel(term=term).values)


def never_falls(energy):
    assert energy[-1] >= 0 and np.diff(energy).min() >= -1e-12 * np.abs(energy).max()


@pytest.mark.parametrize(
    "joints",
    [
        {"joints": {"tension": False}},
        pytest.param({"joints": {"tension": False, **SLIP}}, marks=pytest.mark.slow),
        {"joints": BREAK},
        pytest.param(
            {"soft_layers": [{"y": 3.0, "residual_cohesion": 1e3, **BREAK}]},
            marks=pytest.mark.slow,
        ),
    ],
    ids=["no tension", "no tension, slip", "softening", "one joint that softens"],
)
def test_ledger_closes_but_for_the_corners_of_the_law(row, at_rest, joints):
    """The trapezoid is exact along straight lines; each corner inside a step costs a little.

    At a point of area A a corner that changes the slope by at most K + K_soft, passed in a step of
    the gap delta, is cut by at most A (K + K_soft) delta^2 / 8: the chord under two lines.
    """
    blocks = at_rest(row(**joints, load__amplitude=2e5, record__interval=1e-5))
    steps, breaks = blocks.time.samples, blocks.p.tensile_strength is not None
    assert blocks.time.stride == 1
    gaps = []
    for n in range(steps):
        gaps.append(blocks.gaps())
        blocks.take(n, n + 1)
    terms = ["kinetic", "rotation", "elastic", "viscous", "friction"]
    terms += ["fracture"] * breaks + ["boundary", "work"]
    energy = dict(zip(terms, blocks.energy(terms, steps), strict=True))
    lost = imbalance(blocks.energy(terms, steps), terms) * energy["work"].max()
    bound = corner_cost(blocks, np.array(gaps)) + 1e-10 * energy["work"].max()
    assert lost <= bound
    never_falls(energy["friction"])
    if breaks:
        never_falls(energy["fracture"])
        assert energy["fracture"][-1] > 1e-3 * energy["work"].max()


def corner_cost(blocks, gaps):
    """Return the sum over steps and points of A (K + K_soft) delta^2 / 8 for each corner passed."""
    p, area = blocks.p, blocks.model.points[2][:, None]
    low, high = np.minimum(gaps[1:], gaps[:-1]), np.maximum(gaps[1:], gaps[:-1])
    steepest, corners = p.stiffness, [0.0]
    if p.tensile_strength is not None:
        first, last = p.tensile_strength / p.stiffness, p.critical_opening
        largest = np.maximum.accumulate(np.maximum(gaps, 0.0))[:-1]
        steepest = p.stiffness + p.tensile_strength / (last - first)
        corners += [first, last, np.maximum(largest, first)]
    passed = sum(((low < corner) & (corner < high)).astype(int) for corner in corners)
    return float((area * steepest / 8 * (high - low) ** 2 * passed).sum())


def test_terms_are_those_of_the_scene(row):
    """Rotation where blocks turn, friction where a joint is not linear, fracture, gravity."""
    basic = ["kinetic", "elastic", "viscous", "boundary", "work"]
    still = row(motion__rotation="none", load__at=[0.0, 0.0])
    assert dem.simulate(still).term.values.tolist() == basic
    turning = ["kinetic", "rotation", "elastic", "viscous", "boundary", "work"]
    assert dem.simulate(row()).term.values.tolist() == turning
