"""The chain by scipy's adaptive integrator: correct if applicable, else refused."""

import pytest

from jointwave.compare.engines import solve
from jointwave.compare.misfit.metrics import misfit
from jointwave.compare.studies.measure import measure
from jointwave.compare.studies.methods import adaptive

RICKER = {"shape": "ricker", "amplitude": 1e6, "period": 0.01}
ACROSS = {"shape": "ricker", "amplitude": 1e6, "period": 2e-3, "direction": [0.0, 0.6, 0.8]}


def test_a_method_that_does_not_apply_is_a_failed_point_with_the_reason(study, pillar):
    assert adaptive.applies(pillar(load=RICKER))
    curve = {"label": "scipy", "method": "solve-ivp", "changes": {"load": ACROSS}}
    (point,) = study([curve]).points()
    row = measure(point)
    assert row.state == "failed" and "solve-ivp does not apply: " in row.message
    assert "\n" not in row.message


@pytest.mark.parametrize("damping", [{}, {"joints__damping_ratio": 0.05}])
def test_adaptive_steps_reach_the_exact_chain_as_their_tolerance_shrinks(pillar, damping):
    """Some digits for every digit of the tolerance."""
    scene = pillar(load=RICKER, time__duration=0.03, **damping)
    exact = solve("lattice", scene)
    coarse, fine = (misfit(adaptive.solve(scene, rtol), exact) for rtol in (1e-4, 1e-8))
    assert coarse < 1e-2 and fine < 1e-5 and fine < 1e-2 * coarse
