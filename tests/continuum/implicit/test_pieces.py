"""What implicit steps are made of, piece by piece, by numbers worked out by hand."""

import numpy as np
import pytest

from jointwave.cases.errors import SceneError, StoppedError
from jointwave.cases.sampling import Clock
from jointwave.continuum.build import build_model, discretise
from jointwave.continuum.implicit.static import settle_static
from jointwave.continuum.state import state_at_rest

FEW = {"pillar__length": 1.5, "record__stress": [0.5], "record__velocity": [1.0]}


@pytest.fixture
def built(pillar):
    """Return a function that gives (discrete, model, state) of three blocks, steps of 1 ms."""

    def build(kind, dim, samples=3, **changes):
        scene = pillar(**FEW | changes)
        discrete = discretise(scene, kind, dim)
        model = build_model(scene, discrete, kind, Clock(1e-3, 1, samples))
        return scene, discrete, model, state_at_rest(model, True)

    return build


def test_a_shaken_base_goes_its_way_and_does_all_the_work(implicit, pillar):
    """Its displacement is the sum of its steps; with rho = 1 all energy is the work of its force,
    and that of its own nodes, which move at t = 0 already."""
    load = {"shape": "sine", "amplitude": 0.1, "period": 5e-3, "quantity": "velocity"}
    record = {"stress": [0.5], "velocity": [0.0, 1.0], "interval": 1e-4}
    scene = pillar(
        pillar__length=2.0,
        record=record,
        load=load,
        ends={"start": "fixed", "end": "free"},
        time__duration=5e-3,
    )
    run = implicit(scene, kind="equivalent", dim=1).go()
    moved = np.append(0.0, np.cumsum(run.model.ends.fixed.step))[: run.clock.samples]
    base, top = run.samples.displacement
    assert base == pytest.approx(moved, abs=1e-16)
    assert np.abs(base).max() > 1e-4 and not np.allclose(top, base, rtol=1e-3)
    held = sum(run.energy(term) for term in ("kinetic", "elastic"))
    work = run.energy("work")
    assert work.max() > 1e3 * held[0] > 0
    assert np.abs(held - held[0] - work).max() < 1e-9 * work.max()


def test_a_step_that_fails_half_way_says_when(implicit, pillar, monkeypatch):
    """From 3.5 steps on nothing converges: the half that did is not counted again, ten halvings
    and a 1024th of a step later the run is given up, with the samples at steps 0 and 2."""
    record = {"stress": [0.5], "velocity": [0.0], "interval": 2e-4}
    scene = pillar(pillar__length=2.0, record=record, time__duration=2e-3)
    run = implicit(scene, kind="equivalent", dim=1, stride=2)
    took, longest = run.implicit.stepper.step, []

    def step(n, share, halvings):
        outcome = took(n, share, halvings)
        fails = n + share > 3.5
        longest.append((n + share, halvings))
        return outcome._replace(converged=False) if fails else outcome

    monkeypatch.setattr(run.implicit.stepper, "step", step)
    with pytest.raises(StoppedError, match=r"do not converge at t = 0\.00035 s") as error:
        run.go()
    assert error.value.samples == 2
    assert run.implicit.counts.tolist() == [10, 3]
    assert longest[3:5] == [(4.0, 0), (3.5, 1)]
    assert longest[-1] == (3.5 + 2.0**-10, 10)


def test_rock_that_falls_carries_nothing(implicit, pillar):
    """u = g t^2 / 2 and v = g t at every step, without stress beside rho g L."""
    record = {"stress": [0.3, 1.0], "velocity": [0.2, 2.0], "interval": 1e-4}
    scene = pillar(
        pillar__length=2.0,
        record=record,
        load={"shape": "step", "amplitude": 0.0},
        gravity={"direction": [0, 1, 0], "static": False},
        time__duration=2e-3,
    )
    run = implicit(scene, kind="equivalent", dim=1).go()
    t = 1e-4 * np.arange(run.clock.samples)
    falls = pytest.approx(np.tile(9.81 * t, (2, 1)), rel=1e-9, abs=1e-12)
    assert run.samples.velocity == falls
    assert run.samples.displacement == pytest.approx(np.tile(9.81 * t**2 / 2, (2, 1)), abs=1e-13)
    weight = run.discrete.properties.density * 9.81 * 2.0
    assert np.abs(run.samples.stress).max() < 1e-9 * weight


def test_rock_stands_under_its_weight_after_one_correction(built):
    """u = rho g (L^2 - (L - s)^2) / 2 E at the height s above the wall, on the nodes of a bar; a
    linear state needs one correction, and none to see that it is one."""
    scene, discrete, model, state = built(
        "equivalent", 1, gravity={"direction": [0, 1, 0]}, ends__end="fixed", load__amplitude=0.0
    )
    found = settle_static(scene, model, state, discrete.body)
    p, body = discrete.properties, discrete.body
    height = 1.5 - body.y
    moved = p.density * 9.81 * (1.5**2 - (1.5 - height) ** 2) / (2 * p.modulus)
    u = state.u[body.freedom(np.arange(len(body.x)), 0)]
    assert u == pytest.approx(moved, rel=1e-9, abs=1e-20)
    assert found["static_steps"] == 1
    assert 0 <= found["static_out_of_balance"] < 1e-10


def test_rock_that_nothing_holds_has_no_static_state(built):
    """However little of the weight is put on, no displacement balances it: it falls."""
    gravity = {"direction": [0, 1, 0], "static": False}
    scene, discrete, model, state = built("equivalent", 1, gravity=gravity)
    refused = (
        r"gravity: no static state beyond 0 of the weight: .* moves on, at 9.81 m/s2; it slides"
    )
    with pytest.raises(SceneError, match=refused):
        settle_static(scene, model, state, discrete.body)
