"""What the tests of rock masses share: small scenes, and runs of them."""

from typing import Any

import numpy as np
import pytest

from cases.incident import Motion, plane_wave
from cases.material.rock import elastic_rock
from cases.schema.rock_mass import RockMass
from compare.exact.plane.oblique_joint import Joint, fields
from compare.exact.plane.pulse import Pulse
from continuum.plane.rock import PlaneDiscrete, discretise

SIDES = ("left", "right", "bottom", "top")


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
def meshed(rock_mass):
    """Return a function that gives a scene in space, all of its keys as for `rock_mass`."""

    def build(*joints, model="jointed", **changes) -> PlaneDiscrete:
        return discretise(rock_mass(joints, **changes), model)

    return build


class AtOneJoint:
    """The exact motion of a scene of one wave at one joint, without any side."""

    whole = True

    def __init__(self, scene: RockMass) -> None:
        wave, joint = plane_wave(scene, scene.waves[0]), scene.joint_sets[0]
        point = np.array(joint.through)
        late = wave.lateness(point[None])[0]
        kind = "P" if scene.waves[0].kind == "P" else "SV"
        pulse = Pulse(kind, wave.direction, lambda t: wave.pulse.value(t - late))
        law = Joint(joint.normal_stiffness, joint.shear_stiffness)
        self.asked = elastic_rock(scene.rock), law, pulse, point, np.radians(joint.dip)

    def __call__(self, points, times) -> Motion:
        found = fields(*self.asked, points, times)
        return Motion(found.velocity, found.stress)


@pytest.fixture
def at_one_joint():
    """Return the exact motion of waves at one joint as a class, of a scene."""
    return AtOneJoint
