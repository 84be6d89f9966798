"""What the tests of rock masses share: small scenes, and runs of them."""

from typing import Any

import pytest

from jointwave.cases.schema.rock_mass import RockMass

QUIET = dict.fromkeys(("left", "right", "bottom", "top"), "quiet")


@pytest.fixture
def rock_mass():
    """Return a function that gives a scene in 6 m x 6 m of rock with tables changed; `joints` holds
    keyword arguments of joint sets, `continuum` those of [numerics.continuum]."""

    def scene(joints=(), continuum=None, **tables) -> RockMass:
        law = {"normal_stiffness": 2e10, "shear_stiffness": 8e9}
        table: dict[str, Any] = {
            "title": "a rock mass",
            "domain": {"size": [6.0, 6.0]},
            "rock": {"density": 2600.0, "intact_modulus": 5e10},
            "joint_sets": [{"name": f"set {k}", **law, **one} for k, one in enumerate(joints)],
            "time": {"duration": 2e-3},
            "record": {"points": [[2.0, 1.5]]},
            "numerics": {"continuum": {"size": 1.5, **(continuum or {})}},
        }
        return RockMass(**{**table, **tables})

    return scene


@pytest.fixture
def struck(rock_mass):
    """Return a function that gives 20 m x 20 m of rock with quiet sides and one joint, which a
    Ricker pulse of 5 ms meets; keyword arguments of the wave, and tables as for `rock_mass`."""

    def scene(kind="P", direction=(0.0, 1.0), dip=30.0, through=(0.0, -4.0), **tables) -> RockMass:
        pulse = {"shape": "ricker", "amplitude": 1e6, "period": 5e-3}
        wave = {"kind": kind, "direction": list(direction), "through": list(through), **pulse}
        joints = [{"dip": dip, "through": [10.0, 10.0]}]
        table = {
            "domain": {"size": [20.0, 20.0]},
            "waves": [wave],
            "boundaries": QUIET,
            "time": {"duration": 0.016},
            "record": {"points": [[10.0, 5.0], [10.0, 15.0]], "joints": [[10.0, 10.0]]},
            "continuum": {"size": 1.25},
        }
        return rock_mass(**{"joints": joints, **table, **tables})

    return scene
