"""The bounds that computed solutions give of their own errors, against solutions that are finer."""

import numpy as np
import pytest

from jointwave.cases import Scene
from jointwave.cases.loads import late_load, with_walls
from jointwave.cases.material.calibrate import calibrate
from jointwave.cases.sampling import sample_times
from jointwave.compare.exact.bar import images, modes
from jointwave.compare.exact.blocks import row_of_blocks
from jointwave.compare.exact.blocks.events import integrate
from jointwave.compare.exact.blocks.pillar import system_of
from jointwave.compare.exact.blocks.row_of_blocks import receivers
from jointwave.compare.exact.joint import one_joint

QUANTITIES = ("stress", "velocity", "displacement")


def holds(found, name, exact, sharp=1e-9):
    """Assert that a result's bound holds against exact waveforms [..., n] and is below `sharp` of
    each quantity's peak."""
    waves = np.moveaxis(found[name].values, found[name].dims.index("time"), -1)
    error = np.sqrt(((waves - np.reshape(exact, waves.shape)) ** 2).mean(axis=-1))
    bound = found[f"{name}_error"].values
    assert bound.shape == error.shape
    assert (error <= bound).all(), (name, error, bound)
    assert (bound <= sharp * np.abs(waves).max()).all()


def random_table(scene, seed):
    """Return a row of rigid blocks with any load, ends, dashpots and a soft layer."""
    r = np.random.default_rng(seed)
    table = scene(
        pillar={"length": 0.5 * int(r.integers(3, 12))},
        ends={
            "start": str(r.choice(["free", "quiet", "matched"])),
            "end": str(r.choice(["free", "quiet", "matched", "fixed"])),
        },
        joints={"damping_ratio": r.choice([0.004, 0.05, 0.5])} if r.random() < 0.6 else {},
        soft_layers=[{"y": 1.0, "spacing_stiffness": 4e8 * r.uniform(0.3, 8)}],
        time={"duration": r.uniform(0.02, 0.08)},
        record={"stress": [0.0, 0.7, 1.0], "velocity": [0.0, 0.6, 1.4], "interval": 2e-4},
    ).model_dump(exclude_none=True)
    period = r.uniform(0.002, 0.02)
    load = [
        {"shape": "sine", "period": period, "cycles": int(r.integers(1, 4))},
        {"shape": "ricker", "period": period},
        {"shape": "step"},
    ][r.integers(3)]
    return table | {"load": load | {"amplitude": 1e6}}


#: Where there is no floating-point number finer than double precision.
extended = pytest.mark.skipif(np.finfo(np.longdouble).eps > 1e-18, reason="no extended precision")


@extended
@pytest.mark.parametrize(
    "seed",
    [*range(5), 8, *(pytest.param(s, marks=pytest.mark.slow) for s in (5, 6, 7, *range(9, 80)))],
)
def test_of_the_row_of_blocks(scene, seed):
    """Against Taylor series in extended precision; of every third in space, off the centre."""
    table = random_table(scene, seed)
    if seed % 3 == 0:
        across = {"direction": [0.6, 0, 0.8], "at": [0.1, 0]}
        table["load"] = {"shape": "step", "amplitude": 1e6} | across
    at = Scene.model_validate(table)
    model, times, signal = system_of(at), sample_times(at), late_load(at)
    fine = integrate(model, signal, times.astype(np.longdouble), at.load.period).states
    found = row_of_blocks.solve(at)
    waves = receivers(at, model, fine.astype(float))
    exact = with_walls({name: x.swapaxes(1, -1) for name, x in waves.items()}, at, times)
    for name, x in exact.items():
        if np.abs(x).max() > 0:
            holds(found, name, x.swapaxes(1, -1))


@pytest.mark.parametrize(
    "seed", [*range(4), *(pytest.param(s, marks=pytest.mark.slow) for s in range(4, 40))]
)
def test_of_the_damped_bar_s_modes(scene, seed):
    """Against ten times as many, at any damping. At the loaded end, where the velocity has kinks,
    its terms fall as 1/n^2: 500 of them leave 1/500 of the peak, and the bound is twice that."""
    r = np.random.default_rng(seed)
    at = scene(
        joints={"damping_ratio": 10 ** r.uniform(-2.5, 0.3)},
        load={"period": r.uniform(0.004, 0.02), "cycles": int(r.integers(1, 4))},
        record={"stress": [0.3, r.uniform(1, 49)], "velocity": [0.0, 25.0, r.uniform(1, 49)]},
        time={"duration": 0.06},
    )
    found, finer = modes.solve_damped(at), modes.solve_damped(at, 5000)
    for name in QUANTITIES:
        holds(found, name, finer[name].values, sharp=modes.SAFETY / 500)


def test_of_the_paper_s_series(scene):
    """The truncation error, to the digit: 0.585 % of the stress at 20 m after a hundred terms."""
    at = scene(record={"velocity": [33.3]})
    found, exact = modes.solve(at, 100), images.solve(at)
    for name in QUANTITIES:
        holds(found, name, exact[name].values, sharp=0.1)
    relative = found.stress_error.values / np.sqrt((exact.stress.values**2).mean())
    assert relative == pytest.approx(5.85e-3, abs=5e-5)


@pytest.mark.parametrize("eta", [0.0, 3e-4])
def test_of_one_joint(scene, eta):
    """A sine's closed form: s = p0 (sin wt - w tau cos wt + w tau e^(-t/tau)) / (1 + (w tau)^2)."""
    layer = {"y": 20.0, "spacing_stiffness": 4.375e8} | ({"damping_ratio": 0.05} if eta else {})
    at = scene(
        soft_layers=[layer],
        load={"cycles": 40},
        ends={"start": "quiet", "end": "quiet"},
        record={"stress": [30.0], "velocity": [30.0]},
    )
    p, times = calibrate(at), sample_times(at)
    joint = one_joint.the_joint(p)
    tau, w = joint.time_constant + p.impedance / (2 * joint.stiffness), 200 * np.pi
    t = np.maximum(times - 30.0 / p.bar_speed, 0.0)
    smooth = np.sin(w * t) - w * tau * (np.cos(w * t) - np.exp(-t / tau))
    share = joint.time_constant / tau
    stress = 0.5e6 * (share * np.sin(w * t) + (1 - share) * smooth / (1 + (w * tau) ** 2))
    found = one_joint.solve(at)
    holds(found, "stress", stress[None])
    holds(found, "velocity", stress[None] / p.impedance)
