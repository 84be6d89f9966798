"""Joints that weaken, dilate, or rub by rate and state, by every engine, against exact solutions.

Shipped scenes: a shear pulse of 1 MPa meets one joint under 1 MPa, in waves of 32 m."""

from functools import cache, partial

import numpy as np
import pytest

from jointwave import cases, continuum, dem
from jointwave.cases.histories import Ricker
from jointwave.cases.read import load_tables
from jointwave.compare.exact.joint import sliding_joint
from jointwave.compare.exact.joint.rate_state_joint import RateJoint, RateStateWave
from jointwave.compare.misfit.metrics import relative_l2
from jointwave.compare.scenes import SHIPPED
from jointwave.results.dataset import energy_residual

WEAKENING, RATED = "slip-weakening", "rate-and-state"
slow = pytest.mark.slow
bar = partial(continuum.simulate, model="equivalent", dim=1)


def shipped(name, variant="", **changes):
    """Return a shipped scene without its bounds, keys changed."""
    alone = {"expect": {}, "record.interval": 2e-4}
    return cases.load_variant(SHIPPED / "beyond" / f"{name}.toml", variant, alone | changes)


def shear(result):
    """Return the shear stress along the load behind the joint, Pa."""
    return result["shear"].values[1, :, 0]


@cache
def exact(name, variant=""):
    """Return the exact waves: blocks do not enter."""
    return sliding_joint.solve(shipped(name, variant))


@pytest.mark.parametrize("name", [WEAKENING, pytest.param(RATED, marks=slow)])
def test_blocks_and_rock_tend_to_the_exact_joint(name):
    """Blocks of 1, 0.5 and 0.25 m: first order, for as much rock is in series with the joint as a
    block has; of weakening half a percent is left, extrapolated to no block length. Friction takes
    the work that it takes there, and gives none back."""
    misfits = []
    for block in (1.0, 0.5, 0.25):
        scene = shipped(name, **{"pillar.block": block, "rock.intact_modulus": 8.64e10})
        found = dem.simulate(scene), continuum.simulate(scene, "jointed", dim=1)
        assert max(map(energy_residual, found)) < 1e-11
        for one in found:
            friction = one["energy"].sel(term="friction").values
            assert np.diff(friction).min() >= -1e-12 * friction[-1]
        misfits.append([relative_l2(shear(one), shear(exact(name))) for one in found])
    misfits = np.array(misfits)
    assert (misfits[1:] < 0.6 * misfits[:-1]).all()
    if name == WEAKENING:
        assert (np.abs(2 * misfits[-1] - misfits[-2]) < 0.005).all()
    else:
        assert (misfits[-1] < 0.035).all()


@pytest.mark.parametrize(
    ("name", "variant", "steps"),
    [
        (RATED, "contacts 1 ms old", 500),
        pytest.param(RATED, "", 500, marks=slow),
        pytest.param(RATED, "rate strengthening", 500, marks=slow),
        pytest.param(WEAKENING, "", 1000, marks=slow),
        pytest.param("dilating-joint", "", 1000, marks=slow),
    ],
)
def test_one_joint_in_homogenised_rock_by_implicit_steps(name, variant, steps):
    """1 % of the exact waveform, in steps of a share of the period; the shipped scenes' own bounds
    hold rigid blocks and explicit steps to the same waves."""
    numerics = {"scheme": "implicit", "steps_per_period": steps}
    found = bar(shipped(name, variant, **{"numerics.continuum": numerics}))
    assert relative_l2(shear(found), shear(exact(name, variant))) < 0.01
    assert energy_residual(found) < 1e-6


FAULT = {
    "title": "a fault",
    "domain": {"size": [4.0, 48.0]},
    "rock": {"density": 2600.0, "intact_modulus": 4e10, "intact_poisson": 0.0},
    "prestress": {"xx": 4e6, "yy": 4e6},
    "waves": [
        {"kind": "S", "direction": [0.0, 1.0], "shape": "ricker", "amplitude": 2e6, "period": 0.02}
    ],
    "boundaries": {"left": "periodic", "right": "periodic", "bottom": "quiet", "top": "quiet"},
    "time": {"duration": 0.06},
    "record": {"points": [[1.0, 36.0]], "joints": [[1.0, 24.0]]},
}
#: A joint of tan(phi) = 0.4, and sides a thousand times as stiff.
JOINT = {"name": "fault", "dip": 0.0, "through": [1.0, 24.0], "normal_stiffness": 1e11}
JOINT |= {"shear_stiffness": 2e10, "friction_angle": float(np.degrees(np.arctan(0.4)))}
SIDES = {"name": "sides", "dip": 90.0, "spacing": 2.0}
SIDES |= {"normal_stiffness": 1e13, "shear_stiffness": 1e13}
RATE = {"direct_effect": 0.01, "evolution_effect": 0.02, "critical_slip_distance": 1e-4}
RATE |= {"reference_rate": 1e-6, "initial_state": 1e3}


@cache
def passed(impedance, end, delay):
    """Return the exact wave behind the joint of the column, the same for both engines."""
    one = RateJoint(4e6, 0.4, 0.01, 0.02, 1e-4, 1e-6, 1e3, 1 / 2e10)
    return RateStateWave(one, impedance, Ricker(2e6, 0.02), end, 1e-10, delay)


@pytest.mark.parametrize(
    ("engine", "bound"), [(dem.simulate, 0.006), (continuum.simulate, 0.02)], ids=["blocks", "rock"]
)
def test_one_rate_and_state_joint_in_the_plane(engine, bound):
    """Its slip, and what it carries, in a column of a wide rock mass: blocks of 0.8 m, elements of
    2 m in implicit steps, in a wave of 55 m. The shipped triggered fault weakens there."""
    rock = {"size": 2.0, "scheme": "implicit", "steps_per_period": 400}
    numerics = {"dem": {"block": 0.8}, "continuum": rock}
    found = engine(load_tables(FAULT | {"joint_sets": [JOINT | RATE, SIDES], "numerics": numerics}))
    t, speed, load = found["time"].values, np.sqrt(2e10 / 2600.0), Ricker(2e6, 0.02)
    z, delay = 2600.0 * speed, 24.0 / speed
    stress, impulse = passed(z, float(t[-1]), delay)(t - delay)
    slip = 2 * (load.impulse(t - delay) - impulse) / z
    for own, known in (
        (found["traction"][0, :, 1].values, stress),
        (found["slip"][0].values, slip),
    ):
        assert relative_l2(np.sign(own @ known) * own, known) < bound
    assert energy_residual(found) < 1e-6


@pytest.mark.parametrize("simulate", [dem.simulate, bar], ids=["blocks", "rock"])
def test_a_static_state_is_that_of_mu_0(simulate, plain):
    """A pillar that hangs sideways from its end, 0.53 MPa of shear at the joint: the state is that
    of Coulomb's friction, to the last bit, and contacts 10,000 s old then hold it."""
    changes = {
        "pillar.block": 2.5,
        "record.velocity": [36.25],
        "ends": {"start": "free", "end": "fixed"},
        "gravity": {"direction": [1, 0, 0], "acceleration": 8.8},
        "load.amplitude": 0.0,
        "time.duration": 0.01,
    }
    layer = {"soft_layers": [{"y": 25.0, "friction_angle": 31.0}]}
    ours, coulomb = (simulate(shipped(RATED, **changes, **own)) for own in ({}, layer))
    for name in ("displacement", "shear"):
        found, expected = ours[name].values, coulomb[name].values
        assert (found[:, 0] == expected[:, 0]).all() and np.abs(expected[:, 0]).max() > 0
        np.testing.assert_allclose(found, expected, rtol=0, atol=1e-6 * np.abs(expected).max())


def slider(share):
    """Return two blocks between walls, one of which moves along the joint between them at V = 0.5
    mm/s. Half a spring S, the joint's S and half a spring again: k = S / 2 unloads the joint,
    `share` of its critical stiffness s (b - a) / D_c."""
    joints = RATE | {"shear_stiffness": 2e9, "friction_angle": float(np.degrees(np.arctan(0.6)))}
    joints |= {"critical_slip_distance": share * 0.01 * 1e6 / 1e9, "reference_rate": 5e-4}
    del joints["initial_state"]
    load = {"shape": "step", "quantity": "velocity", "amplitude": 5e-4, "direction": [1, 0, 0]}
    tables = {
        "title": "a slider",
        "pillar": {"length": 1.0, "side": 0.5, "block": 0.5},
        "rock": {"density": 2400.0, "equivalent_modulus": 4.4e9, "equivalent_poisson": 0.42},
        "motion": {"rotation": "none"},
        "prestress": {"normal": 1e6},
        "joints": joints,
        "load": load,
        "ends": {"start": "fixed", "end": "fixed"},
        "time": {"duration": 4.0},
        "record": {"stress": [0.5], "velocity": [0.25], "interval": 1e-3},
    }
    return load_tables(tables)


def test_blocks_creep_above_the_critical_stiffness_and_stick_and_slip_below():
    """1.2 s bring the traction to the 0.6 MPa of friction at V. Above k_c by a quarter it settles
    there, at the rate of a p^2 + (a - b + k D_c / s) p + k D_c / s = 0 (Ruina 1983), Re p = 0.125
    of V / D_c = 40 1/s: inertia, m V^2 / (s a D_c) = 0.002 of it, and steps change less than 2 % of
    that. Below k_c it sticks and slips."""
    stable, unstable = (dem.simulate(slider(share)) for share in (1.25, 0.8))
    t = stable["time"].values
    held, swings = (np.abs(one["shear"].values[0, :, 0]) for one in (stable, unstable))
    first, then = (np.ptp(held[(t > at) & (t < at + 0.5)]) for at in (2.0, 3.0))
    assert np.log(first / then) == pytest.approx(5.0, rel=0.02)
    np.testing.assert_allclose(held[t > 3.5], 0.6e6, rtol=1e-5)
    assert np.ptp(swings[t > 3.0]) > 0.1e6
    assert max(map(energy_residual, (stable, unstable))) < 1e-12
