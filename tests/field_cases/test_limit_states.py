"""What stands by thrust, by friction on two planes, or on its edge, to a per cent or two.

Milankovitch: a semicircular arch stands from a thickness of 0.1075 times the radius of its centre
line on, with continuous radial joints that do not slide. Of 17 voussoirs with chords for faces a
linear programme finds 0.1055: a thrust line within the arch, in balance with the weights (lower
bound theorem; friction of 80 degrees decides nothing). Contact points at a lever of
the half thickness from the centre line divide it by the lever: the thrust line reaches no farther.

A wedge slides along the line s in which its planes meet. Its weight less the part along s is borne
by both planes, N_A n_A + N_B n_B, and friction along s by their sum: it stands as long as
(N_A + N_B) tan(phi) >= W s (Hoek & Bray, Rock Slope Engineering, 1981, chapter 8). That no shear
acts across s is their assumption. Springs in shear a tenth as stiff as those across the planes
leave little of it; equal ones lock some in, and the wedge then stands 2 % beyond.

A prism topples where tan(lean) h / 2 exceeds the distance from the centroid of its face to the edge
in that direction (chapter 9). Corners of faces are contact points, so blocks know the edge."""

import numpy as np
import pytest
from scipy.optimize import brentq, linprog

import jointwave as jw
from jointwave.cases.material.contact_points import lever
from jointwave.cases.read import load_tables
from jointwave.cases.warnings import warnings
from tests.field_cases.scenes import stands
from tests.rocks import rock

RADIUS, VOUSSOIRS = 10.0, 17  # m
ANGLES = np.pi * np.arange(VOUSSOIRS + 1) / VOUSSOIRS
RADIAL = np.stack([np.cos(ANGLES), np.sin(ANGLES)], axis=1)
ALONG = RADIAL @ [[0, 1], [-1, 0]]  # the normals of the joints
LAW = {"tension": False, "friction_angle": 80.0}
SHORT = {"gravity": {}, "time": {"duration": 0.01}}


def arch(thickness, **rule):
    """Return the tables of the arch, on two blocks that are fixed below; stiff, since close to the
    least thickness it gives way far more than its joints are compressed. rule : of points."""
    inner, outer = RADIUS - thickness / 2, RADIUS + thickness / 2
    left, right = ([[side * r, -1.0] for r in (inner, outer)] for side in (-1, 1))
    outline = [*right, *(outer * RADIAL), *left[::-1], *(inner * RADIAL[::-1])]
    law = LAW | {"normal_stiffness": 1e11, "shear_stiffness": 1e11, "spacing": 4 * RADIUS} | rule
    return SHORT | {
        "title": "Arch",
        "domain": {"outline": np.round(outline, 9).tolist()},
        "rock": {"density": 2000.0, "intact_modulus": 1e12, "intact_poisson": 0.2},
        "boundaries": {"bottom": "fixed"},
        "joint_sets": [
            {"name": f"joint {k}", "dip": float(np.degrees(angle)), **law}
            for k, angle in enumerate(ANGLES[:-1])
        ],
        "record": {"points": [[0.0, RADIUS]], "interval": 1e-3},
    }


def reserve(thickness, reach=1.0):
    """Return the least margin (m3 of rock's weight, a moment) of the best thrust line, which
    crosses all joints within `reach` of the half thickness; negative where none does.

    A force f with the moment m about the centre enters at the right; of what is below joint i the
    weight W and its moment M are taken off, and N = f.ALONG crosses it at the radius (m - M) / N.
    """
    faces = RADIUS + thickness / 2 * np.array([-1.0, 1.0])
    ends = RADIUS + reach * thickness / 2 * np.array([-1.0, 1.0])
    blocks = [
        centroid(np.concatenate([faces[0] * RADIAL[i : i + 2], faces[1] * RADIAL[[i + 1, i]]]))
        for i in range(VOUSSOIRS)
    ]
    area = np.abs([one for _, one in blocks])
    weight = np.append(0.0, np.cumsum(area))
    moment = np.append(0.0, np.cumsum(area * [centre[0] for centre, _ in blocks]))
    rows, most, ones = [], [], np.ones(len(ANGLES))
    for r, sign in zip(ends, (1, -1), strict=True):
        rows.append(np.column_stack([sign * r * ALONG, -sign * ones, ones]))
        most.append(sign * (r * ALONG[:, 1] * weight - moment))
    found = linprog([0, 0, 0, -1], np.concatenate(rows), np.concatenate(most), bounds=(None, None))
    return found.x[-1]


def centroid(corners):
    """Return the centroid [2] and the signed area of a polygon."""
    after = np.roll(corners, -1, axis=0)
    cross = corners[:, 0] * after[:, 1] - corners[:, 1] * after[:, 0]
    return cross @ (corners + after) / (3 * cross.sum()), cross.sum() / 2


@pytest.fixture(scope="module")
def least():
    """Return the least thickness over the radius at which the whole joints carry the arch."""
    found = brentq(lambda ratio: reserve(ratio * RADIUS), 0.05, 0.3, xtol=1e-6)
    assert found == pytest.approx(0.10546, abs=1e-5)
    # As the arch has no other length, a lever is a thinner arch of the same thrust line and weight.
    assert reserve(1.01 * found / 0.5 * RADIUS, 0.5) > 0 > reserve(0.99 * found / 0.5 * RADIUS, 0.5)
    return found


@pytest.mark.parametrize(
    ("engine", "rule"),
    [
        ("dem", {}),
        ("dem", {"point_rule": "midpoint"}),
        ("dem", {"point_rule": "midpoint", "contact_points": 4}),
        ("continuum-jointed", {}),
    ],
    ids=["vertices", "midpoint 2", "midpoint 4", "rock"],
)
def test_an_arch_stands_at_the_lever_of_its_points(least, engine, rule):
    """That of the whole joint at its corners, or nodes of deformable rock; twice the thickness at
    two midpoints. 2 % thinner falls."""
    thickness = least / lever(rule.get("point_rule", "vertices"), rule.get("contact_points"))
    for ratio in (1.02, 0.98):
        scene = load_tables(arch(ratio * thickness * RADIUS, **rule))
        assert stands(scene, engine) == (ratio > 1)


def test_what_has_not_come_to_rest_is_not_said_to_slide(least):
    """No steps reach a tolerance below round-off: the line gives the residual and the key."""
    tables = arch(3 * least * RADIUS) | {"numerics": {"dem": {"static_tolerance": 1e-17}}}
    refused = r"gravity: has not come to rest: out-of-balance ratio .*numerics.dem.static_tolerance"
    with pytest.raises(jw.SceneError, match=refused):
        jw.simulate(load_tables(tables), "dem")


def test_points_far_from_the_edge_of_a_face_that_opens_are_warned_of_once(pillar):
    def lines(**rule):
        found = warnings(load_tables(arch(2.0, **rule)))
        return [line for line in found if "point_rule" in line]

    (line,) = lines(point_rule="midpoint")
    assert line.startswith("joint_sets[0].point_rule = 'midpoint' of 2 points")
    assert "at 0.5 of its half width" in line and "needs 2 times the thickness" in line
    assert lines(point_rule="gauss", contact_points=8) == []
    assert lines(point_rule="midpoint", contact_points=4) == lines() == []
    assert lines(point_rule="midpoint", tension=True) == []

    def count(**changes):
        return sum("joints.point_rule" in line for line in warnings(pillar(**changes)))

    opens = {"joints.tension": False}
    bends = opens | {"load.direction": [1.0, 0.0, 0.0]}
    assert count(**bends) == count(**opens, **{"load.at": [0.1, 0.0]}) == 1  # the paper's
    assert count(**opens) == count(**(bends | {"joints.tension": True})) == 0
    fine = {"joints.point_rule": "gauss", "joints.contact_points": 8}
    for more in ({"joints.point_rule": "vertices"}, {"motion.rotation": "none"}, fine):
        assert count(**bends, **more) == 0


PLUNGE = np.radians(20.0)  # of s, to the south
LINE = np.array([0.0, -np.cos(PLUNGE), -np.sin(PLUNGE)])
RISES = np.radians([45.0, 60.0])  # of the planes, to the east and to the west
DOWN = np.array([0.0, 0.0, -1.0])


def wedge(friction, normals):
    """Return a box whose planes part a wedge, two blocks at its sides and one below, all but the
    wedge fixed at sides; friction : a tangent."""
    law = {"normal_stiffness": 1e10, "shear_stiffness": 1e9, "tension": False}
    law |= {"friction_angle": np.degrees(np.arctan(friction)).item(), "through": [5.0, 5.0, 3.5]}
    sets = [
        {"dip": np.degrees(np.arccos(n[2])).item()}
        | {"dip_direction": np.degrees(np.arctan2(n[0], n[1])).item() % 360}
        for n in normals
    ]
    held = {"boundaries": dict.fromkeys(("left", "right", "bottom"), "fixed")}
    record = {"points": [[5.0, 5.0, 5.0]], "interval": 1e-3}
    return rock([10.0, 10.0, 6.0], sets, law, **SHORT | held, record=record)


def test_a_wedge_stands_above_the_limit_and_slides_below():
    """By 1 %; what moves is the wedge, and the line says so."""
    along = np.stack([[1, -1] * np.cos(RISES), np.zeros(2), np.sin(RISES)], axis=1)
    normals = np.cross(LINE, along)
    normals *= (np.sign(normals[:, 2]) / np.linalg.norm(normals, axis=1))[:, None]
    borne = np.linalg.lstsq(normals.T, (DOWN @ LINE) * LINE - DOWN, rcond=None)[0]
    assert (borne > 0.2).all()
    limit = DOWN @ LINE / borne.sum()
    assert stands(wedge(1.01 * limit, normals))
    with pytest.raises(jw.SceneError, match=r"no static state: the block at \[.*, 4\..*\] moves"):
        jw.simulate(wedge(0.99 * limit, normals), "dem")


HEIGHT = 4.0  # m, of the upper prism
FACES = {  # counter-clockwise, m
    "parallelogram": [(0.0, 0.0), (2.0, 0.0), (2.4, 2.0), (0.4, 2.0)],
    "triangle": [(0.0, 0.0), (3.0, 0.0), (1.0, 2.0)],
    "trapezium": [(0.0, 0.0), (3.0, 0.0), (2.0, 1.5), (0.5, 1.5)],
    "pentagon": [(0.0, 0.0), (2.0, -0.5), (3.0, 1.0), (1.5, 2.0), (0.2, 1.2)],
}


def prisms(face):
    """Return the text of an OBJ file of two prisms, one on the other."""
    lines, n = [], len(face)
    for first, low, high in ((1, 0.0, 1.0), (1 + 2 * n, 1.0, 1.0 + HEIGHT)):
        bottom, top = (list(range(at, at + n)) for at in (first, first + n))
        sides = [[a, b, b + n, a + n] for a, b in zip(bottom, np.roll(bottom, -1), strict=True)]
        lines += [f"o {first}", *(f"v {x} {y} {z}" for z in (low, high) for x, y in face)]
        lines += ["f " + " ".join(map(str, one)) for one in (bottom[::-1], top, *sides)]
    return "\n".join(lines)


def edge(face, direction):
    """Return the distance from the centroid of a face to its edge in a direction [2], m."""
    x = np.array(face)
    along = np.roll(x, -1, axis=0) - x
    out = np.stack([along[:, 1], -along[:, 0]], axis=1)
    reach, ahead = ((x - centroid(x)[0]) * out).sum(axis=1), out @ direction
    return (reach[ahead > 0] / ahead[ahead > 0]).min()


@pytest.mark.parametrize("angle", [0.0, 45.0, 200.0], ids=lambda x: f"{x:.0f} degrees")
@pytest.mark.parametrize("face", FACES.values(), ids=FACES)
def test_prisms_topple_at_the_edge_of_their_face(face, angle, tmp_path, in_toml):
    """By one per cent of the limit."""
    direction = np.array([np.cos(np.radians(angle)), np.sin(np.radians(angle))])
    (tmp_path / "prisms.obj").write_text(prisms(face))
    law = {"normal_stiffness": 1e12, "shear_stiffness": 1e12}
    tables = SHORT | {
        "title": "prism",
        "domain": {"blocks": "prisms.obj"},
        "rock": {"density": 2500.0, "intact_modulus": 1e14, "intact_poisson": 0.2},
        "boundaries": {"bottom": "fixed"},
        "joint_sets": [{"name": "base", "dip": 0.0, "spacing": 9.0} | law | LAW],
        "record": {"points": [[1.0, 0.8, 2.0]], "interval": 1e-3},
    }
    for part in (0.99, 1.01):
        lean = part * 2 * edge(face, direction) / HEIGHT
        down = np.array([*(lean * direction), -1.0]) / np.hypot(lean, 1.0)
        text = in_toml(tables | {"gravity": {"direction": down.tolist()}})
        (tmp_path / "a.toml").write_text(text)
        assert stands(jw.load(tmp_path / "a.toml")) == (part < 1)
