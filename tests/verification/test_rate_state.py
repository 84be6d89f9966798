"""A joint whose friction depends on rate and state, by every engine, against its exact solution.

The shipped scene: a shear pulse of 1 MPa meets one joint under 1 MPa, in waves of 32 m.
"""

from functools import cache
from pathlib import Path

import numpy as np
import pytest

from jointwave import cases, continuum, dem
from jointwave.cases.validate import validated
from jointwave.compare.exact.joint import sliding_joint
from jointwave.compare.exact.joint.rate_state_joint import RateJoint, RateStateWave
from jointwave.compare.misfit.metrics import relative_l2
from jointwave.compare.scenes import SHIPPED
from jointwave.results.dataset import energy_residual
from tests.verification.test_slip_weakening import (
    FAULT,
    IN_THE_PLANE,
    JOINT,
    SIDES,
    bar,
    hold_in_the_plane,
    shear,
)

SCENE = SHIPPED / "beyond" / "rate-and-state.toml"


def rated(**changes):
    """Return the shipped scene without its bounds, keys changed."""
    return cases.load_variant(SCENE, "", {"expect": {}, "record.interval": 2e-4, **changes})


@pytest.mark.slow
def test_blocks_and_rock_tend_to_the_exact_joint():
    """Blocks of 1, 0.5 and 0.25 m: first order, as for a joint of one strength."""
    misfits = []
    for block in (1.0, 0.5, 0.25):
        scene = rated(**{"pillar.block": block, "rock.intact_modulus": 8.64e10})
        exact = shear(sliding_joint.solve(scene))
        found = dem.simulate(scene), continuum.simulate(scene, "jointed", dim=1)
        assert max(map(energy_residual, found)) < 1e-11
        for one in found:
            friction = one["energy"].sel(term="friction").values
            assert np.diff(friction).min() >= -1e-12 * friction[-1]
        misfits.append([relative_l2(shear(one), exact) for one in found])
    misfits = np.array(misfits)
    assert (misfits[1:] < 0.6 * misfits[:-1]).all() and (misfits[-1] < 0.035).all()


@cache
def exact_shear(variant):
    """Return the shear stress behind the joint of a variant of the shipped scene, Pa."""
    changes = {"expect": {}, "record.interval": 2e-4}
    return shear(sliding_joint.solve(cases.load_variant(SCENE, variant, changes)))


@pytest.mark.parametrize(
    ("variant", "scheme"),
    [
        ("", "explicit"),
        ("", "implicit"),
        ("rate strengthening", "explicit"),
        pytest.param("rate strengthening", "implicit", marks=pytest.mark.slow),
        pytest.param("contacts 1 ms old", "explicit", marks=pytest.mark.slow),
        ("contacts 1 ms old", "implicit"),
    ],
)
def test_one_joint_in_homogenised_rock(scheme, variant):
    """1 % of the exact waveform, explicit and in steps of a five hundredth of the period; slow: the
    schemes that the same law has in others."""
    changes = {
        "expect": {},
        "record.interval": 2e-4,
        "numerics.continuum.scheme": scheme,
        "numerics.continuum.steps_per_period": 500,
    }
    found = bar(cases.load_variant(SCENE, variant, changes))
    assert relative_l2(shear(found), exact_shear(variant)) < 0.01
    assert energy_residual(found) < 1e-6


RATED = {key: JOINT[key] for key in ("name", "dip", "through", "normal_stiffness")}
RATED |= {"shear_stiffness": 2e10, "friction_angle": float(np.degrees(np.arctan(0.4)))}
RATE = {"direct_effect": 0.01, "evolution_effect": 0.02, "critical_slip_distance": 1e-4}
RATE |= {"reference_rate": 1e-6, "initial_state": 1e3}
RATED |= RATE


@cache
def passed(impedance, load, end, delay):
    """Return the exact wave behind the joint of the column, the same for all engines."""
    one = RateJoint(4e6, 0.4, 0.01, 0.02, 1e-4, 1e-6, 1e3, 1 / 2e10)
    return RateStateWave(one, impedance, load, end, 1e-10, delay)


@IN_THE_PLANE
def test_one_joint_in_the_plane(engine, rock, bound):
    hold_in_the_plane(engine, rock, bound, RATED, passed)


@pytest.mark.parametrize("simulate", [dem.simulate, bar], ids=["blocks", "rock"])
def test_a_static_state_is_that_of_mu_0(simulate):
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
    layer = {"y": 25.0, "friction_angle": 31.0}
    ours, coulomb = simulate(rated(**changes)), simulate(rated(**changes, soft_layers=[layer]))
    for name in ("displacement", "shear"):
        found, expected = ours[name].values, coulomb[name].values
        assert (found[:, 0] == expected[:, 0]).all() and np.abs(expected[:, 0]).max() > 0
        np.testing.assert_allclose(found, expected, rtol=0, atol=1e-6 * np.abs(expected).max())


def test_blocks_rest_under_a_shear_stress():
    """1.2 MPa of it, of 1.6 that mu_0 = 0.4 bears: contacts 1000 s old hold it, as Coulomb's do."""
    still = {
        "waves": [],
        "time": {"duration": 1e-3},
        "prestress": {"xx": 4e6, "yy": 4e6, "xy": 1.2e6},
    }
    numerics = {"dem": {"block": 0.8}}
    plain = {key: RATED[key] for key in RATED if key not in RATE} | {"tension": False}
    sides = SIDES | {"cohesion": 1e9}
    found = []
    for joint in (RATED, plain):
        tables = FAULT | still | {"joint_sets": [joint, sides], "numerics": numerics}
        found.append(dem.simulate(validated(tables, Path("fault.toml"), frozenset())))
    ours, coulomb = (one["traction"].values[0] for one in found)
    assert np.abs(coulomb[0, 1]) == pytest.approx(1.2e6, rel=1e-6)
    np.testing.assert_allclose(ours, coulomb, rtol=0, atol=1e-6 * 4e6)


def slider(share):
    """Return two blocks between walls, one of which moves along the joint between them at V = 0.5
    mm/s. Half a spring S, the joint's S and half a spring again: k = S / 2 unloads the joint,
    `share` of its critical stiffness s (b - a) / D_c."""
    distance = share * 0.01 * 1e6 / 1e9
    joints = {"shear_stiffness": 2e9, "friction_angle": float(np.degrees(np.arctan(0.6)))}
    joints |= {"direct_effect": 0.01, "evolution_effect": 0.02}
    joints |= {"critical_slip_distance": distance, "reference_rate": 5e-4}
    tables = {
        "title": "a slider",
        "pillar": {"length": 1.0, "side": 0.5, "block": 0.5},
        "rock": {"density": 2400.0, "equivalent_modulus": 4.4e9, "equivalent_poisson": 0.42},
        "motion": {"rotation": "none"},
        "prestress": {"normal": 1e6},
        "joints": joints,
        "load": {
            "shape": "step",
            "quantity": "velocity",
            "amplitude": 5e-4,
            "direction": [1, 0, 0],
        },
        "ends": {"start": "fixed", "end": "fixed"},
        "time": {"duration": 4.0},
        "record": {"stress": [0.5], "velocity": [0.25], "interval": 1e-3},
    }
    return validated(tables, Path("slider.toml"), frozenset())


def test_blocks_creep_above_the_critical_stiffness_and_stick_and_slip_below():
    """1.2 s bring the traction to the 0.6 MPa of friction at V. Above k_c by a quarter it settles
    there, at the rate of a p^2 + (a - b + k D_c / s) p + k D_c / s = 0 (Ruina 1983), Re p = 0.125
    of V / D_c = 40 1/s: inertia, m V^2 / (s a D_c) = 0.002 of it, and steps change less than 2 % of
    that. Below k_c it sticks and slips."""
    stable, unstable = (dem.simulate(slider(share)) for share in (1.25, 0.8))
    t, held, swings = (
        stable["time"].values,
        *(np.abs(one["shear"].values[0, :, 0]) for one in (stable, unstable)),
    )
    first, then = (np.ptp(held[(t > at) & (t < at + 0.5)]) for at in (2.0, 3.0))
    assert np.log(first / then) == pytest.approx(5.0, rel=0.02)
    np.testing.assert_allclose(held[t > 3.5], 0.6e6, rtol=1e-5)
    assert np.ptp(swings[t > 3.0]) > 0.1e6
    assert max(map(energy_residual, (stable, unstable))) < 1e-12
