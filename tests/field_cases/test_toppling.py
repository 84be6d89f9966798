"""A prism that stands on another under gravity that leans, on faces of any shape.

Its weight leaves the base, and it topples, where tan(lean) h / 2 exceeds the distance from the
centroid of its face to the edge in that direction (Hoek & Bray, Rock Slope Engineering, 1981,
chapter 9, for a block on a slope). Corners of faces are contact points, so blocks know the edge.
"""

import re

import numpy as np
import pytest

import jointwave as jw
from jointwave.cases.errors import SceneError
from jointwave.cases.validate import validated

HEIGHT = 4.0  # m, of the upper prism
FACES = {  # counter-clockwise, m
    "square": [(0.0, 0.0), (2.0, 0.0), (2.0, 2.0), (0.0, 2.0)],
    "triangle": [(0.0, 0.0), (3.0, 0.0), (1.0, 2.0)],
    "trapezium": [(0.0, 0.0), (3.0, 0.0), (2.0, 1.5), (0.5, 1.5)],
    "pentagon": [(0.0, 0.0), (2.0, -0.5), (3.0, 1.0), (1.5, 2.0), (0.2, 1.2)],
}
FALLS = r"no static state.* moves .*it slides, tips or is unsupported"


def prisms(face):
    """Return the text of an OBJ file of two prisms, one on the other."""
    lines, count = [], len(face)
    for k, (low, high) in enumerate(((0.0, 1.0), (1.0, 1.0 + HEIGHT))):
        first = 1 + 2 * count * k
        bottom, top = (list(range(at, at + count)) for at in (first, first + count))
        sides = [
            [a, b, b + count, a + count] for a, b in zip(bottom, np.roll(bottom, -1), strict=True)
        ]
        lines.append(f"o {k}")
        lines += [f"v {x} {y} {z}" for z in (low, high) for x, y in face]
        lines += ["f " + " ".join(map(str, one)) for one in (bottom[::-1], top, *sides)]
    return "\n".join(lines)


def edge(face, direction):
    """Return the distance from the centroid of a face to its edge in a direction [2], m."""
    x = np.array(face)
    after = np.roll(x, -1, axis=0)
    twice = x[:, 0] * after[:, 1] - x[:, 1] * after[:, 0]
    centre = twice @ (x + after) / (3 * twice.sum())
    out = np.stack([after[:, 1] - x[:, 1], x[:, 0] - after[:, 0]], axis=1)
    reach, ahead = ((x - centre) * out).sum(axis=1), out @ direction
    return (reach[ahead > 0] / ahead[ahead > 0]).min()


def stands(folder, face, direction, lean):
    """Return whether the upper prism stands under gravity of this tangent to the vertical."""
    (folder / "prisms.obj").write_text(prisms(face))
    law = {"normal_stiffness": 1e12, "shear_stiffness": 1e12, "friction_angle": 80.0}
    down = np.array([*(lean * np.array(direction)), -1.0]) / np.hypot(lean, 1.0)
    tables = {
        "title": "prism",
        "domain": {"blocks": "prisms.obj"},
        "rock": {"density": 2500.0, "intact_modulus": 1e14, "intact_poisson": 0.2},
        "gravity": {"direction": down.tolist()},
        "boundaries": {"bottom": "fixed"},
        "joint_sets": [{"name": "base", "dip": 0.0, "spacing": 9.0, "tension": False} | law],
        "time": {"duration": 1e-3},
        "record": {"points": [[1.0, 0.8, 2.0]], "interval": 1e-3},
    }
    try:
        jw.simulate(validated(tables, folder / "prisms.toml", frozenset()), "dem")
    except SceneError as error:
        assert re.search(FALLS, str(error)), error
        return False
    return True


@pytest.mark.parametrize("angle", [0.0, 45.0, 200.0], ids=lambda x: f"{x:.0f} degrees")
@pytest.mark.parametrize("face", FACES.values(), ids=FACES)
def test_prisms_topple_at_the_edge_of_their_face(face, angle, tmp_path):
    """By one per cent of the limit."""
    direction = np.cos(np.radians(angle)), np.sin(np.radians(angle))
    limit = 2 * edge(face, direction) / HEIGHT
    assert stands(tmp_path, face, direction, 0.99 * limit)
    assert not stands(tmp_path, face, direction, 1.01 * limit)
