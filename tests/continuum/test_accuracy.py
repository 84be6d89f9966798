"""How the misfits of the bar from its exact solution fall; those of shipped scenes have bounds."""

import numpy as np
import pytest

from jointwave.compare.exact.bar.bars import JOINTED
from jointwave.compare.misfit.metrics import relative_l2
from jointwave.continuum import simulate

LAYER = {"soft_layers": [{"y": 20.0, "spacing_stiffness": 4.375e8, "damping_ratio": 0.02}]}
RICKER = {"load": {"shape": "ricker", "amplitude": 1e6, "period": 0.01}, "time__duration": 0.06}


@pytest.mark.parametrize("layer", [{}, LAYER], ids=["uniform", "soft layer"])
def test_jointed_error_falls_with_the_square_of_the_step(pillar, layer):
    """Quadratic elements resolve a block so well that only the step is left to err.

    The last rate is seen through what the elements leave, 2e-6, a twentieth of the last error."""
    errors = []
    for interval in (2e-5, 1e-5, 5e-6):
        step = {"record__interval": interval, "numerics__continuum__step_fraction": 1.0}
        scene = pillar(**RICKER, **layer, **step)
        result = simulate(scene, "jointed")
        assert result.dt == pytest.approx(interval)
        errors.append(relative_l2(result.stress.values, JOINTED.run(scene).stress.values))
    assert np.diff(-np.log2(errors)) == pytest.approx([2, 2], abs=0.1)
