"""Chains whose joints carry no tension: those that open and close many times, against an ODE
solver, and those that stay closed."""

from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from jointwave.cases import Scene
from jointwave.cases.loads import late_load
from jointwave.cases.material.calibrate import calibrate
from jointwave.cases.sampling import sample_times
from jointwave.compare.exact.blocks import row_of_blocks
from jointwave.compare.exact.blocks.events import integrate
from jointwave.compare.exact.blocks.pillar import system_of
from jointwave.compare.exact.blocks.row_of_blocks import receivers
from jointwave.compare.misfit.pairs import chaos

D, C = 0.5, 1350.0  # m, about the paper's bar speed, m/s
ENDS = [("free", "free"), ("free", "fixed"), ("quiet", "fixed"), ("free", "quiet")]


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


def of_slopes(scene, times):
    """Return displacements and velocities [n, 2 N] of a chain by DOP853, assembled here, from the
    scene: its steps shrink where a joint opens or closes, and end where the load has a break."""
    p, load = calibrate(scene), late_load(scene)
    k, wall = p.stiffness * p.area, 2 * p.regular_stiffness * p.area
    eta = 0.0 if p.joint_time_constant is None else p.joint_time_constant
    pressed = (scene.prestress.normal if scene.prestress else 0.0) * p.area

    def slope(t, state):
        u, v = np.split(state, 2)
        spring = pressed - k * np.diff(u)
        whole = spring - k * eta * np.diff(v)
        carries = (np.minimum(spring, whole) >= 0) | p.tension
        push = -np.diff(np.where(carries, whole, 0.0) - pressed, prepend=0.0, append=0.0)
        push[0] += p.area * scene.load.direction[1] * load.value(t)
        for kind, b in ((scene.ends.start, 0), (scene.ends.end, -1)):
            if kind == "fixed":
                push[b] -= wall * (u[b] + (p.time_constant or 0.0) * v[b])
            elif kind == "quiet":
                push[b] -= p.impedance * p.area * v[b]
        return np.append(v, push / p.block_mass)

    rows, end = [], np.zeros(2 * scene.pillar.block_count)
    cuts = [0.0, *(t for t in load.breaks if 0 < t < times[-1]), times[-1]]
    for start, stop in pairwise(cuts):
        here = np.append(times[(times >= start) & (times < stop)], stop)
        tight = {"rtol": 1e-11, "atol": 1e-15}
        *within, end = solve_ivp(slope, (start, stop), end, "DOP853", here, **tight).y.T
        rows += within
    return np.array([*rows, end])


@pytest.mark.parametrize(
    "seed", [*range(8), *(pytest.param(s, marks=pytest.mark.slow) for s in range(8, 100))]
)
def test_chains_that_open_and_close_are_those_of_a_tight_ode_solver(seed, tmp_path):
    """Its 1e-11 a step grows as any small difference, to 1e-8 of the motion."""
    scene = random_chain(seed, tmp_path)
    model, times = system_of(scene), sample_times(scene)
    states = integrate(model, late_load(scene), times, scene.load.period).states
    expected = np.split(of_slopes(scene, times), 2, axis=1)
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
    fine = times.astype(np.longdouble)
    finer = integrate(model, late_load(scene), fine, scene.load.period).states.astype(float)
    known = int((times <= found.attrs.get("known_until", np.inf)).sum())
    for name, exact in receivers(scene, model, finer).items():
        wave, bound = found[name].values.reshape(exact.shape), found[f"{name}_error"].values.ravel()
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
    other = integrate(model, late_load(scene), times, 0.002, noise=500.0, seed=7).states
    stress = receivers(scene, model, other)["stress"]
    error, known = stress[0] - found.stress.values[0], times <= until
    assert np.sqrt((error[known] ** 2).mean()) < found.stress_error.values[0]
    assert np.abs(error).max() > 1e-4 * np.abs(stress).max()
    (line,) = chaos({"no-tension-chain": found, "dem": found.drop_attrs()})
    assert line.startswith(f"blocks rattle chaotically: from {until:.4g} s on no-tension chain")


@pytest.mark.parametrize("end", ["free", "quiet", "matched", "fixed"])
def test_joints_pressed_beyond_the_wave_s_tension_are_linear(scene, misfit, end):
    """1 MPa and its echoes, at most twice as large, never open joints under 5 MPa: two solvers, of
    blocks of two masses and under gravity."""
    rock = {"density": 2000.0, "p_speed": 1500.0, "s_speed": 600.0}
    common = {
        "ends": {"start": "free" if end == "free" else "quiet", "end": end},
        "pillar": {"length": 9.0},
        "segments": [{"y": [3.0, 6.0], **rock}],
        "prestress": {"normal": 5e6},
        "gravity": {"direction": [0.0, 1.0, 0.0], "static": end == "fixed"},
        "time": {"duration": 0.03},
        "record": {"stress": [0.0, 1.0, 4.0, 9.0], "velocity": [0.25, 4.25, 8.75]},
    }
    found = row_of_blocks.solve(scene(**common, joints={"tension": False}))
    linear = row_of_blocks.solve(scene(**common))
    for name in ("stress", "velocity", "displacement"):
        assert misfit(found, linear, name) < 1e-11
