"""Chains whose joints carry no tension: those that open and close many times, against matrix
exponentials, and those that stay closed."""

from itertools import pairwise

import numpy as np
import pytest
from scipy.linalg import expm
from scipy.optimize import brentq

from jointwave.cases import Scene
from jointwave.cases.loads import load_history
from jointwave.cases.material.calibrate import calibrate
from jointwave.cases.sampling import sample_times
from jointwave.compare.exact.blocks import row_of_blocks
from jointwave.compare.exact.blocks.events import integrate
from jointwave.compare.exact.blocks.pillar import system_of
from jointwave.compare.exact.blocks.row_of_blocks import receivers
from jointwave.compare.exact.conditions import drive

D, C = 0.5, 1350.0  # m, about the paper's bar speed, m/s
ENDS = [("free", "free"), ("free", "fixed"), ("quiet", "fixed"), ("free", "quiet")]

FIELDS = ("stress", "velocity", "displacement")


def random_chain(seed, folder):
    """Return a chain of 4 to 9 blocks whose joints open and close, under a load of any shape."""
    r = np.random.default_rng(seed)
    n, period = int(r.integers(4, 10)), D / C * r.uniform(3, 25)
    duration = D / C * r.uniform(60, 120)
    loads = [
        {"shape": "sine", "period": period, "cycles": int(r.integers(1, 4))},
        {"shape": "step"},
        {"shape": "table", "file": "random.csv"},
    ]
    rows = zip(np.sort(r.uniform(0, duration / 2, 8)), r.normal(size=8), strict=True)
    (folder / "random.csv").write_text("".join(f"{t},{p}\n" for t, p in rows))
    start, end = ENDS[r.integers(4)]
    table = {
        "title": f"random chain {seed}",
        "pillar": {"length": n * D, "side": 0.5, "block": D},
        "rock": {"density": 2400.0, "p_speed": 2200.0, "s_speed": 800.0},
        "joints": {"tension": False},
        "ends": {"start": start, "end": end},
        "load": loads[r.integers(3)] | {"amplitude": 1e6 * r.choice([-1.0, 1.0])},
        "time": {"duration": duration},
        "record": {
            "stress": [0.0, n * D / 2, n * D],
            "velocity": [D / 2, n * D - D / 2],
            "interval": duration / 200,
        },
    }
    if zeta := [None, 0.004, 0.05, 0.3][r.integers(4)]:
        table["joints"]["damping_ratio"] = zeta
    if r.random() < 0.4:
        layer = {"y": D * int(r.integers(1, n)), "spacing_stiffness": 4e8 * r.uniform(0.3, 3)}
        table["soft_layers"] = [layer | {"tension": bool(r.random() < 0.5)}]
    if r.random() < 0.3:
        table["prestress"] = {"normal": 10 ** r.uniform(4, 6)}
    return Scene.model_validate(table, context={"folder": folder})


def of_modes(scene, times, finest=0.05):
    """Return displacements and velocities [n, 2 N] of a chain by matrix exponentials, each joint
    looked at `finest` of the highest frequency's radian apart; assembled here, from the scene.

    The load is a part of the state: (s, s') with s'' = -omega^2 s, or straight pieces s'' = 0.
    """
    p, load = calibrate(scene), load_history(scene)
    n, m = scene.pillar.block_count, p.block_mass
    k, half = p.stiffness * p.area, 2 * p.regular_stiffness * p.area
    eta = np.zeros(n - 1) if p.joint_time_constant is None else p.joint_time_constant
    pressed = (scene.prestress.normal if scene.prestress else 0.0) * p.area
    omega = 2 * np.pi / scene.load.period if scene.load.shape == "sine" else 0.0

    def matrix(closed):
        A = np.zeros((2 * n + 3, 2 * n + 3))  # u, v, s, s', 1
        A[:n, n : 2 * n] = np.eye(n)
        A[n, -3] += p.area * scene.load.direction[1]
        A[-3, -2], A[-2, -3] = 1, -(omega**2)
        for j in range(n - 1):
            force = np.zeros(2 * n + 3)  # of the joint on its right block, less the prestress
            if closed[j]:
                force[j], force[j + 1] = k[j], -k[j]
                force[n + j], force[n + j + 1] = k[j] * eta[j], -k[j] * eta[j]
            else:
                force[-1] = -pressed
            A[n + j] -= force
            A[n + j + 1] += force
        for kind, b in zip((scene.ends.start, scene.ends.end), (0, n - 1), strict=True):
            if kind == "fixed":
                A[n + b, b] -= half
                A[n + b, n + b] -= half * (p.time_constant or 0.0)
            if kind == "quiet":
                A[n + b, n + b] -= p.impedance * p.area
        A[n : 2 * n] /= m
        return A

    def carries(y):
        spring = pressed - k * np.diff(y[:n])
        return (np.minimum(spring, spring - k * eta * np.diff(y[n : 2 * n])) >= 0) | p.tension

    known = {}

    def advance(closed, h):
        key = closed.tobytes(), h
        if key not in known:
            known[key] = expm(matrix(closed) * h)
        return known[key]

    y, out = np.zeros(2 * n + 3), [np.zeros(2 * n)]
    y[-1] = 1
    closed, cuts = np.ones(n - 1, bool), {0.0, *load.breaks}
    longest = finest * np.sqrt(m / half) / 2
    nodes = np.unique([*times, *(c for c in cuts if c < times[-1])])
    for a, b in pairwise(nodes):
        if a in cuts:
            inside = np.array([a + 1e-9 * (b - a), b - 1e-9 * (b - a)])
            f, later = load.value(inside)
            y[-3], y[-2] = f, (later - f) / (inside[1] - inside[0])
            if omega:
                y[-3], y[-2] = load.value(np.array([a]))[0], 0.0
                if a < load.end:
                    y[-2] = load.amplitude * omega
        count = int(np.ceil((b - a) / longest))
        h, done = (b - a) / count, 0.0
        for _ in range(count):
            while True:
                new = advance(closed, h) @ y if done == 0 else expm(matrix(closed) * (h - done)) @ y
                changed = np.flatnonzero(carries(new) != closed)
                if not len(changed):
                    break
                A = matrix(closed)

                def excess(s, joints=changed, A=A, y=y, closed=closed):
                    return 0.5 - (carries(expm(A * s) @ y) != closed)[joints].any()

                s = brentq(excess, 0, h - done, xtol=1e-14 * h) if excess(0) > 0 else 0.0
                y, done = expm(A * s) @ y, done + s
                later = carries(expm(A * 1e-9 * h) @ y)
                closed = np.where(later != closed, later, closed)
            y, done = new, 0.0
        if b in times:
            out.append(y[: 2 * n].copy())
    return np.array(out)


@pytest.mark.parametrize(
    "seed", [*range(8), *(pytest.param(s, marks=pytest.mark.slow) for s in range(8, 100))]
)
def test_chains_that_open_and_close_are_those_of_matrix_exponentials(seed, tmp_path):
    """Which see every event but those that are undone within a twentieth of a radian: the impulse
    of such a touch is below 0.05^3/12 = 1e-5 of a joint's, and grows as any small difference."""
    scene = random_chain(seed, tmp_path)
    model, times = system_of(scene), sample_times(scene)
    states = integrate(model, drive(scene), times, scene.load.period).states
    expected = np.split(of_modes(scene, times), 2, axis=1)
    for matrix, motion in zip((model.displacement, model.velocity), expected, strict=True):
        assert np.linalg.norm(states @ matrix.T - motion) < 1e-6 * np.linalg.norm(motion)


@pytest.mark.parametrize(
    "seed", [*range(100, 104), *(pytest.param(s, marks=pytest.mark.slow) for s in range(104, 200))]
)
def test_the_bound_of_the_error_holds(seed, tmp_path):
    """Against the same motion in extended precision, 2,000 times finer where there is such a type;
    no bound is so wide that it would keep a difference of 1e-4 from being judged."""
    if np.finfo(np.longdouble).eps > 1e-18:
        pytest.skip("no extended precision here")
    scene = random_chain(seed, tmp_path)
    model, times, found = system_of(scene), sample_times(scene), row_of_blocks.solve(scene)
    finer = integrate(
        model, drive(scene), times.astype(np.longdouble), scene.load.period
    ).states.astype(float)
    known = int((times <= found.attrs.get("known_until", np.inf)).sum())
    for name, exact in receivers(scene, model, finer).items():
        wave = found[name].values[..., 0] if found[name].ndim == 3 else found[name].values
        bound = found[f"{name}_error"].values.ravel()
        error = np.sqrt(((wave - exact)[:, :known] ** 2).mean(axis=1))
        assert (error <= bound).all()
        assert (bound <= 1e-5 * np.abs(wave[:, :known]).max()).all()


def test_the_time_is_said_from_which_bouncing_is_chaotic(tmp_path):
    """Undamped blocks under their weight on a wall: two solutions that are 1e-13 apart at each step
    part, and not before that time."""
    table = random_chain(0, tmp_path).model_dump(exclude_none=True) | {
        "joints": {"tension": False},
        "soft_layers": [],
        "ends": {"start": "free", "end": "fixed"},
        "pillar": {"length": 5.0, "side": 0.5, "block": 0.5},
        "load": {"shape": "sine", "period": 0.002, "amplitude": 1e6},
        "gravity": {"direction": [0, 1, 0], "static": True},
        "time": {"duration": 0.1},
        "record": {"stress": [2.5], "velocity": [1.0], "interval": 1e-4},
    }
    scene = Scene.model_validate(table)
    model, times, found = system_of(scene), sample_times(scene), row_of_blocks.solve(scene)
    until = found.attrs["known_until"]
    assert 0.03 < until < 0.09
    other = integrate(model, drive(scene), times, 0.002, noise=500.0, seed=7).states
    stress = receivers(scene, model, other)["stress"]
    error, known = stress[0] - found.stress.values[0], times <= until
    assert np.sqrt((error[known] ** 2).mean()) < found.stress_error.values[0]
    assert np.abs(error).max() > 1e-4 * np.abs(stress).max()


def test_momentum_is_the_load_s_impulse_between_free_ends(scene):
    tables = {"pillar": {"length": 10.0}, "record": {"stress": [5.0], "velocity": []}}
    at = scene(**tables, joints={"tension": False}, time={"duration": 0.03})
    model, load, times = system_of(at), load_history(at), sample_times(at)
    velocity = integrate(model, load, times).states @ model.velocity.T
    momentum = calibrate(at).block_mass * velocity.sum(axis=1)
    impulse = load.impulse(times) * at.pillar.area
    assert np.abs(momentum - impulse).max() < 1e-12 * impulse.max()


@pytest.mark.parametrize("end", ["free", "quiet", "matched", "fixed"])
def test_joints_pressed_beyond_the_wave_s_tension_are_linear(scene, misfit, end):
    """1 MPa and its echoes, at most twice as large, never open joints under 5 MPa: two solvers, of
    blocks of two masses and under gravity."""
    rock = {"density": 2000.0, "p_speed": 1500.0, "s_speed": 600.0}
    common = {
        "ends": {"start": "free" if end == "free" else "quiet", "end": end},
        "pillar": {"length": 15.0},
        "segments": [{"y": [5.0, 10.0], **rock}],
        "prestress": {"normal": 5e6},
        "gravity": {"direction": [0.0, 1.0, 0.0], "static": end == "fixed"},
        "time": {"duration": 0.03},
        "record": {"stress": [0.0, 1.0, 7.0, 15.0], "velocity": [0.25, 7.25, 14.75]},
    }
    found = row_of_blocks.solve(scene(**common, joints={"tension": False}))
    linear = row_of_blocks.solve(scene(**common))
    assert max(misfit(found[name], linear[name]) for name in FIELDS) < 1e-11
