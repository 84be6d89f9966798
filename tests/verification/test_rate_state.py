"""A joint whose friction depends on rate and state, by every engine, against its exact solution.

The shipped scene: a shear pulse of 1 MPa meets one joint under 1 MPa, in waves of 32 m.
"""

from pathlib import Path

import numpy as np
import pytest

import cases
import continuum
import dem
from cases.histories import Ricker
from cases.validate import validated
from compare.exact.joint import sliding_joint
from compare.exact.joint.rate_state_joint import Passed, RateJoint
from compare.misfit.metrics import relative_l2
from compare.scenes import SHIPPED
from results.dataset import energy_residual
from tests.verification.test_worn_joint import FAULT, IMPLICIT, JOINT, SIDES, bar, shear

SCENE = SHIPPED / "beyond" / "rate-and-state.toml"


def rated(**changes):
    """Return the shipped scene without its bounds, keys changed."""
    return cases.load_variant(SCENE, "", {"expect": {}, "record.interval": 2e-4, **changes})


def test_blocks_and_rock_tend_to_the_exact_joint():
    """Blocks of 1, 0.5 and 0.25 m: first order, as for a joint of one strength."""
    misfits = []
    for block in (1.0, 0.5, 0.25):
        scene = rated(**{"pillar.block": block, "rock.intact_modulus": 8.64e10})
        exact = shear(sliding_joint.solve(scene))
        found = dem.simulate(scene), continuum.simulate(scene, "jointed", 1)
        assert max(map(energy_residual, found)) < 1e-11
        for one in found:
            friction = one["energy"].sel(term="friction").values
            assert np.diff(friction).min() >= -1e-12 * friction[-1]
        misfits.append([relative_l2(shear(one), exact) for one in found])
    misfits = np.array(misfits)
    assert (misfits[1:] < 0.6 * misfits[:-1]).all() and (misfits[-1] < 0.035).all()


@pytest.mark.parametrize("scheme", ["explicit", "implicit"])
@pytest.mark.parametrize("variant", ["", "friction rises with the rate"])
def test_one_joint_in_homogenised_rock(scheme, variant):
    """1 % of the exact waveform, explicit and in steps of a thousandth of the period."""
    changes = {
        "expect": {},
        "record.interval": 2e-4,
        "numerics.continuum.scheme": scheme,
        "numerics.continuum.steps_per_period": 1000,
    }
    scene = cases.load_variant(SCENE, variant, changes)
    found = bar(scene)
    assert relative_l2(shear(found), shear(sliding_joint.solve(scene))) < 0.01
    assert energy_residual(found) < 1e-6


RATED = {key: JOINT[key] for key in ("name", "dip", "through", "normal_stiffness")}
RATED |= {"shear_stiffness": 2e10, "friction_angle": float(np.degrees(np.arctan(0.4)))}
RATED |= {"direct_effect": 0.01, "evolution_effect": 0.02, "critical_slip_distance": 1e-4}
RATED |= {"reference_rate": 1e-6, "initial_state": 1e3}


@pytest.mark.parametrize(
    ("engine", "rock", "bound"),
    [
        (dem.simulate, {}, 0.006),
        (continuum.simulate, {"scheme": "explicit"}, 0.02),
        (continuum.simulate, IMPLICIT, 0.02),
    ],
    ids=["blocks", "rock", "implicit"],
)
def test_one_joint_in_the_plane(engine, rock, bound):
    """Its slip, and what it carries, in a column of a wide rock mass whose sides are joints a
    thousand times as stiff: blocks of 0.8 m, elements of 2 m, in a wave of 55 m."""
    numerics = {"dem": {"block": 0.8}, "continuum": {"size": 2.0, **rock}}
    tables = FAULT | {"joint_sets": [RATED, SIDES], "numerics": numerics}
    scene = validated(tables, Path("fault.toml"), frozenset())
    found = engine(scene)
    t, speed = found["time"].values, np.sqrt(2e10 / 2600.0)
    z, later = 2600.0 * speed, t - 24.0 / speed
    joint = RateJoint(4e6, 0.4, 0.01, 0.02, 1e-4, 1e-6, 1e3, 1 / 2e10)
    load = Ricker(2e6, 0.02)
    stress, impulse = Passed(joint, z, load, t[-1], 1e-10, 24.0 / speed)(later)
    slip = 2 * (load.impulse(later) - impulse) / z
    carried, slipped = found["traction"].values[0, :, 1], found["slip"].values[0]
    sign = np.sign(carried @ stress)
    assert relative_l2(sign * carried, stress) < bound
    assert relative_l2(np.sign(slipped @ slip) * slipped, slip) < bound
    assert energy_residual(found) < 1e-6
