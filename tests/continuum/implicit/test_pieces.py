"""What implicit steps are made of, piece by piece, by numbers worked out by hand."""

import numpy as np
import pytest

from cases.errors import SceneError, StoppedError
from cases.sampling import Clock
from continuum.build import build_model, discretise
from continuum.implicit.balance import implicit_matrices, trial_forces
from continuum.implicit.pattern import System
from continuum.implicit.static import settle_static
from continuum.implicit.substeps import (
    UNLOADED,
    Applied,
    applied_at,
    end_resistance,
    fixed_motion,
    move,
    shorter_springs,
)
from continuum.model import Fixed, HalfJoints, Quiet
from continuum.space.tractions import NN, XN, XX, XZ, ZN, ZZ
from continuum.state import state_at_rest
from joints.ends import half_spring

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


@pytest.mark.parametrize("dim", [1, 2, 3])
def test_joints_on_the_pattern_are_the_product_of_matrices(built, dim):
    """B^T D B: a traction along the joint answers the gap, and not the other way about."""
    small = {"numerics__continuum__order": 1, "numerics__continuum__elements_across": 1}
    _, discrete, model, _ = built("jointed", dim, **small)
    rock, random = implicit_matrices(discrete.body), np.random.default_rng(2)
    # No two entries alike, as on joints that lie in any direction.
    joints = model.interfaces._replace(jump=model.interfaces.jump.copy())
    joints.jump.data *= random.uniform(1, 2, joints.jump.nnz)
    model = model._replace(interfaces=joints)
    system = System(model, rock, np.array([0]), [rock.mass])
    system.tangents[:] = random.uniform(1, 2, system.tangents.shape)
    values = system.with_joints(0.5 * system.pattern.fixed[0], share=0.25)
    found = np.zeros((system.free.size, system.free.size))
    row = np.repeat(np.arange(system.free.size), np.diff(system.pattern.start))
    found[row, system.pattern.column] = values

    of_point = np.array([[NN, -1, -1], [XN, XX, XZ], [ZN, XZ, ZZ]])[:dim, :dim]
    jumps = joints.jump.toarray().reshape(dim, joints.area.size, -1)[:, :, system.free]
    expected = 0.5 * rock.mass.toarray()[np.ix_(system.free, system.free)]
    for a in range(dim):
        for b in range(dim):
            if of_point[a, b] >= 0:
                d = system.tangents[of_point[a, b]]
                expected += 0.25 * jumps[a].T @ (d[:, None] * jumps[b])
    assert 0 not in system.free
    np.testing.assert_allclose(found, expected, atol=1e-12 * np.abs(expected).max())


def test_motion_of_a_base():
    """1, 3 and 2 mm a step of 0.1 s: at steps 0, 1, 3 mm with what is before and behind each."""
    fixed = fixed_motion(Fixed(np.array([1]), np.array([-2.0]), 1e-3 * np.array([1, 3, 2])), 0.1)
    u, v, a = fixed.motion
    assert u == pytest.approx([0, 1e-3, 4e-3], abs=1e-18)
    assert v == pytest.approx([5e-3, 0.02, 0.025])
    assert a == pytest.approx([0.1, 0.2, -0.1])
    assert fixed_motion(None, 0.1).freedom.size == 0


def test_a_base_moves_its_freedoms_alone(built):
    """To a quarter of the way between steps 1 and 2: times the direction, in u, v and a."""
    *_, state = built("equivalent", 1)
    given = fixed_motion(Fixed(np.array([1]), np.array([-2.0]), 1e-3 * np.array([1, 3, 2])), 0.1)
    acceleration = np.full(state.u.size, 7.0)
    state.u[:], state.v[:] = 5.0, 6.0
    move(given, state, acceleration, 1, 0.25)
    vectors = state.u, state.v, acceleration
    assert [x[1] for x in vectors] == pytest.approx([-3.5e-3, -0.0425, -0.25])
    for x, rest in zip(vectors, (5.0, 6.0, 7.0), strict=True):
        assert (np.delete(x, 1) == rest).all()
    move(given, state, acceleration, 2, 0.0)
    assert [x[1] for x in vectors] == pytest.approx([-8e-3, -0.05, 0.2])
    move(given._replace(motion=None), state, acceleration, 2, 0.0)
    assert not any(x[1] for x in vectors)


def test_pressure_between_steps(built):
    """Linear: a quarter of the way from 3 to 7 Pa; the last one asks for none behind it."""
    *_, model, _ = built("equivalent", 1)
    loaded = model.ends.loaded._replace(pressure=np.array([1.0, 3.0, 7.0]))
    model = model._replace(ends=model.ends._replace(loaded=loaded))
    assert [applied_at(model, *at).pressure for at in ((1, 0.25), (0, 1.0), (2, 0.0))] == [
        4.0,
        3.0,
        7.0,
    ]
    assert applied_at(model._replace(ends=model.ends._replace(loaded=None)), 2, 0.0) == (0.0, None)


@pytest.mark.parametrize("share", [0.5, 0.25])
def test_half_joints_of_a_shorter_step_are_those_made_for_it(share):
    springs = [half_spring(3e9, 1e-5, z, dt) for z in (2e6, 5e6) for dt in (1e-3, share * 1e-3)]
    whole, short = (
        HalfJoints(*(np.array([getattr(s, k) for s in some]) for k in HalfJoints._fields))
        for some in (springs[::2], springs[1::2])
    )
    for a, b in zip(shorter_springs(whole, share), short, strict=True):
        np.testing.assert_allclose(a, b, rtol=1e-14)


def test_ends_resist_by_dashpots_at_the_rate_and_springs_by_their_gain():
    """C r, and k times the closure of a unit of displacement in the step, gain / dt."""
    quiet = Quiet(np.array([4, 7]), np.array([2.0, 3.0]), np.zeros(2))
    freedom, bare = end_resistance(quiet, 10.0, 0.5)
    springs = HalfJoints(np.array([8.0, 0.0]), np.zeros(2), np.array([0.25, 0.0]))
    _, sprung = end_resistance(quiet._replace(springs=springs), 10.0, 0.5)
    assert freedom.tolist() == [4, 7]
    assert bare.tolist() == [20.0, 30.0] and sprung.tolist() == [24.0, 30.0]


def test_largest_force_of_a_trial(built):
    """What the tolerance is measured by: of rock, dashpots, weight and load each in its turn."""
    changes = {
        "gravity": {"direction": [0, 1, 0], "static": False},
        "joints__damping_ratio": 0.05,
        "ends__end": "fixed",
    }
    _, discrete, model, now = built("equivalent", 1, **changes)
    rock, tangents = implicit_matrices(discrete.body), np.zeros((6, 0))
    trial = state_at_rest(model, True)
    weight = np.abs(model.weight).max()
    assert weight > 0 and model.rock.viscosity is not None

    def size(u=0.0, v=0.0, pressure=0.0):
        trial.u[:], trial.v[:] = 0.0, 0.0
        trial.u[1], trial.v[1] = u, v
        return trial_forces(model, rock, now, trial, tangents)(Applied(pressure, None))

    k, c = (np.abs(m.toarray()[:, 1]).max() for m in (rock.stiffness, rock.viscosity))
    share = np.abs(model.ends.loaded.share).max()
    assert size() == pytest.approx(weight, rel=1e-14)
    assert size(u=10 * weight / k) == pytest.approx(10 * weight, rel=1e-12)
    assert size(v=10 * weight / c) == pytest.approx(10 * weight, rel=1e-12)
    assert size(pressure=-10 * weight / share) == pytest.approx(10 * weight, rel=1e-12)


def test_a_trial_starts_from_the_ledger_before_it(built):
    """However often it is tried."""
    _, discrete, model, now = built("equivalent", 1)
    trial, rock = state_at_rest(model, True), implicit_matrices(discrete.body)
    now.ledger[:] = 1.0, 2.0, 3.0, 4.0
    trial.ledger[:] = 5.0
    trial_forces(model, rock, now, trial, np.zeros((6, 0)))(UNLOADED)
    assert trial.ledger.tolist() == [1.0, 2.0, 3.0, 4.0]


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
