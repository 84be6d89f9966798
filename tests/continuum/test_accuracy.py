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


@pytest.mark.parametrize(
    ("model", "changes"),
    [
        ("equivalent", {}),
        ("equivalent", {"ends__end": "quiet"}),
        ("equivalent", {"ends__end": "fixed"}),
        ("jointed", {}),
        ("jointed", {**DAMPED, **LAYER, "ends__start": "matched", "ends__end": "fixed"}),
        ("jointed", {**DAMPED, **LAYER, "ends__start": "matched", "ends__end": "matched"}),
        ("jointed", {"ends__end": "quiet"}),
    ],
)
def test_bars_meet_their_exact_solutions(pillar, model, changes):
    """Four elements a block: a wave crosses each in a hundredth of the period."""
    scene = pillar(**PLACES, **changes)
    result = simulate(scene, model)
    exact = images.solve(scene) if model == "equivalent" else JOINTED.run(scene)
    for variable in ("stress", "velocity", "displacement"):
        assert relative_l2(result[variable].values, exact[variable].values) < 5e-3


@pytest.mark.parametrize("layer", [{}, LAYER], ids=["uniform", "soft layer"])
def test_jointed_error_falls_with_the_square_of_the_step(pillar, layer):
    """Quadratic elements resolve a block so well that only the step is left to err.

    The last rate is seen through what the elements leave, 2e-6, a twentieth of the last error.
    """
    errors = []
    for interval in (2e-5, 1e-5, 5e-6):
        step = {"record__interval": interval, "numerics__continuum__step_fraction": 1.0}
        scene = pillar(**RICKER, **layer, **step)
        result = simulate(scene, "jointed")
        assert result.dt == pytest.approx(interval)
        errors.append(relative_l2(result.stress.values, JOINTED.run(scene).stress.values))
    assert np.diff(-np.log2(errors)) == pytest.approx([2, 2], abs=0.1)
