"""The drawing of a rock mass: every joint, side, action and receiver of the scene, to scale."""

import numpy as np
import pytest
from matplotlib.collections import LineCollection
from matplotlib.colors import to_hex
from matplotlib.text import Annotation

from jointwave.cases.read import load_tables
from jointwave.compare.figures.drawing.bodies import SETS
from jointwave.compare.figures.drawing.scene import scene_figure
from jointwave.compare.figures.drawing.sketch import INK
from jointwave.compare.misfit.pairs import Comparison

JOINTS = {"normal_stiffness": 1e10, "shear_stiffness": 4e9}
PULSE = {"shape": "ricker", "period": 0.005, "amplitude": 1e6}
TUNNEL = [[4.0, 2.0], [6.0, 2.0], [6.0, 4.0], [4.0, 4.0]]
TABLES = {
    "title": "A tunnel in brickwork",
    "domain": {"size": [10.0, 6.0], "openings": [TUNNEL]},
    "rock": {"density": 2600.0, "intact_modulus": 5e10},
    "joint_sets": [
        {"name": "rows", "dip": 0.0, "spacing": 1.0, "friction_angle": 30.0, **JOINTS},
        {"name": "cross", "dip": 90.0, "spacing": 2.0, "ends_at": ["rows"], **JOINTS},
    ],
    "waves": [{"kind": "S", "direction": [0.6, 0.8], **PULSE}],
    "boundaries": {"left": "quiet", "bottom": "quiet", "top": "fixed"},
    "time": {"duration": 0.1},
    "record": {"points": [[1.0, 3.5], [8.5, 4.5]], "joints": [[8.0, 1.0]]},
}


@pytest.fixture
def drawing():
    """Return a function that draws a scene of TABLES with tables changed."""

    def draw(**changes):
        scene = load_tables(TABLES | changes)
        return scene_figure("mass", [Comparison(scene)])

    return draw


def lines(figure, colour):
    """Return the lines of a colour in the drawing [n, 2, 2], m."""
    found = [c for c in figure.axes[0].collections if isinstance(c, LineCollection)]
    own = [c.get_segments() for c in found if to_hex(c.get_colors()[0]) == colour]
    return np.array([segment for segments in own for segment in segments])


def arrows(figure):
    """Return tails and tips of arrows, each [n, 2], m."""
    found = [text for text in figure.axes[0].texts if isinstance(text, Annotation)]
    return np.array([one.xyann for one in found]), np.array([one.xy for one in found])


def length(segments):
    return np.hypot(*np.diff(segments, axis=1)[:, 0].T).sum()


def test_every_joint_is_drawn_in_the_colour_of_its_set(drawing):
    """Five rows of 10 m less 2 m each of the three that the tunnel takes or runs along; four cross
    joints of 6 m less 2 m each of the two along its faces."""
    figure = drawing().figure
    assert length(lines(figure, SETS[0])) == pytest.approx(50 - 3 * 2)
    assert length(lines(figure, SETS[1])) == pytest.approx(24 - 2 * 2)
    (legend,) = figure.legends
    assert [text.get_text() for text in legend.texts] == [
        *("rows", "cross", "quiet side", "free side", "fixed side", "point", "point of a joint")
    ]


def test_sides_and_the_opening_are_drawn(drawing):
    assert length(lines(drawing().figure, INK)) == pytest.approx(2 * (10 + 6) + 2 * (2 + 2))


def test_a_wave_enters_along_its_travel(drawing):
    """Its arrow ends where the line through the middle of the domain, (5, 3), meets the bottom or
    the left side: 0.01 of the smaller size, 6 m, before (5 - 3 x 0.6/0.8, 0)."""
    (motion, tail), (_, tip) = arrows(drawing().figure)
    along = (tip - tail) / np.hypot(*(tip - tail))
    np.testing.assert_allclose(along, [0.6, 0.8])
    np.testing.assert_allclose(tip, [5 - 2.25 - 0.036, -0.048], atol=1e-12)
    assert motion @ along != pytest.approx(tail @ along)  # of its particles, beside it


@pytest.mark.parametrize(
    ("load", "towards"),
    [
        ({"kind": "pressure", "opening": 0}, lambda tip: tip - [5.0, 3.0]),
        ({"kind": "pressure", "side": "right"}, lambda tip: [[-1.0, 0.0]] * len(tip)),
        (
            {"kind": "force", "quantity": "force", "at": [2.0, 2.0], "direction": [0.0, 1.0]},
            lambda tip: [[0.0, 1.0]] * len(tip),
        ),
    ],
)
def test_a_load_pushes_on_the_rock(drawing, load, towards):
    """Arrows of a pressure end on the wall and point into the rock, that of a force at it."""
    figure = drawing(waves=[], loads=[load | PULSE]).figure
    tail, tip = arrows(figure)
    assert ((tip - tail) * towards(tip)).sum(axis=1).min() > 0
    if load["kind"] == "force":
        np.testing.assert_allclose(tip, [[2.0, 2.0]])


def test_the_table_holds_every_line(drawing):
    table = drawing().table
    ends = table[table.what.isin(["rows", "cross"])].loc[:, "from x (m)":]
    total = length(ends.to_numpy(dtype=float).reshape(-1, 2, 2))
    assert total == pytest.approx(44 + 20)
    assert table.what.tolist()[-3:] == ["point"] * 2 + ["point of a joint"]
    assert {"quiet side", "free side", "fixed side"} < set(table.what)


def test_variants_that_look_alike_share_a_drawing():
    base = load_tables(TABLES)
    longer = load_tables(TABLES | {"time": {"duration": 0.2}})
    other = load_tables(TABLES | {"boundaries": TABLES["boundaries"] | {"top": "free"}})
    named = [
        Comparison(one.model_copy(update={"name": name}))
        for one, name in zip((base, longer, other), "abc", strict=True)
    ]
    table = scene_figure("mass", named).table
    assert table.variant.unique().tolist() == ["a, b", "c"]


def test_nothing_lies_over_anything(drawing, collisions):
    gravity = {"gravity": {}, "prestress": {"xx": 1e6, "yy": 3e6}}
    for changes in ({}, gravity):
        found = collisions(drawing(**changes).figure)
        assert not [one for one in found if "axes" not in one.lower()], found
