"""Explicit steps of bodies: energy, waves through joints, slip, and sides that absorb."""

import numpy as np
import pytest
from scipy.signal import lfilter

from jointwave.cases.incident import free_field
from jointwave.cases.material.rock import elastic_rock
from jointwave.cases.read import load_tables
from jointwave.continuum.run import simulate
from jointwave.continuum.space.evaluation import blocks_of_nodes
from jointwave.continuum.stepping import product
from jointwave.continuum.stepping.implicit import Implicit
from jointwave.continuum.stepping.leapfrog import Leapfrog
from jointwave.continuum.stepping.problem import Dashpots, Held, Problem
from jointwave.continuum.stepping.static import settled
from jointwave.joints.law import law
from tests.conftest import PILLAR
from tests.continuum.stacked import Force, readings, stack

ROCK_MASSES = PILLAR.parent.parent / "rock-mass"
NORMAL, SHEAR = 3.0, 2.0
Z = np.sqrt(2.0)  # impedance of the bar, and its speed


def joined(count, shear=True, eta=None, **strengths):
    """Return the law of this number of joints."""
    every = np.ones(count)
    return law(
        NORMAL * every,
        None if eta is None else eta * every,
        strengths.pop("tension", every == 1),
        shear_stiffness=SHEAR * every if shear else None,
        **{name: value * every for name, value in strengths.items()},
    )


def problem(body, own=None, nodes=(), points=(), **acts):
    return Problem(body, readings(body, nodes, points), own, (NORMAL, SHEAR), **acts)


@pytest.mark.parametrize("dim", [1, 2, 3])
def test_without_dashpots_energy_stays(dim):
    body = stack(dim, 4, 2, 2)
    below = body.sides["bottom"].node  # held, lest round-off of a rigid motion grows
    freedom = (dim * below[:, None] + np.arange(dim)).ravel()
    own = problem(body, joined(3, dim > 1), held=Held(freedom, np.zeros(freedom.size)))
    steps = Leapfrog(own, 0.5 * own.critical_step(), 101)
    pulse = np.exp(-4 * (body.x[:, -1] - 2.0) ** 2)
    pulse[below] = 0.0
    steps.throw(np.repeat(pulse, dim))
    steps.take(0, 1001, 10)
    kinetic, elastic = steps.samples.energy[:2]
    assert elastic.max() > 0.1 * kinetic[0]
    np.testing.assert_allclose(kinetic + elastic, kinetic[0], rtol=1e-13)


def damped(dim):
    """Return three blocks with dashpots, their bottom and top, and dashpots at the bottom."""
    body = stack(dim, 3, 1, 1)
    body = body._replace(damping=0.02 * body.stiffness)
    bottom, top = body.sides["bottom"], body.sides["top"]
    quiet = Dashpots(bottom.node, bottom.weight[:, None, None] * np.eye(dim))
    return body, bottom, top, quiet


@pytest.mark.parametrize("dim", [1, 2, 3])
def test_the_ledger_closes_with_dashpots_everywhere(dim):
    body, bottom, top, quiet = damped(dim)
    along = dim * top.node + dim - 1
    fixed = Held(along, np.ones(along.size), lambda steps: 1e-3 * np.sin(0.1 * steps))
    own = problem(body, joined(2, dim > 1, 0.1), alpha=0.2, quiet=quiet, held=fixed)
    dt = 0.5 * own.critical_step()
    push = Force(dim * bottom.node, bottom.weight, np.sin, dt)
    own = own._replace(forces=push, steady=0.1 * body.mass)
    steps = Leapfrog(own, dt, 101)
    steps.take(0, 1001, 10)
    energy = steps.samples.energy
    viscous, boundary, work = energy[[2, 5, 7], -1]
    assert viscous > 0.01 * abs(work)
    assert boundary > 0.01 * abs(work)
    left = energy.sum(axis=0) - 2 * energy[-1]
    assert np.abs(left).max() < 1e-11 * np.abs(energy).max()


def through(joints, omega):
    """Return what joints in a bar of one impedance and speed, Z = c, reflect at the first of them
    and transmit at the last, for exp(i omega t): by the matrices that take velocity and stress
    (tension) through a joint and to the next one, 1 away."""
    found, k = np.tile(np.eye(2, dtype=complex), (len(omega), 1, 1)), omega / Z
    rock = np.array([[np.cos(k), 1j * np.sin(k) / Z], [1j * Z * np.sin(k), np.cos(k)]])
    joint = np.tile(np.eye(2, dtype=complex), (len(omega), 1, 1))
    joint[:, 0, 1] = 1j * omega / NORMAL
    for n in range(joints):
        found = joint @ (rock.transpose(2, 0, 1) @ found if n else found)
    (a, b), (c, d) = found.transpose(1, 2, 0)
    # (t, -Z t) = found (1 + r, -Z (1 - r)), of an incident wave 1, a reflected r, a transmitted t.
    r = (c - d * Z + Z * a - Z * Z * b) / -(Z * a + Z * Z * b + c + d * Z)
    return r, a * (1 + r) - Z * b * (1 - r)


@pytest.mark.parametrize("joints", [1, 4])
def test_a_wave_goes_through_joints_as_it_should(joints):
    """A pulse enters a bar by a quiet side, and leaves by the other: no node of it is still."""
    body, period = stack(1, joints + 1, 12, order=3), 4.0
    ends = np.array([body.sides[name].node[0] for name in ("bottom", "top")])
    quiet = Dashpots(ends, np.full((2, 1, 1), Z))
    own = problem(body, joined(joints, False), nodes=ends, quiet=quiet)
    dt = 0.4 * own.critical_step()

    def pulse(t):
        a = (np.pi * (t / period - 1.5)) ** 2
        return (1 - 2 * a) * np.exp(-a)

    own = own._replace(forces=Force(ends[:1], np.array([2 * Z]), pulse, dt))
    count = int(40.0 / dt)
    steps = Leapfrog(own, dt, count, energy=False)
    steps.take(0, count, 1)
    start, end = steps.samples.velocity
    incident, padded = pulse(dt * np.arange(count)), 4 * count
    omega = 2 * np.pi * np.fft.rfftfreq(padded, dt)
    spectrum = np.fft.rfft(incident, padded) * np.exp(-2j * omega / Z)
    back, there = (np.fft.irfft(spectrum * x, padded)[:count] for x in through(joints, omega))
    for found, exact in ((end, there), (start, incident + back)):
        assert np.linalg.norm(found - exact) < 5e-3 * np.linalg.norm(exact)


def test_a_block_slides_by_what_friction_leaves():
    """A box on a held one, under weight w and a shear force: it accelerates by what the force
    exceeds the strength by, and slips by that."""
    body, weight, friction, force = stack(2, 2, 1, order=1), 3.0, 0.5, 2.0
    below, top = body.sides["bottom"].node, body.sides["top"]
    freedom = (2 * below[:, None] + np.arange(2)).ravel()
    every = blocks_of_nodes(body) == 1
    steady = np.zeros(body.mass.size)
    steady[1::2] = -weight * body.mass[1::2] * every
    steady[::2] = force * body.mass[::2] * every
    strong = joined(1, friction=np.array([friction]))
    own = problem(
        body, strong, top.node, [0, 1], steady=steady, alpha=3.0,
        held=Held(freedom, np.zeros(freedom.size)),
    )  # fmt: skip
    dt = 0.2 * own.critical_step()
    steps = Leapfrog(own, dt, 2001)
    steps.take(0, 2000 * 20 + 1, 20)
    speed = steps.samples.velocity[::2]
    limit = (force - friction * weight) / 3.0  # of mass-proportional damping alone
    np.testing.assert_allclose(speed[:, -1], limit, rtol=1e-6)
    traction = steps.samples.traction[:, -1].reshape(2, 2)
    np.testing.assert_allclose(traction.mean(axis=0), [weight, friction * weight], rtol=1e-6)
    energy = steps.samples.energy
    slid = -steps.samples.jump[1, -1]
    assert 0.9 < energy[3, -1] / (friction * weight * slid) < 1.0
    left = energy.sum(axis=0) - 2 * energy[-1]
    assert np.abs(left).max() < 1e-5 * energy[3, -1]


@pytest.mark.parametrize("dim", [1, 2, 3])
def test_products_by_any_structure_are_the_matrix_times_a_vector(dim, monkeypatch):
    body, random = stack(dim, 13, 1, 1), np.random.default_rng(1)
    K, block = body.stiffness, blocks_of_nodes(body)
    alike = product.product_of(K, dim, block, body.x)
    rows = product.product_of(K, dim, 0 * block, body.x)
    monkeypatch.setattr(product, "CACHE", 0)
    half = product.product_of(K, dim, 0 * block, body.x)
    assert [one.kind for one in (alike, rows, half)] == ["shared", "rows", "half"]
    x = random.standard_normal(K.shape[0])
    for one in (alike, rows, half):
        placed, found = np.zeros((2, one.size))
        placed[one.place] = x
        product.product_for(one.kind, dim)(one.table, placed, found)
        np.testing.assert_allclose(found[one.place], -(K @ x), atol=1e-12 * np.abs(K @ x).max())


@pytest.mark.parametrize("dim", [1, 2, 3])
def test_implicit_steps_move_as_explicit_ones(dim):
    """Joints with friction, open to tension, dashpots, a shaken side and a quiet one."""
    body, bottom, top, quiet = damped(dim)
    along = dim * top.node + dim - 1
    strengths = {"friction": np.array([0.5, 0.4])} if dim > 1 else {}
    own = problem(
        body, joined(2, dim > 1, 0.1, tension=np.zeros(2, bool), **strengths),
        np.append(bottom.node, top.node), [0, 1], alpha=0.2, quiet=quiet,
    )  # fmt: skip
    dt = 0.05 * own.critical_step()
    period = 600 * dt

    def push(t):
        return 0.3 * np.sin(np.pi * np.clip(t / period, 0, 1)) ** 2

    def shake(steps):
        return 2e-2 * dt * np.sin(np.pi * np.clip((steps + 0.5) * dt / period, 0, 1)) ** 2

    freedom, share = dim * bottom.node + dim - 1, bottom.weight
    if dim > 1:
        freedom, share = np.append(freedom, freedom - 1), np.append(share, 0.6 * share)
    own = own._replace(
        forces=Force(freedom, share, push, dt), held=Held(along, -np.ones(along.size), shake)
    )
    one, other = Leapfrog(own, dt, 201), Implicit(own, dt, 201, 1.0)
    for steps in (one, other):
        steps.take(0, 2001, 10)
    for name in ("velocity", "displacement", "traction", "jump"):
        found, known = (getattr(steps.samples, name) for steps in (other, one))
        assert np.linalg.norm(found - known) < 2e-3 * np.linalg.norm(known), name
    energy = other.samples.energy
    if dim > 1:
        assert energy[3, -1] > 1e-3 * energy[-1, -1]
    left = energy.sum(axis=0) - 2 * energy[-1]
    assert np.abs(left).max() < 2e-3 * np.abs(energy).max()


def test_a_column_is_at_rest_under_its_weight():
    """Strain falls linearly, and joints carry what lies on them: exact by elements of order 2."""
    body, modulus, pull = stack(1, 3, 2), 2.0, 0.1
    bottom = body.sides["bottom"].node
    own = problem(body, joined(2, False), steady=-pull * body.mass, held=Held(bottom, np.zeros(1)))
    rest = settled(None, own)
    y, block = body.x[:, 0], blocks_of_nodes(body)
    below = np.cumsum([0.0, *(pull * (3.0 - k) / NORMAL for k in (1.0, 2.0))])
    exact = -pull / modulus * (3.0 * y - y**2 / 2) - below[block]
    np.testing.assert_allclose(rest.u, exact, atol=1e-12 * np.abs(exact).max())
    steps = Leapfrog(own, 0.5 * own.critical_step(), 11)
    steps.start(rest.u, rest.history)
    steps.take(0, 101, 10)
    assert np.abs(steps.u - exact).max() < 1e-12 * np.abs(exact).max()


@pytest.mark.parametrize("dim", [2, 3])
def test_a_wave_in_a_column_of_rock_crosses_its_joint(dim):
    """A P wave between roller sides: behind a joint v' = 2 K / Z (v_incident - v)."""
    up, table = [*np.zeros(dim - 1), 1.0], {"title": "a column"}
    names = ["left", "right", "front", "back"][: 2 * dim - 2]
    places = [[1.0] * (dim - 1) + [z] for z in (4.0, 12.0, 8.0)]
    joint = {"name": "joint", "dip": 0.0, "through": places[2]}
    table |= {
        "domain": {"size": [2.0] * (dim - 1) + [16.0]},
        "rock": {"density": 2600.0, "intact_modulus": 5e10, "intact_poisson": 0.25},
        "joint_sets": [joint | {"normal_stiffness": 1.6e10, "shear_stiffness": 9e9}],
        "waves": [
            {"kind": "P", "direction": up, "shape": "ricker", "amplitude": 1e6, "period": 4e-3}
        ],
        "boundaries": dict.fromkeys(names, "roller") | {"bottom": "quiet", "top": "quiet"},
        "time": {"duration": 0.012},
        "record": {"points": places[:2], "joints": places[2:]},
        "numerics": {"continuum": {"order": 2, "size": 1.0}},
    }
    scene = load_tables(table)
    found, rock = simulate(scene), elastic_rock(scene.rock)
    times = np.linspace(0, 0.012, 24_001)
    incident = free_field(scene)(np.array(places[1:2]), times).velocity[0, -1]
    a = times[1] * 1.6e10 / rock.p_impedance
    behind = lfilter([a, a], [1 + a, a - 1], incident)
    exact = np.interp(found["time"].values, times, behind)
    for quantity, known in (("velocity", exact), ("stress", rock.p_impedance * exact)):
        value = found[quantity].values[1, :, dim - 1]
        assert np.linalg.norm(value - known) < 1e-3 * np.linalg.norm(known), quantity
    pressed = found["traction"].values[0, :, 0]
    assert np.isclose(pressed.max(), rock.p_impedance * behind.max(), rtol=1e-3)
    np.testing.assert_allclose(found["gap"].values[0], -pressed / 1.6e10, atol=1e-12)
    energy = found["energy"].values
    assert np.abs(energy.sum(axis=0) - 2 * energy[-1]).max() < 1e-12 * energy.max()
