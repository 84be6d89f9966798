"""The critical step is sharp: bounded just below it, growing without limit just above."""

import numpy as np
import pytest

from jointwave.cases.errors import SceneError, UnstableError
from jointwave.cases.material.calibrate import calibrate
from jointwave.continuum import simulate

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
