"""Dashpots of joint sets against numbers worked out by hand."""

import numpy as np
import pytest

from jointwave.cases.material.rock_mass import set_time_constants
from jointwave.cases.schema.damping import Damping, Rayleigh
from jointwave.cases.schema.domain import Domain
from jointwave.cases.schema.joint import JointSet
from jointwave.cases.schema.plane import IntactRock, RecordOfRock
from jointwave.cases.schema.rock_mass import RockMass
from jointwave.cases.schema.tables import Time


def scene(*sets, **tables):
    """Return rock of 2500 kg/m3, 40 m by 30 m, with joints of 1e10 Pa/m."""
    law = {"normal_stiffness": 1e10, "shear_stiffness": 4e9}
    return RockMass(
        title="dashpots",
        domain=Domain(size=[40.0, 30.0]),
        rock=IntactRock(density=2500.0, intact_modulus=5e10),
        joint_sets=[JointSet(name=str(i), **law | keys) for i, keys in enumerate(sets)],
        time=Time(duration=1.0),
        record=RecordOfRock(points=[[1.0, 1.0]]),
        **tables,
    )


def test_the_mass_is_that_of_the_rock_from_joint_to_joint():
    """m = 2500 x 4 = 1e4 kg/m2, c = 2 x 0.05 sqrt(1e4 x 1e10) = 1e6 Pa s/m, eta = c / 1e10; a
    joint alone cuts the 30 m in halves of 15 m, an upright one the 40 m, one at 45 degrees 70 m
    over sqrt(2)."""
    alone = {"dip": 0.0, "through": [20.0, 15.0]}
    found = set_time_constants(
        scene(
            {"dip": 30.0, "spacing": 4.0, "damping_ratio": 0.05},
            {"dip": 30.0, "spacing": 4.0},
            alone | {"damping_ratio": 0.05},
            alone | {"dip": 90.0, "damping_ratio": 0.05},
            alone | {"dip": 45.0, "damping_ratio": 0.05},
        )
    )
    apart = np.array([15, 20, 35 / np.sqrt(2)])
    assert found == pytest.approx([1e-4, 0, *(0.1 * np.sqrt(2500 * apart / 1e10))], rel=1e-12)


def test_rayleigh_gives_all_joints_one_time_constant():
    """zeta = 0.02 at 100 Hz and 0.01 at 200 Hz: beta = 0, all of it is alpha; twice as much at
    twice the frequency is beta alone, zeta / (pi f)."""
    joints = {"dip": 0.0, "spacing": 4.0}
    damped = scene(
        joints, damping=Damping(rayleigh=Rayleigh(frequencies=[100, 200], ratios=[0.01, 0.02]))
    )
    assert set_time_constants(damped) == pytest.approx([1e-4 / np.pi], rel=1e-12)
    of_mass = Damping(rayleigh=Rayleigh(frequencies=[100, 200], ratios=[0.02, 0.01]))
    assert set_time_constants(scene(joints, damping=of_mass)) is None


def test_without_damping_there_are_none():
    assert set_time_constants(scene({"dip": 0.0, "spacing": 4.0, "damping_ratio": 0.0})) is None
