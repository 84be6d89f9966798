"""Harmonic transmission through linear joints: several in parallel, and a thin soft layer that is
meshed as rock.

Amplitudes are those of a Ricker pulse at its peak frequency, of which the exact incident wave is
known. Per wavelength there are 20 quadratic elements, whose phase error per wavelength, below
(k h)^4 / 1440 = 7e-6, and a step of a 300th of the period, (omega dt)^2 / 24 = 2e-5, leave far less
than the bounds."""

import numpy as np
import pytest

import jointwave as jw
from closed_forms import one_joint, parallel_joints
from jointwave import continuum
from jointwave.cases.loads import history_of, load_history

PERIOD = 0.01  # s, of the Ricker wavelet's peak frequency
DENSITY, MODULUS, SPEED = 2400.0, 9.6e9, 2000.0
BAR = {
    "pillar": {"length": 60.0, "side": 0.5, "block": 1.0},
    "rock": {"density": DENSITY, "equivalent_modulus": MODULUS, "equivalent_poisson": 0.25},
    "load": {"shape": "ricker", "amplitude": 1e6, "period": PERIOD},
    "ends": {"start": "quiet", "end": "quiet"},
    "time": {"duration": 0.1},
    "record": {"stress": [10.0, 30.0], "velocity": [], "interval": 1e-4},
    "numerics__continuum__elements_per_block": 1,
}


@pytest.fixture
def bar(pillar):
    """Return a function that gives 60 m of rock of 2000 m/s between quiet ends, keys changed."""
    return lambda **changes: pillar(**{**BAR, **changes})


def soft_joint(y, kappa, impedance=DENSITY * SPEED, block=1.0):
    """Return the soft layer at y (m) whose joint has kappa = K/(Z omega) at the peak frequency; the
    homogenised bar holds the compliance of an ordinary joint already."""
    excess = 1 / (kappa * impedance * 2 * np.pi / PERIOD)
    return {"y": y, "normal_stiffness": 1 / (excess + block / MODULUS)}


def amplitude(times, wave):
    """Return the magnitude of the Fourier integral of a wave at the peak frequency."""
    return float(abs(wave @ np.exp(-2j * np.pi / PERIOD * times)) * (times[1] - times[0]))


def shares(scene):
    """Return |R| at 10 m and |T| at the last receiver, of a bar that a wave enters."""
    result = continuum.simulate(scene, "equivalent", dim=1)
    times, stress = result.time.values, result.stress.values
    incident = load_history(scene).value(times - 10.0 / SPEED) / 2
    whole = amplitude(times, incident)
    return amplitude(times, stress[0] - incident) / whole, amplitude(times, stress[-1]) / whole


@pytest.mark.parametrize("count, spacing", [(2, 0.05), (2, 0.2), (3, 0.1), (5, 0.05), (5, 0.2)])
def test_parallel_joints(bar, count, spacing):
    """|T| at kappa = 1 by transfer matrices (Cai & Zhao, 2000) within 0.1 %."""
    layers = [soft_joint(y, 1.0) for y in 20.0 + 20.0 * spacing * np.arange(count)]
    _, T = shares(bar(soft_layers=layers, time__duration=0.4, record__stress=[10.0, 50.0]))
    assert pytest.approx(parallel_joints.transmission(count, 1.0, spacing), rel=1e-3) == T


def test_a_layer_that_is_meshed_has_its_mass_and_the_interface_has_none(bar):
    """The layer has the rock's density and a hundredth of its modulus: Z_2/Z_1 = c_2/c_1 = 0.1, and
    k_2 h = 0.3. |T|^2 = 1 / (1 + (Z_1/Z_2 - Z_2/Z_1)^2 sin^2(k_2 h) / 4) (Brekhovskikh, Waves in
    Layered Media, 1980) within 0.1 %, by one quadratic element of k h = 0.3, (k h)^4 / 1440 = 6e-6;
    the massless joint of its compliance, kappa = (Z_2/Z_1) / (k_2 h), lets 1.7 % less pass."""
    ratio, phase = 0.1, 0.3
    thickness = phase * ratio * SPEED * PERIOD / (2 * np.pi)
    layer = {"y": 20.0, "normal_stiffness": ratio**2 * MODULUS / thickness}
    meshed = 1 / np.sqrt(1 + (1 / ratio - ratio) ** 2 * np.sin(phase) ** 2 / 4)
    interface = parallel_joints.transmission(1, ratio / phase, 0.0)
    for one, exact in (
        (layer | {"thickness": thickness}, meshed),
        (soft_joint(20.0, ratio / phase, block=0.0), interface),
    ):
        scene = bar(soft_layers=[one], rock__intact_modulus=(1 + 1e-9) * MODULUS)
        assert pytest.approx(exact, rel=1e-3) == shares(scene)[1]


@pytest.mark.parametrize(
    ("law", "kappa"),
    [
        ({"thickness": 1e-3}, 0.5),
        ({"maximum_closure": 1e3}, 0.5),
        ({"tensile_strength": 1e9, "fracture_energy": 1e16}, None),
    ],
)
def test_a_layer_replaces_a_joint_of_the_homogenised_bar(bar, law, kappa):
    """Whatever its law, here far from its limits: |T| and |R| of its excess compliance, or of none.
    The blocks beside it have less instead, within (k S)^2 / 4."""
    layer = {"y": 20.0} if kappa is None else soft_joint(20.0, kappa, block=0.5)
    pressed = {"prestress": {"normal": 0.0}} if "maximum_closure" in law else {}
    found = shares(bar(soft_layers=[layer | law], pillar__block=0.5, **pressed))
    R, T = np.abs(one_joint.coefficients(1.0, kappa, 1.0)) if kappa else (0.0, 1.0)
    assert pytest.approx((R, T), abs=(np.pi / 10 * 0.5) ** 2 / 4) == found


@pytest.mark.parametrize("viscosity", [0.0, 1e6, 1e7])
def test_one_joint_with_its_own_dashpot(viscosity):
    """|T| of K + i omega c in a pillar and in a rock mass. Rigid blocks put the rock of a block d
    into the joint's contact, the share d K / M of its compliance, which bounds their error."""
    omega, pillar_z, M = 2 * np.pi / PERIOD, DENSITY * SPEED, 1.2 * MODULUS  # nu = 0.25
    K = pillar_z * omega / 2
    bounds = {"exact": 1e-6, "continuum-jointed": 1e-4, "dem": 0.25 * K / M}
    load = {"shape": "ricker", "amplitude": 1e6, "period": PERIOD}
    rock = {"density": DENSITY, "intact_modulus": MODULUS, "intact_poisson": 0.25}
    law = {"normal_stiffness": K, "viscosity": viscosity}
    pillar = {
        "title": "pillar",
        "pillar": {"length": 60.0, "side": 0.5, "block": 0.25, "joints": [20.0]},
        "joints": law,
        "load": load,
        "ends": {"start": "matched", "end": "matched"},
        "record": {"stress": [30.0], "interval": 1e-4},
    }
    sides = dict.fromkeys(("left", "right"), "periodic") | dict.fromkeys(("bottom", "top"), "quiet")
    joint = {"name": "joint", "dip": 0.0, "through": [1.0, 20.0], "shear_stiffness": K}
    mass = {
        "title": "rock mass",
        "domain": {"size": [2.0, 40.0]},
        "joint_sets": [joint | law],
        "waves": [load | {"kind": "P", "direction": [0.0, 1.0]}],
        "boundaries": sides,
        "numerics": {"dem": {"block": 0.25}},
        "record": {"points": [[1.0, 30.1]], "interval": 1e-4},
    }
    for tables, exact, z in (
        (pillar, "jointed-bar", pillar_z),
        (mass, "oblique-joint", np.sqrt(DENSITY * M)),
    ):
        scene = jw.load(tables | {"rock": rock, "time": {"duration": 0.1}})
        for solver, bound in bounds.items():
            result = jw.simulate(scene, exact if solver == "exact" else solver)
            times = result.time.values
            if exact == "jointed-bar":
                incident, wave = load_history(scene).value(times - 30.0 / SPEED) / 2, result.stress
            else:
                at = 30.1 * np.sqrt(DENSITY / M)
                incident = history_of(scene.waves[0], 1e6 / z).value(times - at)
                wave = result.velocity[..., 1]
            passed = amplitude(times, wave.values[0]) / amplitude(times, incident)
            expected = abs(one_joint.coefficients(omega, K, z, viscosity)[0])
            assert passed == pytest.approx(expected, rel=bound)
