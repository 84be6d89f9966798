"""The critical step is sharp: bounded just below it, growing without limit just above."""

import numpy as np
import pytest

from cases.errors import SceneError, UnstableError
from cases.material.calibrate import calibrate
from continuum import simulate
from continuum.run import discrete_and_steps

QUIET = {
    "load__amplitude": 0.0,
    "record": {"stress": [1.0], "velocity": []},
}
SHORT = {**QUIET, "pillar__length": 4.0}
LAYER = {"soft_layers": [{"y": 2.0, "spacing_stiffness": 4.375e8, "damping_ratio": 0.1}]}
DAMPED = {"joints__damping_ratio": 0.05}
KINDS = {
    "undamped": {},
    "damped, matched": {**DAMPED, "ends__start": "quiet", "ends__end": "matched"},
    "damped soft layer, quiet": {**DAMPED, **LAYER, "ends__end": "quiet"},
    "quiet": {"ends__start": "quiet", "ends__end": "quiet"},
    "fixed": {"ends__end": "fixed"},
}
STEPS = 4000  # in which a step 1e-4 above the critical one lets a mode grow by exp(113)


@pytest.fixture
def growth(ready):
    """Return a function: the largest speed after STEPS over the largest of a random start.

    The step is a fraction of the critical one, which is within 1e-4 of the true one from below.
    """

    def of(scene, model: str, dim: int, fraction: float) -> float:
        run = ready(scene, model, dim, fraction=fraction, samples=1)
        run = run._replace(time=run.time._replace(stride=STEPS))
        body, start = run.discrete.body, np.random.default_rng(1).standard_normal
        nodes = np.arange(len(body.x))
        freedoms = np.unique([body.freedom(nodes, c) for c in range(body.section.components)])
        run.state.v[freedoms] = start(freedoms.size)
        if run.model.ends.fixed is not None:
            run.state.v[run.model.ends.fixed.freedom] = 0.0
        run.state.v_before[:] = run.state.v
        run.take(0, STEPS)
        return float(np.nan_to_num(np.abs(run.state.v).max(), nan=np.inf))

    return of


@pytest.mark.parametrize("model", ["jointed", "equivalent"])
@pytest.mark.parametrize("kind", KINDS)
def test_critical_step_is_sharp(short, growth, kind, model):
    """Below it no mode is amplified by more than 1 / sqrt(1 - 0.999^2) = 22; above it the fastest
    one grows at every step."""
    scene = short(**{**SHORT, **KINDS[kind]})
    assert growth(scene, model, 1, 0.999) < 100
    assert growth(scene, model, 1, 1.001) > 1e6


@pytest.mark.parametrize("order", [1, 3, 4])
def test_critical_step_is_sharp_at_every_order(short, growth, order):
    scene = short(**SHORT, **DAMPED, numerics__continuum__order=order)
    assert growth(scene, "jointed", 1, 0.999) < 100
    assert growth(scene, "jointed", 1, 1.001) > 1e6


IN_SPACE = {
    "plane": (2, {}),
    "plane, cubic": (2, {"numerics__continuum__order": 3, **DAMPED}),
    "plane, triangles": (2, {"numerics__continuum__cell": "simplex", **DAMPED}),
    "plane, matched": (2, {**DAMPED, "ends__start": "quiet", "ends__end": "matched"}),
    "space": (3, {}),
    "space, two across": (
        3,
        {**DAMPED, "numerics__continuum__order": 1, "numerics__continuum__elements_across": 2},
    ),
    "space, tetrahedra": (
        3,
        {**DAMPED, "numerics__continuum__cell": "simplex", "numerics__continuum__order": 1},
    ),
    "plane wave in space": (3, {"motion__rotation": "none", **DAMPED}),
}


@pytest.mark.parametrize("kind", IN_SPACE)
def test_critical_step_is_sharp_in_space(short, growth, kind):
    """Joints, dashpots, elements of every kind; two blocks with up to 324 freedoms."""
    dim, changes = IN_SPACE[kind]
    scene = short(**QUIET, pillar__length=1.0, **changes)
    assert growth(scene, "jointed", dim, 0.999) < 100
    assert growth(scene, "jointed", dim, 1.001) > 1e6


@pytest.mark.parametrize(
    "joints",
    [{"friction_angle": 20.0, "cohesion": 1e4}, {"tension": False}],
    ids=["slip", "no tension"],
)
def test_slip_and_opening_do_not_lower_it(joints, short, ready):
    """At 0.999 of the critical step of joints that hold, energy stays what the load has put in,
    but for a tenth."""
    load = {"shape": "sine", "amplitude": 1e5, "period": 1e-3, "direction": [0.6, 0.8, 0.0]}
    run = ready(short(load=load, joints=joints), "jointed", 2, fraction=0.999, samples=4001)
    energy = run.to_the_end().samples.energy
    assert energy[:2].sum(axis=0).max() < 1.1 * energy[7].max()


def test_uniform_lumped_linear_bar_is_critical_when_a_wave_crosses_one_element(pillar):
    scene = pillar(
        **{"numerics__continuum__order": 1, "numerics__continuum__elements_per_block": 1}
    )
    p = calibrate(scene)
    _, critical = discrete_and_steps(scene, "equivalent")[1:]
    assert critical == pytest.approx(p.spacing / p.bar_speed, rel=1e-4)
    assert critical <= p.spacing / p.bar_speed * (1 + 1e-12)


def test_step_above_the_critical_one_is_refused(pillar):
    with pytest.raises(SceneError, match=r"continuum.step_fraction = 1.5.*critical step"):
        simulate(pillar(numerics__continuum__step_fraction=1.5))


def test_run_that_was_forced_above_the_critical_step_is_stopped_and_dated(pillar):
    scene = pillar(numerics__continuum__step_fraction=1.2, numerics__continuum__allow_unstable=True)
    with pytest.raises(UnstableError, match=r"ran away at t = .* s, step \d+ of .* times the"):
        simulate(scene)
