"""Bodies of a constant quality factor: leapfrog's own modes, stability, energy, static states, and
waves through a layer and a joint as they are exactly."""

import numpy as np
import pytest
from scipy.linalg import eigh

from jointwave.cases.loads import history_of
from jointwave.cases.material.constant_q import fitted, mechanisms_of
from jointwave.cases.material.rock import elastic_rock
from jointwave.cases.material.rock_mass import set_time_constants
from jointwave.continuum.problem import problem_of
from jointwave.continuum.run import simulate
from jointwave.continuum.scene import body_of
from jointwave.continuum.stepping.implicit import Implicit
from jointwave.continuum.stepping.leapfrog import Leapfrog
from jointwave.continuum.stepping.memory import memory_of
from jointwave.continuum.stepping.problem import Problem
from jointwave.continuum.stepping.static import settled
from jointwave.results.dataset import energy_residual
from jointwave.results.snapshots import snapshots_of
from tests.cases.material.test_constant_q import roots
from tests.continuum.bodies import STIFFNESS
from tests.continuum.stacked import readings, stack

ROCK = {"density": 2600.0, "intact_modulus": 5e10, "intact_poisson": 0.2, "quality_factor": 10.0}
ELASTIC = {name: value for name, value in ROCK.items() if name != "quality_factor"}
JOINT = {"dip": 30.0, "through": [3.0, 2.0]}
LOAD = {"kind": "pressure", "side": "top", "shape": "sine", "period": 1e-3, "amplitude": 1e6}
SPEED = np.sqrt(2.0)  # of the bar of `stack`


def of_bar(body):
    """Return a problem of rock with a quality factor in the band of its modes."""
    found = fitted(10.0, SPEED / 2, SPEED / 20, SPEED * 5)
    return Problem(body, readings(body), mechanisms=found)


@pytest.mark.parametrize(("dim", "number"), [(1, 1), (1, 5), (2, 4), (3, 6), (3, 20)])
def test_a_mode_rings_and_decays_as_the_root_of_leapfrog_says(dim, number):
    """Rock of one quality factor has the modes of elastic rock."""
    body = stack(dim, 1, 4 if dim < 3 else 2, 1)
    own = of_bar(body)
    dt = 0.5 * own.critical_step()
    steps = Leapfrog(own, dt, 1)
    square, shapes = eigh(body.stiffness.toarray(), np.diag(body.mass))
    mode = np.zeros(steps.product.size)
    mode[steps.product.place] = shapes[:, number]
    memory, state = memory_of(own.mechanisms, dt), steps.state
    every = roots(memory, square[number] * dt**2, dt)
    z = every[np.argmax(every.imag)]
    state.u[:] = mode
    state.v[:] = state.v_before[:] = mode * (1 - 1 / z).real / dt
    for k, (gain, decay) in enumerate(zip(memory.gain, memory.decay, strict=True)):
        state.elongation[k] = mode * (gain / dt * (z - 1) / (z - decay)).real
    steps.take(0, 400, 1000)
    assert abs(z) < 1 - 1e-5
    assert np.abs(state.u - mode * (z**400).real).max() < 1e-9 * np.abs(mode).max()


@pytest.mark.parametrize("rho", [0.0, 0.8, 1.0])
def test_a_mode_decays_as_one_equation_of_generalised_alpha_says(rho):
    """Its amplitude obeys the formulas of the scheme with numbers in place of vectors."""
    body = stack(1, 1, 4)
    own = of_bar(body)
    dt = 3 * own.critical_step()
    square, shapes = eigh(body.stiffness.toarray(), np.diag(body.mass))
    steps, k, mode = Implicit(own, dt, 1, rho, energy=False), square[3], shapes[:, 3]
    memory, scheme = memory_of(own.mechanisms, dt), steps.scheme
    steps.start(mode, steps.balance.past.history)
    steps.take(0, 51, 1000)
    u, v, e = 1.0, 0.0, np.zeros(len(memory.share))
    a = force = -k * memory.relaxed
    for _ in range(50):
        drift = dt * v + (0.5 - scheme.beta) * dt**2 * a
        # force' = -k (relaxed u' + share (decay e + gain (u' - u) / dt)) is linear in a'.
        soft = memory.tangent(dt)
        at_zero = -k * (memory.relaxed * u + memory.share @ (memory.decay * e) + soft * drift)
        inertia = 1 - scheme.alpha_m + (1 - scheme.alpha_f) * k * soft * scheme.beta * dt**2
        after = (1 - scheme.alpha_f) * at_zero + scheme.alpha_f * force - scheme.alpha_m * a
        after /= inertia
        moved = drift + scheme.beta * dt**2 * after
        u, e = u + moved, memory.decay * e + memory.gain * moved / dt
        v += dt * ((1 - scheme.gamma) * a + scheme.gamma * after)
        a, force = after, -k * (memory.relaxed * u + memory.share @ e)
    np.testing.assert_allclose(steps.now.u, u * mode, atol=1e-9 * np.abs(mode).max())


@pytest.mark.parametrize("quality", [5.0, 20.0, 500.0])
@pytest.mark.parametrize("rate", [1e-3, 0.1, 1.0, 10.0, 1e3])
def test_no_motion_grows_up_to_the_critical_step_of_the_unrelaxed_rock(quality, rate):
    """rate : steps over the period of the fastest mechanism. Beyond the critical step motion grows
    where nothing relaxes within a step; else the rock is a little softer there."""
    found = fitted(quality, 100.0, 10.0, 1000.0)
    dt = rate / found.frequency.max()
    memory = memory_of(found, dt)
    for x in np.linspace(0.01, 4, 60).tolist():
        assert np.abs(roots(memory, x, dt)).max() <= 1 + 1e-9
    slow = memory_of(found, 1e-6 / found.frequency.max())
    assert np.abs(roots(slow, 4.01, 1e-6 / found.frequency.max())).max() > 1.05


def test_energy_stays_bounded_at_the_critical_step():
    body = stack(2, 2, 2, 2)
    own = of_bar(body)._replace(law=None)
    steps = Leapfrog(own, 0.9999 * own.critical_step(), 1, energy=False)
    steps.throw(np.random.default_rng(0).standard_normal(body.mass.size))
    start = np.abs(steps.v).max()
    steps.take(0, 5000, 10_000)
    assert np.abs(steps.v).max() < start


@pytest.mark.parametrize("scheme", ["explicit", "implicit"])
@pytest.mark.parametrize("rest", [False, True])
def test_the_ledger_closes_and_mechanisms_only_lose(rock_mass, scheme, rest):
    """With quiet sides, mass damping and dashpots; from a state at rest under its weight."""
    sides = {"bottom": "fixed", "left": "roller", "right": "roller" if rest else "quiet"}
    scene = rock_mass(
        {**JOINT, "damping_ratio": 0.05}, rock=ROCK, loads=[LOAD], boundaries=sides,
        continuum={"scheme": scheme, "spectral_radius": 1.0, "steps_per_period": 100},
        record={"points": [[2.0, 3.0]], "interval": 2e-5},
        **({"gravity": {}} if rest else {"damping": {"mass_proportional": 50.0}}),
    )  # fmt: skip
    result = simulate(scene)
    assert energy_residual(result) < 1e-10
    lost = result["energy"].sel(term="viscous").values
    assert abs(lost[0]) < 1e-10 * np.abs(result["energy"]).max()
    assert lost[-1] > 0 and np.diff(lost).min() >= -1e-10 * np.abs(lost).max()


@pytest.mark.parametrize("scheme", ["explicit", "implicit"])
def test_weight_at_rest_stays_at_rest_on_relaxed_rock(rock_mass, scheme):
    tables = {
        "boundaries": {"bottom": "fixed", "left": "roller", "right": "roller"},
        "loads": [LOAD | {"amplitude": 1e-6}],
        "gravity": {},
        "continuum": {"scheme": scheme},
    }
    scene, elastic = (rock_mass(rock=one, **tables) for one in (ROCK, ELASTIC))
    result = simulate(scene)
    assert float(np.abs(result["velocity"]).max()) < 1e-12
    u = [settled(one, problem_of(one, body_of(one, "jointed"))).u for one in (scene, elastic)]
    found = mechanisms_of(scene, "jointed")
    known = u[1] / (found.unrelaxed * found.relaxed)
    np.testing.assert_allclose(u[0], known, rtol=0, atol=1e-12 * np.abs(known).max())


def column(rock_mass, **continuum):
    """Return 20 m of rock between rollers with a joint in it, pushed on top."""
    tables = {
        "domain": {"size": [4.0, 20.0]},
        "loads": [LOAD | {"shape": "ricker", "period": 2.5e-3}],
        "boundaries": {"left": "roller", "right": "roller", "bottom": "quiet"},
        "time": {"duration": 0.015},
        "record": {"points": [[2.0, 16.0], [2.0, 8.0]], "interval": 1e-4},
    }
    joint = {"dip": 0.0, "through": [2.0, 12.0], "damping_ratio": 0.05}
    elements = {"order": 4, "size": 2.0, "spectral_radius": 0.9}
    return rock_mass(joint, rock=ROCK, continuum=elements | continuum, **tables)


def exact(scene, times):
    """Return velocities at the points of a column [points, times], by waves down and up in each
    layer: v = A exp(-s x / c) + B exp(s (x - h) / c), compression rho c (A .. - B ..)."""
    rock, found, height = elastic_rock(scene.rock), mechanisms_of(scene, "jointed"), 20.0
    step, many, decay = times[1] / 20, 40 * len(times), 100.0
    t = step * np.arange(many)
    window = np.exp(-decay * t)  # no wave comes around
    load = scene.loads[0]
    pressed = history_of(load, load.amplitude).value(t)
    s = decay + 2j * np.pi * np.fft.rfftfreq(many, step)
    density, modulus = rock.density, rock.density * rock.p_speed**2 * found.modulus(s)
    slow, Z = np.sqrt(density / modulus), np.sqrt(density * modulus)
    k = STIFFNESS[0] * (1 + s * set_time_constants(scene)[0])
    ends = [(0.0, 8.0), (8.0, height)]
    A = np.zeros((len(s), 4, 4), complex)

    def wave(layer, x):
        begin, end = ends[layer]
        return np.exp(-s * slow * (x - begin)), np.exp(s * slow * (x - end))

    for layer in (0, 1):
        down, up = wave(layer, 8.0)
        sign = 1 - 2 * layer
        A[:, 1, 2 * layer], A[:, 1, 2 * layer + 1] = sign * Z * down, -sign * Z * up
        for column_, motion, stress in ((2 * layer, down, Z * down), (2 * layer + 1, up, -Z * up)):
            A[:, 2, column_] = sign * motion - (layer == 0) * s / k * stress
    (down, up), (first, last) = wave(0, 0.0), wave(1, height)
    A[:, 0, 0], A[:, 0, 1] = Z * down, -Z * up
    A[:, 3, 2], A[:, 3, 3] = (Z - rock.p_impedance) * first, -(Z + rock.p_impedance) * last
    right = np.zeros((len(s), 4), complex)
    right[:, 0] = np.fft.rfft(window * pressed)
    found = np.linalg.solve(A, right[..., None])[..., 0]
    rows = []
    for _, y in scene.record.points:
        layer = int(y < 12.0)
        down, up = wave(layer, height - y)
        v = np.fft.irfft(found[:, 2 * layer] * down + found[:, 2 * layer + 1] * up, many) / window
        rows.append(-v[: 20 * len(times) : 20])
    return np.array(rows)


@pytest.mark.parametrize("scheme", ["explicit", "implicit"])
def test_waves_come_to_the_exact_ones_at_second_order(rock_mass, scheme):
    """Elements of order 4 leave the error of the steps alone."""
    error, dt = [], []
    for fraction, many in ((1.0, 100), (0.5, 200)):
        scene = column(rock_mass, scheme=scheme, step_fraction=fraction, steps_per_period=many)
        result = simulate(scene)
        known = exact(scene, result["time"].values)
        error.append(np.linalg.norm(result["velocity"][..., 1] - known) / np.linalg.norm(known))
        dt.append(result.attrs["dt"])
    assert error[1] < 1.5e-3
    assert np.log(error[0] / error[1]) / np.log(dt[0] / dt[1]) == pytest.approx(2, abs=0.1)


def test_without_a_quality_factor_nothing_of_it_is_there(rock_mass):
    scene = rock_mass(JOINT, rock=ELASTIC, loads=[LOAD])
    own = problem_of(scene, body_of(scene, "jointed"))
    steps = Leapfrog(own, 0.5 * own.critical_step(), 1)
    assert own.mechanisms is None and not steps.flags.relaxing
    assert not any(
        one.size for one in (steps.state.elongation, steps.work.strained, steps.work.rock)
    )
    implicit = Implicit(own, 1e-4, 1, 0.9)
    assert implicit.now.forces.past.elongation.size == 0


@pytest.mark.parametrize("scheme", ["explicit", "implicit"])
def test_snapshots_have_the_stress_that_receivers_record(rock_mass, scheme):
    """A receiver in the middle of a linear element of the only two in the rock reads its stress."""
    scene = rock_mass(
        rock=ROCK, loads=[LOAD], boundaries={"bottom": "fixed"},
        domain={"size": [6.0, 4.0]}, continuum={"scheme": scheme, "size": 4.0},
        record={"points": [[1.5, 2.0]], "interval": 2e-5, "fields": 4e-5},
    )  # fmt: skip
    result = simulate(scene)
    shots = snapshots_of(result)
    every = round(4e-5 / 2e-5)
    known = result["stress"].values[0, ::every]
    away = shots.points[shots.cells].mean(axis=1)[:, :2] - [1.5, 2.0]
    cell = int(np.linalg.norm(away, axis=1).argmin())
    np.testing.assert_allclose(
        shots.stress[:, cell], known, rtol=0, atol=1e-9 * np.abs(known).max()
    )
