"""The bar against exact solutions: misfits at the default numerics, and how they fall."""

import numpy as np
import pytest

from jointwave.compare.exact.bar import images
from jointwave.compare.exact.bar.bars import JOINTED
from jointwave.compare.misfit.metrics import relative_l2
from jointwave.continuum import simulate

LAYER = {"soft_layers": [{"y": 20.0, "spacing_stiffness": 4.375e8, "damping_ratio": 0.02}]}
DAMPED = {"joints__damping_ratio": 0.02}
PLACES = {"record__stress": [10.0, 20.0, 20.2], "record__velocity": [19.75, 20.25]}
RICKER = {"load": {"shape": "ricker", "amplitude": 1e6, "period": 0.01}, "time__duration": 0.06}


def misfit(result, exact, variable="stress"):
    """Return the relative L2 distance of two results."""
    return relative_l2(result[variable].values, exact[variable].values)


def rates(errors):
    """Return the observed orders between successive errors, each at half of the one before."""
    return np.diff(-np.log2(errors))


@pytest.mark.parametrize(
    ("model", "changes"),
    [
        ("equivalent", {}),
        ("equivalent", {"ends__end": "quiet"}),
        ("equivalent", {"ends__end": "fixed"}),
        ("jointed", {}),
        ("jointed", {**DAMPED, **LAYER, "ends__end": "fixed"}),
        ("jointed", {**DAMPED, "ends__start": "matched", "ends__end": "matched"}),
        ("jointed", {"ends__end": "quiet"}),
    ],
)
def test_bars_meet_their_exact_solutions(pillar, model, changes):
    """Four elements a block: a wave crosses each in a hundredth of the period."""
    scene = pillar(**PLACES, **changes)
    result = simulate(scene, model)
    exact = images.solve(scene) if model == "equivalent" else JOINTED.run(scene)
    for variable in ("stress", "velocity", "displacement"):
        assert misfit(result, exact, variable) < 5e-3


@pytest.mark.parametrize("order", [1, 2])
def test_error_falls_at_twice_the_order_for_a_smooth_pulse(pillar, order):
    """The phase error of GLL elements is (k h)^(2p); stress by momentum balance and velocity at
    element ends lose nothing of it. All at one step, so that its error cancels."""

    def stress(order, elements):
        scene = pillar(
            **RICKER,
            record__interval=1e-5,
            numerics__continuum__order=order,
            numerics__continuum__elements_per_block=elements,
            numerics__continuum__step_fraction=0.9,
        )
        result = simulate(scene, "equivalent")
        assert result.dt == pytest.approx(1e-5)
        return result

    reference = stress(4, 2)
    errors = [misfit(stress(order, elements), reference) for elements in (4, 8)]
    assert rates(errors) == pytest.approx(2 * order, abs=0.2)


@pytest.mark.parametrize("layer", [{}, LAYER], ids=["uniform", "soft layer"])
def test_jointed_error_falls_with_the_square_of_the_step(pillar, layer):
    """Quadratic elements resolve a block so well that only the step is left to err.

    The last rate is seen through what the elements leave, 2e-6, a twentieth of the last error.
    """
    errors = []
    for interval in (2e-5, 1e-5, 5e-6):
        scene = pillar(
            **RICKER, **layer, record__interval=interval, numerics__continuum__step_fraction=1.0
        )
        result = simulate(scene, "jointed")
        assert result.dt == pytest.approx(interval)
        errors.append(misfit(result, JOINTED.run(scene)))
    assert rates(errors) == pytest.approx([2, 2], abs=0.1)
