"""The critical step is sharp: bounded just below it, growing without limit just above."""

import numpy as np
import pytest

from cases.calibrate import calibrate
from cases.errors import SceneError, UnstableError
from cases.sampling import Clock
from continuum import simulate
from continuum.build import build, build_model, critical_step_of
from continuum.elasticity import discretise
from continuum.explicit import run
from continuum.interface import resolved_joints
from continuum.mesh import pillar_grid
from continuum.model import room, state_at_rest

SHORT = {"pillar__length": 4.0, "record__stress": [2.0], "load__amplitude": 0.0}
LAYER = {"soft_layers": [{"y": 2.0, "spacing_stiffness": 4.375e8, "damping_ratio": 0.1}]}
DAMPED = {"joints__damping_ratio": 0.05}
KINDS = {
    "undamped": {},
    "damped": DAMPED,
    "soft layer": LAYER,
    "damped soft layer": {**DAMPED, **LAYER},
    "quiet": {"ends__start": "quiet", "ends__end": "quiet"},
    "damped quiet": {**DAMPED, "ends__end": "quiet"},
    "matched": {"ends__start": "matched", "ends__end": "matched"},
    "damped matched": {**DAMPED, "ends__start": "quiet", "ends__end": "matched"},
    "fixed": {"ends__end": "fixed"},
}


def growth(scene, model: str, order: int, fraction: float) -> float:
    """Return the largest speed after 40,000 steps over the largest of a random start."""
    p = calibrate(scene)
    joints = resolved_joints(p, model)
    bar = discretise(pillar_grid(p, 1, joints.number), order)
    critical = critical_step_of(bar, joints, scene, p, model)
    steps = 40_000
    time = Clock(fraction * critical, steps, 2)
    built = build_model(scene, p, bar, joints, time, model)
    state = state_at_rest(built, False)
    state.v[:] = np.random.default_rng(1).standard_normal(state.v.size)
    state.v_before[:] = state.v
    run(built, state, room(built, state, 2), time.stride, 0, steps)
    return float(np.nan_to_num(np.abs(state.v).max(), nan=np.inf))


@pytest.mark.parametrize("model", ["jointed", "equivalent"])
@pytest.mark.parametrize("kind", KINDS)
def test_critical_step_is_sharp(pillar, kind, model):
    """Below it no mode is amplified by more than 1 / sqrt(1 - 0.999^2) = 22; above it the fastest
    one grows at every step."""
    scene = pillar(**SHORT, **KINDS[kind])
    assert growth(scene, model, 2, 0.999) < 100
    assert growth(scene, model, 2, 1.001) > 1e6


@pytest.mark.parametrize("order", [1, 3, 4])
def test_critical_step_is_sharp_at_every_order(pillar, order):
    scene = pillar(**SHORT, **DAMPED)
    assert growth(scene, "jointed", order, 0.999) < 100
    assert growth(scene, "jointed", order, 1.001) > 1e6


def test_uniform_lumped_linear_bar_is_critical_when_a_wave_crosses_one_element(pillar):
    scene = pillar(
        **{"numerics__continuum__order": 1, "numerics__continuum__elements_per_block": 1}
    )
    p = calibrate(scene)
    _, _, _, critical = build(scene, "equivalent")
    assert critical == pytest.approx(p.spacing / p.bar_speed, rel=1e-4)


def test_step_above_the_critical_one_is_refused(pillar):
    with pytest.raises(SceneError, match=r"continuum.step_fraction = 1.5.*critical step"):
        simulate(pillar(numerics__continuum__step_fraction=1.5))


def test_run_that_was_forced_above_the_critical_step_is_stopped_and_dated(pillar):
    scene = pillar(numerics__continuum__step_fraction=1.2, numerics__continuum__allow_unstable=True)
    with pytest.raises(UnstableError, match=r"before t = .* s \(step .* s, critical .* s\)$"):
        simulate(scene)
