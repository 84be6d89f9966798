"""The Laplace bars against parallel joints, attenuation, images of other loads, and each other."""

from dataclasses import replace

import numpy as np
import pytest

from closed_forms.parallel_joints import transmission
from jointwave.cases import Scene
from jointwave.cases.histories import Recorded, Sine, Step
from jointwave.cases.material.calibrate import calibrate
from jointwave.compare.exact.bar import images, laplace
from jointwave.compare.exact.bar.bars import EQUIVALENT, JOINTED, bar_of
from jointwave.compare.exact.bar.modes import solve_damped, sums
from jointwave.compare.exact.bar.transfer import Bar, End, RockFrom, transfer

NONE = np.zeros(0)
ROCK = Bar(1000.0, (RockFrom(0.0, 2400.0, 4e9, 0.0),), NONE, NONE, NONE, End(0.0), End(0.0))
Z = np.sqrt(2400.0 * 4e9)


def wavenumber(omega: np.ndarray | float, speed: float, eta: float) -> np.ndarray:
    """Return k (1/m) of e^{i(omega t - k y)}: k = omega / (c sqrt(1 + i omega eta)).

    The phase speed is omega / Re k and the attenuation -Im k, about omega^2 eta / 2c.
    """
    return np.asarray(omega / (speed * np.sqrt(1 + 1j * np.asarray(omega) * eta)))


@pytest.mark.parametrize("count", [2, 3, 5])
@pytest.mark.parametrize("ratio", [0.05, 0.1, 0.2])
def test_parallel_joints_transmit_as_in_closed_form(count, ratio):
    """|T| at kappa = K/(Z omega) = 1, by spacing over wavelength; a wave of 1 enters the bar behind
    a dashpot for an end stress of 2."""
    omega = 100.0
    spacing = ratio * 2 * np.pi * np.sqrt(4e9 / 2400) / omega
    y, ones = 100 + spacing * np.arange(count), np.ones(count)
    bar = replace(
        ROCK,
        joint_y=y,
        joint_compliance=ones / (Z * omega),
        joint_time_constant=0 * ones,
        start=End(Z),
        end=End(Z),
    )
    stress, _ = transfer(bar, np.array([1e-9 + 1j * omega]), np.array([900.0]))
    assert abs(2 * stress[0, 0]) == pytest.approx(transmission(count, 1.0, ratio), rel=1e-9)


def test_a_damped_wave_decays_and_disperses_as_its_wavenumber():
    """Between two receivers of a bar so long that nothing comes back: e^{-i k (y2 - y1)}."""
    omega, eta = np.array([200.0, 2000.0]), 1e-3
    bar = replace(ROCK, length=1e6, rocks=(RockFrom(0.0, 2400.0, 4e9, eta),))
    stress, _ = transfer(bar, 1j * omega, np.array([3.0, 10.0]))
    k = wavenumber(omega, np.sqrt(4e9 / 2400), eta)
    assert np.allclose(stress[1] / stress[0], np.exp(-7j * k), rtol=1e-12)


@pytest.mark.parametrize("front", [True, False])
def test_a_step_and_a_record_arrive_as_images_say(misfit, monkeypatch, front):
    """With the part in front of the first joint apart it is round-off. Inverted as a whole, a
    triangle is off at its three kinks, by the least of what the record resolves; a step within two
    fine steps, a tenth of a sample each, of its dozen jumps: at most 12 of 2000 samples by half of
    a jump, 4 %."""
    monkeypatch.setattr(laplace, "MOST_TRIPS", laplace.MOST_TRIPS if front else 0)
    c = np.sqrt(4e9 / 2400)
    bar, times = replace(ROCK, length=60.0), np.linspace(0, 0.25, 2001)
    triangle = Recorded(np.array([0.0, 0.01, 0.04]), np.array([0.0, 1e6, 0.0]))
    for load, bound in ((triangle, 9e-6), (Step(1e6), 4e-2)):
        stress, velocity, displacement = laplace.bounded(bar, load, times, [21.0], [33.0])[0]
        bound = 1e-9 if front else bound
        there, back = images.images(load.value, [21.0], times, 60.0, c)
        assert misfit(stress, there + back) < bound
        there, back = images.images(load.value, [33.0], times, 60.0, c)
        assert misfit(velocity, (there - back) / Z) < bound
        there, back = images.images(load.impulse, [33.0], times, 60.0, c)
        assert misfit(displacement, (there - back) / Z) < 1e-7


def random_bar(scene, folder, seed):
    """Return a solution and a scene of a jointed or homogenised bar with any load, layers and ends,
    with receivers on its ends, on joints and between."""
    r = np.random.default_rng(seed)
    (folder / "load.csv").write_text("0.001,0.4\n0.004,1\n0.0131,-0.7\n0.02,0.2\n")
    load = [
        {"shape": "sine", "period": r.uniform(0.004, 0.02), "cycles": int(r.integers(1, 3))},
        {"shape": "ricker", "period": r.uniform(0.004, 0.02)},
        {"shape": "table", "file": "load.csv"},
    ][r.integers(3)]
    table = scene(
        pillar={"length": 10.0},
        ends={
            "start": str(r.choice(["free", "quiet", "matched"])),
            "end": str(r.choice(["free", "quiet", "matched", "fixed"])),
        },
        joints={"damping_ratio": r.choice([0.004, 0.05, 0.5])} if r.random() < 0.4 else {},
        soft_layers=[
            {"y": 0.5 * int(r.integers(1, 20)), "spacing_stiffness": 4e8 * r.uniform(0.3, 8)}
            | ({"damping_ratio": 0.02} if r.random() < 0.5 else {})
        ],
        time={"duration": r.uniform(0.02, 0.06)},
        record={
            "stress": [r.uniform(0.1, 0.4), 0.5, r.uniform(1, 9)],
            "velocity": [0.0, 0.5, r.uniform(1, 9), 10.0],
        },
    ).model_dump(exclude_none=True)
    table["load"] = load | {"amplitude": 1e6}
    solution = EQUIVALENT if r.random() < 0.5 else JOINTED
    return solution, Scene.model_validate(table, context={"folder": folder})


@pytest.mark.parametrize(
    "seed", [0, 3, 7, 8, *(pytest.param(s, marks=pytest.mark.slow) for s in range(9, 150))]
)
def test_the_bound_of_the_error_holds(scene, tmp_path, monkeypatch, seed):
    """Against steps many times as fine in a longer window."""
    solution, at = random_bar(scene, tmp_path, seed)
    monkeypatch.setattr(laplace, "CHEAP", laplace.CHEAP / 8)
    found = solution.run(at)
    monkeypatch.setattr(laplace, "CHEAP", 8 * laplace.CHEAP)
    monkeypatch.setattr(laplace, "FINER", 4 * laplace.FINER)
    monkeypatch.setattr(laplace, "TAIL", 2.5)
    finer = solution.run(at)
    for name in ("stress", "velocity", "displacement"):
        waves, exact = (
            x[name].values.reshape(-1, len(x.time)).astype(float) for x in (found, finer)
        )
        bound = found[f"{name}_error"].values.ravel()
        error = np.sqrt(((waves - exact) ** 2).mean(axis=1))
        assert (error <= bound).all(), (name, error / bound)


def test_the_pillar_s_stress_is_known_to_a_millionth(scene):
    """A tenth of the bounds of 1e-5 that scenes may set is then judged: inside the rock, at any
    joint and behind; in front of the first joint, where kinks return 700 times, to 1e-4."""
    found = JOINTED.run(scene(record={"velocity": [0.0, 20.0, 33.3]}))
    for name in ("stress", "velocity", "displacement"):
        waves = found[name].values.reshape(-1, len(found.time))
        relative = found[f"{name}_error"].values.ravel() / np.sqrt((waves**2).mean(axis=1))
        assert (relative[-2:] < 1e-6).all() and (relative < 1e-4).all()


def test_fine_joints_are_the_homogenised_bar(scene, misfit):
    """Joints d apart that hold a share p of the compliance slow a wave by (omega d p / c)^2 / 24,
    as cos(kd) = cos(omega d/c_0) - (omega z/2K) sin(omega d/c_0) expands. Over the 0.06 s that a
    Ricker wavelet travels here, whose omega^3 is 2.2 omega_p^3 in the mean square, that leaves
    2.2 omega_p 0.06 s (omega_p d p / c)^2 / 24 = 6.6e-4, and a quarter for half the spacing."""
    off = []
    for block in (0.25, 0.125):
        at = scene(
            pillar={"block": block},
            load={"shape": "ricker", "period": 0.04},
            record={"interval": 2e-4},
        )
        off.append(misfit(JOINTED.run(at), EQUIVALENT.run(at)))
    assert off[0] < 6.6e-4
    assert np.log2(off[0] / off[1]) == pytest.approx(2, abs=0.05)


@pytest.mark.parametrize("zeta", [0.02, 0.1, 1.5])
def test_the_damped_bar_s_modes_agree(scene, misfit, zeta):
    """Each to its own bound; both are smooth but at y = 0, where kinks of the load fall on
    samples."""
    at = scene(joints={"damping_ratio": zeta})
    modes, laplace_bar = solve_damped(at), EQUIVALENT.run(at)
    for variable in ("stress", "velocity", "displacement"):
        assert misfit(modes, laplace_bar, variable) < 9e-5


def test_over_and_critically_damped_modes_satisfy_their_equation():
    """q'' + eta omega^2 q' + omega^2 q = f by differences of a fine sampling, which err by
    (dt/T)^2 about 1e-6 and amplify round-off to 1e-7."""
    load, mode, t = Sine(1.0, 0.01), 900.0, np.linspace(0, 0.0099, 20_001)
    for ratio in (0.3, 1.0, 1.0 + 1e-8, 2.0):
        eta = 2 * ratio / mode
        (q,), (rate,) = sums(np.ones((1, 1)), np.array([mode]), eta, load, t)
        assert np.abs(np.gradient(q, t) - rate)[2:-2].max() < 1e-6 * np.abs(rate).max()
        left = np.gradient(rate, t) + eta * mode**2 * rate + mode**2 * q
        assert np.abs(left - load.value(t))[2:-2].max() < 1e-6


def test_a_soft_layer_adds_its_excess_compliance_only(scene, soft):
    p = calibrate(scene(soft_layers=soft))
    bar = bar_of(scene(soft_layers=soft), resolved=False)
    assert np.flatnonzero(bar.joint_compliance).tolist() == [39]
    assert 1 / bar.joint_compliance[39] == pytest.approx(
        1 / (1 / p.stiffness[39] - 0.5 / p.modulus), rel=1e-12
    )
    ordinary = bar_of(scene(soft_layers=[{"y": 20.0}]), resolved=False)
    assert not ordinary.joint_compliance.any()


def test_a_recorded_load_reaches_the_scene(scene, misfit, tmp_path):
    """The same triangle through a scene: images and the Laplace bar."""
    (tmp_path / "blast.csv").write_text("0,0\n0.01,1\n0.04,0\n")
    table = scene().model_dump(exclude_none=True)
    table["load"] = {"shape": "table", "amplitude": 1e6, "file": "blast.csv"}
    at = Scene.model_validate(table, context={"folder": tmp_path})
    assert misfit(EQUIVALENT.run(at), images.solve(at)) < 9e-5
