"""A joint that stiffens, by both engines in every dimension, against its exact solution.

A sine of wavelength 40 m in a bar of 2000 m/s; k_ni / (Z omega) = 0.5, and the incident peak is
that of the initial stiffness times the maximum closure: p0 / (k_ni d_m) = 1."""

from contextlib import suppress
from math import pi

import numpy as np
import pytest

from jointwave import continuum, dem
from jointwave.cases.errors import StoppedError
from jointwave.cases.histories import Sine
from jointwave.compare.exact.joint import closing_joint
from jointwave.compare.exact.joint.closing_joint import ClosingJoint, Passed
from jointwave.compare.misfit.metrics import misfit
from jointwave.continuum import problem
from jointwave.joints import law
from jointwave.results.dataset import energy_residual

PERIOD, DENSITY, SPEED, PEAK = 0.02, 2400.0, 2000.0, 1e6
MODULUS = DENSITY * SPEED**2
ROCK = {"density": DENSITY, "equivalent_modulus": MODULUS, "equivalent_poisson": 0.2}
ALL_OF_IT = {"intact_modulus": MODULUS * (1 + 1e-6)}  # has the compliance of the rock mass
STIFFNESS = 0.5 * DENSITY * SPEED * 2 * pi / PERIOD


@pytest.fixture
def closing(pillar):
    """A function of changes: the scene, whose rock has all of its compliance outside the joints."""
    layer = {"y": 20.0, "normal_stiffness": STIFFNESS, "maximum_closure": PEAK / STIFFNESS}

    def scene(**changes):
        tables = {
            "pillar": {"length": 40.0, "side": 0.5, "block": 0.05},
            "rock": ROCK | ALL_OF_IT,
            "load": {"shape": "sine", "amplitude": PEAK, "period": PERIOD},
            "soft_layers": [layer],
            "prestress": {"normal": 0.0},
            "ends": {"start": "free", "end": "matched"},
            "time": {"duration": 0.024},
            "record": {"stress": [30.0], "velocity": [30.025], "interval": 1e-4},
            "numerics": {"dem": {"step_fraction": 0.5}, "continuum": {"steps_per_period": 1000}},
        }
        return pillar(**tables | changes)

    return scene


HALF = Sine(1.0, 2 * pi, 0.5)


@pytest.mark.parametrize(
    ("ratio", "peak"), [(1e-9, 0.7562), (0.5, 0.8699), (1.0, 0.9434), (2.0, 0.9919)]
)
def test_peak_of_half_a_sine(ratio, peak):
    """Over p0, at p0 / (k_ni d_m) = ratio and k_ni / (Z omega) = 0.5, to four digits; a twin of a
    thousandth of the accuracy is within 1e-7."""
    joint, t = ClosingJoint(0.0, 0.5, 2 / ratio), np.linspace(0, 4, 40_001)
    stress, _ = Passed(joint, 1.0, HALF, 4.0)(t)
    assert stress.max() == pytest.approx(peak, abs=5e-5)
    twin, _ = Passed(joint, 1.0, HALF, 4.0, tolerance=1e-9)(t)
    assert np.abs(twin - stress).max() < 1e-7


def test_impulse_is_the_integral():
    """Of what passes, by trapezoids: they are off by h^2 / 12 times the rate, which is below 2 over
    the least e' = 1 / (0.5 * 3.8^2) - 0.1."""
    joint, t = ClosingJoint(0.0, 0.5, 1.0, 0.1, 0.4), np.linspace(0, 4, 8001)
    stress, impulse = Passed(joint, 1.0, HALF, 4.0)(t)
    sums = np.append(0, np.cumsum((stress[1:] + stress[:-1]) / 2 * np.diff(t)))
    off = (4 / 8000) ** 2 / 12 * 2 / (1 / 7.22 - 0.1)
    assert impulse == pytest.approx(sums, abs=off)


def bar(scene):
    return continuum.simulate(scene, model="equivalent")


@pytest.mark.parametrize(
    ("engine", "scheme", "stress"),
    [
        *((dem.simulate, "auto", 0.0), (dem.simulate, "auto", PEAK)),
        *((bar, "auto", 0.0), (bar, "auto", PEAK), (bar, "implicit", PEAK)),
    ],
)
def test_waveforms(closing, engine, scheme, stress):
    """What passes, 0.1 % off at most: of elements that resolve the wave, and of blocks an 800th of
    its length. A prestress of the wave's size stiffens the joint. The ledger closes but for what
    trapezoids of the work leave, second order in the step: 1e-6 of the work."""
    scene = closing(prestress={"normal": stress}, numerics__continuum__scheme=scheme)
    assert closing_joint.applies(scene)
    exact, found = closing_joint.solve(scene), engine(scene)
    for variable in ("stress", "velocity"):
        own, expected = (np.squeeze(one[variable].values) for one in (found, exact))
        own = own[:, 1] if own.ndim == 2 else own
        static = expected[0]
        assert np.linalg.norm(own - expected) <= 1e-3 * np.linalg.norm(expected - static)
    assert energy_residual(found) <= 1e-6


@pytest.mark.parametrize(("scheme", "ratio"), [("explicit", 100), ("implicit", 25)])
def test_faces_that_slam_shut(closing, monkeypatch, caplog, scheme, ratio):
    """Opened first, they meet at the speed of the wave, `ratio` times stronger than the joint's
    K_n d_m. The front behind them jumps; spread over an element, 0.25 ms of the 10 ms that the
    wave presses, it is off by sqrt(0.25 / 10 / 3) = 9 %. Of faces without a
    compliance explicit steps are stopped, and implicit ones gain energy, warned of."""
    layer = {"y": 20.0, "normal_stiffness": STIFFNESS, "maximum_closure": PEAK / STIFFNESS / ratio}
    scene = closing(
        pillar={"length": 40.0, "side": 0.5, "block": 0.5},
        load={"shape": "sine", "amplitude": -PEAK, "period": PERIOD},
        soft_layers=[layer],
        time={"duration": 0.034},
        numerics={"continuum": {"scheme": scheme, "steps_per_period": 1000}},
    )
    exact, found = closing_joint.solve(scene), bar(scene)
    assert np.linalg.norm(found.stress - exact.stress) <= 0.09 * np.linalg.norm(exact.stress)
    assert energy_residual(found) < 0.01
    monkeypatch.setattr(problem, "closed_compliance", lambda scene: 0.0)
    with suppress(StoppedError):
        assert energy_residual(bar(scene)) > 0.1
        assert "double numerics.continuum.steps_per_period" in caplog.text


def test_it_replaces_a_joint_of_the_homogenised_bar(closing):
    """Whose compliance is that of rigid blocks' joints, 1 / 26 of k_ni: within 0.1 %."""
    pillar = {"length": 40.0, "side": 0.5, "block": 0.5}
    scene = closing(pillar=pillar, rock=ROCK, record__velocity=[])
    exact, found = closing_joint.solve(scene), bar(scene)
    assert np.linalg.norm(found.stress - exact.stress) <= 1e-3 * np.linalg.norm(exact.stress)


def test_small_waves_are_damped_by_joints_and_rock_in_series(pillar):
    """Of joints nine times as stiff under stress, each dashpot takes k eta x^2 of its share x of
    the closure. Rigid blocks are those of linear joints with this sum; the jointed rock, whose
    parts move apart, is a block's dispersion off, 1 %."""
    k, c, mass, zeta, size = 9.2e9, 0.5 / 8.64e10, 1200.0, 0.2, 1.0
    stiffened = 1 / (1 / (9 * k) + c)
    eta = 2 * zeta * np.sqrt(mass * (1 / k + c))
    share = stiffened / (9 * k)
    sums = k * eta * share**2 + eta / c * (1 - share) ** 2

    def scene(joints, stress):
        return pillar(
            pillar={"length": 20.0, "side": 0.5, "block": 0.5},
            rock=dict.fromkeys(ROCK) | {"density": 2400.0, "intact_modulus": 8.64e10},
            joints=joints,
            prestress={"normal": stress} if stress else None,
            load={"shape": "ricker", "amplitude": size, "period": 0.01},
            ends={"start": "free", "end": "free"},
            time={"duration": 0.02},
            record={"stress": [15.0], "velocity": [10.25]},
        )

    closes = scene(
        {"normal_stiffness": k, "damping_ratio": zeta, "maximum_closure": 1e-4}, 2e-4 * k
    )
    linear = {"normal_stiffness": 9 * k, "damping_ratio": sums / (2 * np.sqrt(mass * stiffened))}
    blocks, expected = dem.simulate(closes), dem.simulate(scene(linear, 0.0))
    assert misfit(blocks, expected) <= 1e-5
    assert misfit(blocks, continuum.simulate(closes, model="jointed")) <= 1e-2


@pytest.mark.parametrize("engine", [dem.simulate, bar])
def test_a_run_beyond_the_stress_in_reach_is_stopped(closing, monkeypatch, engine):
    """A joint that is taken not to stiffen, and does: the run is stopped in one line, and what is
    kept of it are numbers. With the stress in reach it ends."""
    scene = closing(
        pillar={"length": 40.0, "side": 0.5, "block": 0.5},
        rock=ROCK | {"intact_modulus": 100 * MODULUS},
        load={"shape": "sine", "amplitude": 1e3 * PEAK, "period": PERIOD},
        numerics={
            one: {"scheme": scheme, "step_fraction": 0.4}
            for one, scheme in (("dem", "leapfrog"), ("continuum", "explicit"))
        },
    )
    assert np.isfinite(engine(scene).stress).all()
    monkeypatch.setattr(law, "stress_in_reach", lambda scene: 0.0)
    with pytest.raises(StoppedError) as stopped:
        engine(scene)
    assert "\n" not in str(stopped.value) and "stiffen" in str(stopped.value)
    assert np.isfinite(stopped.value.result.stress).all()
