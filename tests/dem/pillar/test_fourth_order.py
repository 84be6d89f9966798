"""Steps of fourth order: their order, what they conserve, where they are stable or refused."""

import numpy as np
import pytest

from jointwave import dem
from jointwave.cases.errors import SceneError
from jointwave.compare.exact.blocks import row_of_blocks
from jointwave.compare.misfit.metrics import misfit
from jointwave.results.dataset import energy_residual

RICKER = {"shape": "ricker", "amplitude": 1e6, "period": 0.01}
SOFT = [{"y": 20.0, "spacing_stiffness": 4.375e8}]
DOWN = {"direction": [0, 1, 0]}
RECORD = {"stress": [0.0, 20.0], "velocity": [0.25, 20.25], "interval": 1e-3}
CHAINS = {
    "prestressed between fixed ends, no load": {
        "ends": {"start": "fixed", "end": "fixed"},
        "load": {**RICKER, "amplitude": 0.0},
        "gravity": {**DOWN, "acceleration": 1000.0, "static": False},
        "prestress": {"normal": 1e5},
    },
    "against the axis, under its weight and a prestress": {
        "load": {**RICKER, "direction": [0, -1, 0]},
        "soft_layers": SOFT,
        "ends__end": "fixed",
        "gravity": DOWN,
        "prestress": {"normal": 2e6},
    },
    "sine from whole step to whole step": {"load": {**RICKER, "shape": "sine"}},
    "load that jumps at a whole step": {"load": {"shape": "step", "amplitude": 1e6}},
}


@pytest.fixture
def fourth(pillar):
    """Return a function (step_fraction, ...) that gives the pillar under a Ricker wavelet."""

    def scene(fraction, **changes):
        numerics = {"scheme": "fourth-order", "step_fraction": fraction, "allow_unstable": True}
        tables = {"load": RICKER, "record": RECORD, "numerics__dem": numerics}
        return pillar(**{"rock__intact_modulus": None, **tables, **changes})

    return scene


def orders(steps, errors):
    """Return the order from each step to the next."""
    return np.diff(np.log(errors)) / np.diff(np.log(steps))


LIMIT = 2.989449545906727  # omega dt up to which every mode is bounded, where leapfrog has 2
QUANTITIES = ("stress", "velocity", "displacement")


@pytest.mark.parametrize("changes", CHAINS.values(), ids=CHAINS)
def test_fourth_order_against_the_time_exact_chain(fourth, changes):
    """Stress, velocity and displacement, and the energy ledger; kinks at whole steps cost none."""
    steps, errors, exact = [], [], row_of_blocks.solve(fourth(0.3, **changes))
    for fraction in (0.3, 0.15, 0.075):
        result = dem.simulate(fourth(fraction, **changes))
        steps.append(result.attrs["dt"])
        largest = [abs(result[x] - exact[x]).max() / abs(exact[x]).max() for x in QUANTITIES]
        errors.append([misfit(result, exact), energy_residual(result), *map(float, largest)])
    assert orders(steps, np.array(errors).T) == pytest.approx(4.0, abs=0.1)


def test_energy_has_no_trend_in_a_hundred_thousand_steps(fourth):
    """The energy's error swings, at most as far at the end as at the beginning."""
    dt = 0.9 * dem.simulate(fourth(0.9)).attrs["critical_dt"]
    record = {"stress": [20.0], "interval": 100 * dt}
    result = dem.simulate(fourth(0.9, record=record, time__duration=100_000.5 * dt))
    assert result.attrs["steps"] == 100_000
    energy = result.energy.sel(term=["kinetic", "elastic"]).sum("term").values
    swing = energy[10:] / float(result.energy.sel(term="work")[-1])  # the load has ended
    early, late, trend = swing[:300], swing[-300:], np.polyfit(np.linspace(0, 1, 991), swing, 1)[0]
    assert np.ptp(late) < 1.5 * np.ptp(early) < 1e-4
    assert abs(trend) < 0.05 * np.ptp(swing)


def test_no_tension_converges_at_second_order(fourth):
    """The force has a kink where a joint opens or closes: order two, if not at every halving."""
    changes = {
        "joints__tension": False,
        "pillar__length": 20.0,
        "prestress": {"normal": 3e5},
        "time__duration": 0.025,
        "record": {"stress": [8.0], "interval": 5e-4},
    }
    exact = row_of_blocks.solve(fourth(0.1, **changes))  # no step changes it
    errors, steps = [], []
    for fraction in (0.1, 0.0125):
        result = dem.simulate(fourth(fraction, **changes))
        assert float(result.stress.min()) >= 0.0
        steps.append(result.attrs["dt"])
        errors.append(misfit(result, exact))
    assert errors[1] < 1e-4
    assert orders(steps, errors) == pytest.approx(2.0, abs=0.4)


def test_result_says_how_it_was_stepped(fourth, pillar):
    """Scheme, steps and forces; leapfrog takes one force a step."""
    result, leapfrog = dem.simulate(fourth(0.3)), dem.simulate(pillar())
    assert result.attrs["scheme"] == "fourth-order"
    assert result.attrs["force_evaluations"] == 4 * result.attrs["steps"]
    assert leapfrog.attrs["force_evaluations"] == leapfrog.attrs["steps"]
    more = result.attrs["critical_dt"] / leapfrog.attrs["critical_dt"]
    assert more == pytest.approx(LIMIT / 2, rel=1e-12)


@pytest.mark.parametrize(
    "changes, name",
    [
        ({"joints__damping_ratio": 0.02}, "dashpots"),
        ({"soft_layers": [{"y": 20.0, "damping_ratio": 0.1}]}, "dashpots"),
        ({"damping__mass_proportional": 10.0}, "mass damping"),
        ({"damping__local": 0.5}, "local damping"),
        ({"ends__end": "quiet"}, "quiet ends"),
        ({"ends__start": "matched"}, "matched ends"),
        ({"joints__tensile_strength": 2e6, "joints__fracture_energy": 500.0}, "softening"),
        ({"load": {**RICKER, "quantity": "velocity"}, "ends__start": "fixed"}, "shaken base"),
        ({"load": {**RICKER, "direction": [1, 0, 0]}}, "spatial motion"),
    ],
)
def test_refuses_what_it_cannot_step(fourth, changes, name):
    refused = rf"'fourth-order': does not support {name}"
    with pytest.raises(SceneError, match=rf"numerics\.dem\.scheme = {refused}"):
        fourth(0.3, **changes)
