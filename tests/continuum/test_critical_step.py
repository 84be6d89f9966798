"""The critical step is sharp: bounded just below it, growing without limit just above."""

import numpy as np
import pytest
from scipy.sparse import csr_matrix

from jointwave.cases.errors import SceneError, UnstableError
from jointwave.cases.material.calibrate import calibrate
from jointwave.continuum import simulate
from jointwave.continuum.stepping.critical import critical_step

SHORT = {"load__amplitude": 1.0, "pillar__length": 4.0}
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


STEPS, EVERY = 50_000, 250


def stepped(short, model, dim, changes, fraction):
    """Return the result of 50,000 steps of a fraction of the critical step, which is within 1e-4 of
    the true one, from below."""
    record = {"stress": [1.0], "velocity": [0.3], "interval": 5e-5}
    probe = short(**changes, record=record, time__duration=1e-4)
    dt = fraction * simulate(probe, model, dim=dim).attrs["critical_dt"]
    forced = {"step_fraction": fraction, "allow_unstable": True}
    forced = {f"numerics__continuum__{key}": value for key, value in forced.items()}
    record |= {"interval": EVERY * dt}
    scene = short(**changes, **forced, record=record, time__duration=STEPS * dt)
    result = simulate(scene, model, dim=dim)
    assert result.attrs["dt"] == pytest.approx(dt, rel=1e-9)
    return result


def is_sharp(*case):
    """Nothing grows at 0.999 of it, and 0.1 % above the run is lost."""
    v = np.abs(stepped(*case, 0.999).velocity.values)
    half = v.shape[1] // 2
    assert v.any() and v[:, half:].max() < 2 * v[:, :half].max()
    with pytest.raises(UnstableError):
        stepped(*case, 1.001)


@pytest.mark.parametrize("model", ["jointed", "equivalent"])
@pytest.mark.parametrize("kind", KINDS)
def test_critical_step_is_sharp(short, kind, model):
    is_sharp(short, model, 1, SHORT | KINDS[kind])


@pytest.mark.parametrize("order", [1, 3, 4])
def test_critical_step_is_sharp_at_every_order(short, order):
    is_sharp(short, "jointed", 1, SHORT | DAMPED | {"numerics__continuum__order": order})


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
def test_critical_step_is_sharp_in_space(short, kind):
    """Joints, dashpots, elements of every kind, in two blocks."""
    dim, changes = IN_SPACE[kind]
    is_sharp(short, "jointed", dim, {"load__amplitude": 1.0, "pillar__length": 1.0} | changes)


@pytest.mark.parametrize(
    "joints",
    [{"friction_angle": 20.0, "cohesion": 1e4}, {"tension": False}],
    ids=["slip", "no tension"],
)
def test_slip_and_opening_do_not_lower_it(joints, short):
    """At 0.999 of the critical step of joints that hold, energy stays what the load has put in,
    but for a tenth."""
    load = {"shape": "sine", "amplitude": 1e5, "period": 1e-3, "direction": [0.6, 0.8, 0.0]}
    changes = {"load": load, "joints": joints, "numerics__continuum__step_fraction": 0.999}
    dt = 0.999 * simulate(short(**changes), dim=2).attrs["critical_dt"]
    changes |= {"record": {"interval": dt}, "time__duration": 4000 * dt}
    result = simulate(short(**changes), dim=2)
    assert result.attrs["steps"] == 4000
    energy = result.energy
    held = energy.sel(term="kinetic") + energy.sel(term="elastic")
    assert held.max() < 1.1 * energy.sel(term="work").max()


def test_uniform_lumped_linear_bar_is_critical_when_a_wave_crosses_one_element(pillar):
    scene = pillar(
        **{"numerics__continuum__order": 1, "numerics__continuum__elements_per_block": 1}
    )
    p = calibrate(scene)
    critical = simulate(scene, "equivalent").attrs["critical_dt"]
    assert critical == pytest.approx(p.spacing / p.bar_speed, rel=1e-4)
    assert critical <= p.spacing / p.bar_speed * (1 + 1e-12)


def test_step_above_the_critical_one_is_refused(pillar):
    with pytest.raises(SceneError, match=r"continuum.step_fraction = 1.5.*critical step"):
        simulate(pillar(numerics__continuum__step_fraction=1.5))


def test_run_that_was_forced_above_the_critical_step_is_stopped_and_dated(pillar):
    scene = pillar(numerics__continuum__step_fraction=1.2, numerics__continuum__allow_unstable=True)
    with pytest.raises(UnstableError, match=r"diverged at t = .* s, step \d+ of .* times the"):
        simulate(scene)


def of_matrices(stiffness, viscosity):
    """Return the critical step of masses of 1 kg on springs and dashpots, s."""
    matrices = csr_matrix(stiffness), None if viscosity is None else csr_matrix(viscosity)
    return critical_step(np.ones(len(stiffness)), *matrices, np.zeros(0, int))


def test_critical_step_of_one_freedom():
    """omega = 3: 2/3 s. With a dashpot of C / M = 2: 9 dt^2 + 8 dt = 4, 2 (sqrt(13) - 2) / 9 s."""
    spring, dashpot = np.array([[9.0]]), np.array([[2.0]])
    assert of_matrices(spring, None) == pytest.approx(2 / 3, rel=1e-15)
    damped = 2 * (np.sqrt(13) - 2) / 9
    assert of_matrices(spring, dashpot) == pytest.approx(damped, rel=1e-12)


def test_critical_step_where_dashpots_decide_the_mode():
    """The stiffest freedom is bounded by 2/3 s, the most damped one, 1 + 16 dt = 4 / dt, by less:
    (sqrt(68) - 8) s = 0.2462 s."""
    found = of_matrices(np.diag([9.0, 1.0]), np.diag([0.0, 4.0]))
    assert found == pytest.approx(np.sqrt(68) - 8, rel=1e-12)


def test_critical_step_of_modes_that_dashpots_turn():
    """The largest eigenvalue of dt^2 K + 4 dt C is 4, of no mode of either alone; to the square of
    the change of 1e-6 at which the search ends."""
    springs, dashpots = np.random.default_rng(4).standard_normal((2, 6, 6))
    k, c = springs @ springs.T, 0.2 * dashpots @ dashpots.T
    dt = of_matrices(k, c)
    largest = np.linalg.eigvalsh(dt**2 * k + 4 * dt * c)[-1]
    assert largest == pytest.approx(4.0, rel=1e-10)


def test_freedoms_whose_motion_is_given_do_not_bound_it():
    found = critical_step(np.ones(2), csr_matrix(np.diag([9.0, 1.0])), None, np.array([0]))
    assert found == pytest.approx(2.0, rel=1e-15)
