"""A joint that slip changes, by every engine, against its exact solution.

A shear pulse of 1 MPa meets one joint under 1 MPa: of tan(phi) 0.7 are 0.27 left after 4 mm. The
wave is 32 m long; Z_s = 1.92e6 Pa s/m.
"""

from functools import cache
from pathlib import Path

import numpy as np
import pytest

from jointwave import cases, continuum, dem
from jointwave.cases.histories import Ricker
from jointwave.cases.validate import validated
from jointwave.compare.exact.joint import sliding_joint
from jointwave.compare.exact.joint.slip_phases import Passed, SlipJoint
from jointwave.compare.misfit.metrics import relative_l2
from jointwave.compare.scenes import SHIPPED
from jointwave.results.dataset import energy_residual

SCENE = SHIPPED / "beyond" / "slip-weakening.toml"


def weakening(**changes):
    """Return the shipped scene without its bounds, keys changed."""
    return cases.load_variant(SCENE, "", {"expect": {}, "record.interval": 2e-4, **changes})


def shear(result):
    """Return the shear stress along the load behind the joint, Pa."""
    return result["shear"].values[1, :, 0]


@cache
def exact_shear():
    """Return the shear stress behind the joint, Pa, of the exact waves: blocks do not enter."""
    return shear(sliding_joint.solve(weakening()))


def test_blocks_and_rock_tend_to_the_exact_joint():
    """Blocks of 1, 0.5 and 0.25 m: first order, as for a joint of one strength, for as much rock is
    in series with the joint as a block has. Friction takes the work that it takes there."""
    misfits = []
    for block in (1.0, 0.5, 0.25):
        scene = weakening(**{"pillar.block": block, "rock.intact_modulus": 8.64e10})
        found = dem.simulate(scene), continuum.simulate(scene, "jointed", dim=1)
        assert max(map(energy_residual, found)) < 1e-11
        misfits.append([relative_l2(shear(one), exact_shear()) for one in found])
    misfits = np.array(misfits)
    assert (misfits[1:] < 0.6 * misfits[:-1]).all()
    assert (np.abs(2 * misfits[-1] - misfits[-2]) < 0.005).all()


def bar(scene):
    return continuum.simulate(scene, "equivalent", dim=1)


@pytest.mark.parametrize("scheme", ["explicit", "implicit"])
def test_one_joint_in_homogenised_rock(scheme):
    """1 % of the exact waveform, explicit and in steps of a thousandth of the period."""
    scene = weakening(
        **{
            "numerics.continuum.scheme": scheme,
            "numerics.continuum.steps_per_period": 1000,
            "numerics.continuum.elements_per_block": 1,
        }
    )
    found = continuum.simulate(scene, "equivalent", dim=1)
    assert relative_l2(shear(found), exact_shear()) < 0.01
    assert energy_residual(found) < 1e-6


def dilating(**changes):
    """Return the shipped scene of a joint that slip lifts, without its bounds, keys changed."""
    alone = {"expect": {}, "variants": [], "record.interval": 2e-4}
    return cases.load_variant(SHIPPED / "beyond" / "dilating-joint.toml", "", alone | changes)


@cache
def lifted():
    """Return the exact waves of a joint that slip lifts."""
    return sliding_joint.solve(dilating())


@pytest.mark.parametrize(
    ("simulate", "bound"), [(dem.simulate, 0.07), (bar, 0.01)], ids=["blocks", "rock"]
)
@pytest.mark.parametrize("scheme", ["explicit", "implicit"])
def test_a_joint_that_is_lifted_sends_off_pressure(simulate, bound, scheme):
    """Shear and pressure on both sides, in waves of 32 m and 88 m: blocks of 0.25 m, and rock."""
    numerics = {"scheme": scheme, "steps_per_period": 1000}
    if scheme == "implicit" and simulate is dem.simulate:
        pytest.skip("rigid blocks have no implicit steps")
    scene = dilating(**{f"numerics.continuum.{key}": value for key, value in numerics.items()})
    found, exact = simulate(scene), lifted()
    waves = [("stress", ...), ("shear", (..., 0)), ("velocity", (..., 0)), ("velocity", (..., 1))]
    for name, part in waves:
        for own, other in zip(found[name].values, exact[name].values, strict=True):
            still = other[part][0]
            assert relative_l2(own[part] - still, other[part] - still) < bound
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
JOINT = {
    "name": "fault",
    "dip": 0.0,
    "through": [1.0, 24.0],
    "normal_stiffness": 1e11,
    "shear_stiffness": 2e10,
    "friction_angle": float(np.degrees(np.arctan(0.4))),
    "dynamic_friction_angle": float(np.degrees(np.arctan(0.2))),
    "weakening_distance": 5e-4,
}
SIDES = {"name": "sides", "dip": 90.0, "spacing": 2.0}
SIDES |= {"normal_stiffness": 1e13, "shear_stiffness": 1e13}
IMPLICIT = {"scheme": "implicit", "steps_per_period": 400}


#: Engines in the plane: blocks of 0.8 m, elements of 2 m, in a wave of 55 m.
IN_THE_PLANE = pytest.mark.parametrize(
    ("engine", "rock", "bound"),
    [
        (dem.simulate, {}, 0.006),
        (continuum.simulate, {"scheme": "explicit"}, 0.02),
        (continuum.simulate, IMPLICIT, 0.02),
    ],
    ids=["blocks", "rock", "implicit"],
)


def hold_in_the_plane(engine, rock, bound, joint, passing):
    """Hold its slip, and what it carries, in a column of a wide rock mass whose sides are joints a
    thousand times as stiff.

    passing : of impedance (Pa s/m), load, duration and delay (s), the exact wave behind the joint.
    """
    numerics = {"dem": {"block": 0.8}, "continuum": {"size": 2.0, **rock}}
    tables = FAULT | {"joint_sets": [joint, SIDES], "numerics": numerics}
    found = engine(validated(tables, Path("fault.toml"), frozenset()))
    t, speed, load = found["time"].values, np.sqrt(2e10 / 2600.0), Ricker(2e6, 0.02)
    z, later = 2600.0 * speed, t - 24.0 / speed
    stress, impulse = passing(z, load, float(t[-1]), 24.0 / speed)(later)
    slip = 2 * (load.impulse(later) - impulse) / z
    carried, slipped = found["traction"].values[0, :, 1], found["slip"].values[0]
    sign = np.sign(carried @ stress)
    assert relative_l2(sign * carried, stress) < bound
    assert relative_l2(np.sign(slipped @ slip) * slipped, slip) < bound
    assert energy_residual(found) < 1e-6


@cache
def passed(impedance, load, end, delay):
    """Return the exact wave behind the joint of the column, the same for all engines."""
    one = SlipJoint(0.0, 1 / 2e10, 1.6e6, 0.8e6, 5e-4)
    return Passed(one, impedance, load, end, 1e-10)


@IN_THE_PLANE
def test_one_joint_in_the_plane(engine, rock, bound):
    hold_in_the_plane(engine, rock, bound, JOINT, passed)
