"""What stands by thrust alone: a semicircular arch of equal voussoirs without tension.

Milankovitch: it stands from a thickness of 0.1075 times the radius of its centre line on, with
continuous radial joints that do not slide. Of 17 voussoirs with chords for faces a linear
programme finds 0.1055: forces at both ends of every joint, pushing, in balance with the weights
(lower bound theorem; friction of 80 degrees decides nothing). Contact points at a lever of the half
thickness from the centre line divide it by the lever: the thrust line reaches no farther.

Both engines must find what stands and refuse what falls, and not take for falling what has only not
converged.
"""

import re

import numpy as np
import pytest
from scipy.optimize import brentq, linprog

import jointwave as jw
from jointwave.cases.errors import SceneError
from jointwave.cases.material.contact_points import lever
from jointwave.cases.read import load_tables
from jointwave.cases.warnings import warnings

RADIUS, VOUSSOIRS, FRICTION = 10.0, 17, 80.0  # m, degrees
ANGLES = np.pi * np.arange(VOUSSOIRS + 1) / VOUSSOIRS
RADIAL = np.stack([np.cos(ANGLES), np.sin(ANGLES)], axis=1)
ALONG = RADIAL @ [[0, 1], [-1, 0]]  # the normals of the joints
MOVES = r"no static state.* moves .*it slides, tips or is unsupported"


def arch(thickness, **rule):
    """Return the tables of the arch, on two blocks that are fixed below; stiff, since close to the
    least thickness it gives way far more than its joints are compressed. rule : of points."""
    inner, outer = RADIUS - thickness / 2, RADIUS + thickness / 2
    left, right = ([[side * r, -1.0] for r in (inner, outer)] for side in (-1, 1))
    outline = [*right, *(outer * RADIAL), *left[::-1], *(inner * RADIAL[::-1])]
    law = {"normal_stiffness": 1e11, "shear_stiffness": 1e11, "friction_angle": FRICTION}
    law |= {"tension": False, **rule}
    joints = [
        {"name": f"joint {k}", "dip": float(np.degrees(angle)), "spacing": 4 * RADIUS, **law}
        for k, angle in enumerate(ANGLES[:-1])
    ]
    return {
        "title": "Arch",
        "domain": {"outline": np.round(outline, 9).tolist()},
        "rock": {"density": 2000.0, "intact_modulus": 1e12, "intact_poisson": 0.2},
        "gravity": {},
        "boundaries": {"bottom": "fixed"},
        "joint_sets": joints,
        "time": {"duration": 0.01},
        "record": {"points": [[0.0, RADIUS]], "interval": 1e-3},
    }


def reserve(thickness, reach=1.0):
    """Return by how much, in m2 of rock's weight, forces at `reach` of the half thickness of
    all joints can push at least; negative where no thrust line stays within."""
    ends = RADIUS + reach * thickness / 2 * np.array([-1.0, 1.0])
    count = 4 * len(ANGLES)  # of each joint: pushes at both ends, shears at both ends
    balance, weight = np.zeros((3 * VOUSSOIRS, count + 1)), np.zeros(3 * VOUSSOIRS)
    faces = RADIUS + thickness / 2 * np.array([-1.0, 1.0])
    for i in range(VOUSSOIRS):
        corners = np.concatenate([faces[0] * RADIAL[i : i + 2], faces[1] * RADIAL[[i + 1, i]]])
        after = np.roll(corners, -1, axis=0)
        cross = corners[:, 0] * after[:, 1] - corners[:, 1] * after[:, 0]
        centre = cross @ (corners + after) / (3 * cross.sum())
        weight[3 * i + 1] = abs(cross.sum()) / 2
        for joint, sign in ((i, 1.0), (i + 1, -1.0)):
            for k, r in enumerate(ends):
                arm = r * RADIAL[joint] - centre
                for column, force in ((k, ALONG[joint]), (2 + k, RADIAL[joint])):
                    x, y = sign * force
                    moment = arm[0] * y - arm[1] * x
                    balance[3 * i : 3 * i + 3, 4 * joint + column] = x, y, moment
    pushes = (np.arange(count) % 4) < 2
    at_least = np.zeros((pushes.sum(), count + 1))
    at_least[np.arange(pushes.sum()), np.flatnonzero(pushes)], at_least[:, -1] = -1.0, 1.0
    found = linprog(
        np.append(np.zeros(count), -1.0),
        A_ub=at_least, b_ub=np.zeros(pushes.sum()), A_eq=balance, b_eq=weight, bounds=(None, None),
    )  # fmt: skip
    return found.x[-1]


@pytest.fixture(scope="module")
def least():
    """Return the least thickness over the radius at which the whole joints carry the arch."""
    found = brentq(lambda ratio: reserve(ratio * RADIUS), 0.05, 0.3, xtol=1e-6)
    assert found == pytest.approx(0.10546, abs=1e-5)
    # As the arch has no other length, a lever is a thinner arch of the same thrust line and weight.
    assert reserve(1.01 * found / 0.5 * RADIUS, 0.5) > 0 > reserve(0.99 * found / 0.5 * RADIUS, 0.5)
    return found


def stands(tables, solver, changes=None):
    """Return whether the tables have a static state, at which nothing moves; what falls is said to
    move."""
    try:
        found = jw.simulate(load_tables(tables, "", changes or {}), solver)
    except SceneError as error:
        assert re.search(MOVES, str(error)), error
        return False
    assert np.abs(found.velocity).max() < 1e-6  # m/s
    return True


@pytest.mark.parametrize("solver", ["dem", "continuum-jointed"])
@pytest.mark.parametrize(("ratio", "expected"), [(0.10, False), (0.12, True), (0.133, True)])
def test_arches_of_usual_thickness(ratio, expected, solver):
    """By default settings, on either side of 0.1075."""
    assert stands(arch(ratio * RADIUS), solver) == expected


@pytest.mark.parametrize(
    "rule",
    [{}, {"point_rule": "midpoint"}, {"point_rule": "midpoint", "contact_points": 4}],
    ids=["vertices", "midpoint 2", "midpoint 4"],
)
def test_blocks_stand_at_the_lever_of_their_points(least, rule):
    """That of the whole joint at its corners; twice the thickness at two midpoints. 2 % thinner
    falls."""
    reach = lever(rule.get("point_rule", "vertices"), rule.get("contact_points"))
    thickness = least / reach * RADIUS
    assert stands(arch(1.02 * thickness, **rule), "dem")
    assert not stands(arch(0.98 * thickness, **rule), "dem")


def test_deformable_rock_stands_at_the_lever_of_the_whole_joint(least):
    """Its points are the nodes of the facets, the edges of the joint among them."""
    assert stands(arch(1.02 * least * RADIUS), "continuum-jointed")
    assert not stands(arch(0.98 * least * RADIUS), "continuum-jointed")


def test_what_has_not_come_to_rest_is_not_said_to_slide(least):
    """No steps reach a tolerance below round-off: the line gives the residual and the key."""
    tables = arch(1.5 * least / 0.5 * RADIUS)
    refused = r"gravity: has not come to rest: out-of-balance ratio .*numerics.dem.static_tolerance"
    with pytest.raises(SceneError, match=refused):
        jw.simulate(load_tables(tables, "", {"numerics.dem.static_tolerance": 1e-17}), "dem")


SLOPE = {
    "title": "Block on a slope of 20 degrees",
    "domain": {"size": [4.0, 4.0]},
    "rock": {"density": 2000.0, "intact_modulus": 5e10, "intact_poisson": 0.2},
    "gravity": {"direction": [np.sin(np.radians(20.0)), -np.cos(np.radians(20.0))]},
    "boundaries": {"bottom": "fixed"},
    "joint_sets": [
        {"name": "plane", "dip": 0.0, "through": [0.0, 2.0], "friction_angle": 19.0}
        | {"normal_stiffness": 1e10, "shear_stiffness": 1e10, "tension": False}
    ],
    "time": {"duration": 0.01},
    "record": {"points": [[2.0, 3.0]], "interval": 1e-3},
    "numerics": {"dem": {"block": 2.0}},
}


@pytest.mark.parametrize("solver", ["dem", "continuum-jointed"])
def test_a_block_that_slides_slowly_slides(solver):
    """Friction of 19.99 degrees gives way at g (sin 20 - tan 19.99 cos 20) = 1.8 mm/s2, which is
    told from a residual that has not fallen yet; 20.01 degrees hold."""
    assert not stands(SLOPE, solver, {"joint_sets.0.friction_angle": 19.99})
    assert stands(SLOPE, solver, {"joint_sets.0.friction_angle": 20.01})


def test_the_acceleration_of_what_slides_is_said():
    """g (sin 20 - tan 19 cos 20) = 0.181 m/s2."""
    with pytest.raises(SceneError, match=r"the rock at .* moves on, at 0\.181 m/s2"):
        jw.simulate(load_tables(SLOPE, "", {}), "continuum-jointed")


def lines(tables, changes=None):
    """Return the warnings of contact points."""
    found = warnings(load_tables(tables, "", changes or {}))
    return [line for line in found if "point_rule" in line]


def test_points_far_from_the_edge_of_a_face_that_opens_are_warned_of_once():
    (line,) = lines(arch(2.0, point_rule="midpoint"))
    assert line.startswith("joint_sets[0].point_rule = 'midpoint' of 2 points")
    assert "at 0.5 of its half width" in line and "needs 2 times the thickness" in line
    assert lines(arch(2.0, point_rule="gauss", contact_points=8)) == []
    assert lines(arch(2.0, point_rule="midpoint", contact_points=4)) == lines(arch(2.0)) == []
    closed = {f"joint_sets.{k}.tension": True for k in range(VOUSSOIRS)}
    assert lines(arch(2.0, point_rule="midpoint"), closed) == []


def test_a_pillar_is_warned_of_them_where_it_bends(scene_with):
    def count(**changes):
        dotted = {k.replace("__", "."): v for k, v in changes.items()}
        return sum("joints.point_rule" in line for line in warnings(scene_with(**dotted)))

    across, opens = {"load__direction": [1.0, 0.0, 0.0]}, {"joints__tension": False}
    assert count(**opens, **across) == count(**opens, load__at=[0.1, 0.0]) == 1  # the paper's
    assert count(**opens) == count(**across) == 0
    assert count(**opens, **across, joints__point_rule="vertices") == 0
    assert count(**opens, **across, motion__rotation="none") == 0
    assert count(**opens, **across, joints__contact_points=8, joints__point_rule="gauss") == 0
