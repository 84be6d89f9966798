"""The critical step is sharp: bounded just below it, growing without limit just above.

Steps of the bar and in the plane are taken as plain Python.
"""

import numpy as np
import pytest

from jointwave.cases.errors import SceneError, UnstableError
from jointwave.cases.material.calibrate import calibrate
from jointwave.continuum import simulate
from jointwave.continuum.run import discrete_and_steps

QUIET = {
    "load__amplitude": 0.0,
    "record": {"stress": [1.0], "velocity": [], "energy": False},
}
SHORT = {**QUIET, "pillar__length": 4.0}
LAYER = {"soft_layers": [{"y": 2.0, "spacing_stiffness": 4.375e8, "damping_ratio": 0.1}]}
DAMPED = {"joints__damping_ratio": 0.05}
KINDS = {
    "undamped": {},
    "soft layer": LAYER,
    "damped soft layer": {**DAMPED, **LAYER},
    "quiet": {"ends__start": "quiet", "ends__end": "quiet"},
    "damped quiet": {**DAMPED, "ends__end": "quiet"},
    "matched": {"ends__start": "matched", "ends__end": "matched"},
    "damped matched": {**DAMPED, "ends__start": "quiet", "ends__end": "matched"},
    "fixed": {"ends__end": "fixed"},
}


@pytest.fixture
def growth(ready):
    """Return a function: the magnitude of the largest eigenvalue of one step, which is a fraction
    of the critical one; that is within 1e-4 of the true one, from below.

    Its rows are displacements, velocities half a step and a step and a half before, and closures of
    the ends, of all freedoms that nothing holds.
    """

    def of(scene, model: str, dim: int, fraction: float) -> float:
        run = ready(scene, model, dim, fraction=fraction, samples=1)
        body, fixed, state = run.discrete.body, run.model.ends.fixed, run.state
        nodes = np.arange(len(body.x))
        free = np.unique([body.freedom(nodes, c) for c in range(body.section.components)])
        if fixed is not None:
            free = np.setdiff1d(free, fixed.freedom)
        parts = [(x, free) for x in (state.u, state.v, state.v_before)]
        if state.closure is not None:
            parts.append((state.closure.reshape(-1), np.arange(state.closure.size)))
        columns = []
        for here, own in parts:
            for i in own:
                for x, _ in parts:
                    x[:] = 0.0
                here[i] = 1.0
                run.take(0, 1)
                columns.append(np.concatenate([x[kept] for x, kept in parts]))
        return float(np.abs(np.linalg.eigvals(np.array(columns))).max())

    return of


def is_sharp(growth, scene, model, dim):
    """No eigenvalue leaves the unit circle below it, where double ones of rigid motion split by the
    square root of round-off; one does 0.1 % above."""
    return growth(scene, model, dim, 0.999) < 1 + 1e-6 < 1 + 1e-3 < growth(scene, model, dim, 1.001)


@pytest.mark.parametrize("model", ["jointed", "equivalent"])
@pytest.mark.parametrize("kind", KINDS)
def test_critical_step_is_sharp(plain, short, growth, kind, model):
    assert is_sharp(growth, short(**{**SHORT, **KINDS[kind]}), model, 1)


@pytest.mark.parametrize("order", [1, 3, 4])
def test_critical_step_is_sharp_at_every_order(plain, short, growth, order):
    scene = short(**SHORT, **DAMPED, numerics__continuum__order=order)
    assert is_sharp(growth, scene, "jointed", 1)


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
def test_critical_step_is_sharp_in_space(short, growth, kind, request):
    """Joints, dashpots, elements of every kind; two blocks with up to 324 freedoms."""
    dim, changes = IN_SPACE[kind]
    if dim == 2:
        request.getfixturevalue("plain")
    scene = short(**QUIET, pillar__length=1.0, **changes)
    assert is_sharp(growth, scene, "jointed", dim)


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
    with pytest.raises(UnstableError, match=r"diverged at t = .* s, step \d+ of .* times the"):
        simulate(scene)
