"""The drawing of a scene shows all its parts, at their positions and to scale."""

from collections import Counter

import numpy as np
import pytest
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.colors import to_hex
from matplotlib.text import Annotation

from jointwave.cases.read import load_tables
from jointwave.compare.figures.drawing.plane import THIN, sketch_of
from jointwave.compare.figures.drawing.scene import pulse_curve, scene_figure
from jointwave.compare.figures.drawing.sketch import INK, MANY, SETS
from jointwave.compare.misfit.pairs import Comparison

LAYERS = [{"y": 20.0, "spacing_stiffness": 4.375e8}, {"y": 30.0, "cohesion": 5.0e4}]
JOINTS = {"normal_stiffness": 1e10, "shear_stiffness": 4e9}
PULSE = {"shape": "ricker", "period": 0.005, "amplitude": 1e6}
TABLES = {
    "title": "A tunnel in brickwork",
    "domain": {"size": [10.0, 6.0], "openings": [[[4, 2], [6, 2], [6, 4], [4, 4]]]},
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


def drawing(*scenes):
    """Return the picture of scenes, which are variants a, b, ... where they are several."""
    if len(scenes) > 1:
        scenes = [one.model_copy(update={"name": "abc"[k]}) for k, one in enumerate(scenes)]
    return scene_figure("fig", [Comparison(one) for one in scenes])


def mass(**changes):
    return drawing(load_tables(TABLES | changes)).figure


def words(figure):
    (found,) = figure.legends
    return [text.get_text() for text in found.texts]


def arrows(figure):
    """Return tail and tip of every arrow [n, 2, 2], m."""
    found = [text for text in figure.axes[0].texts if isinstance(text, Annotation)]
    return np.array([(one.xyann, one.xy) for one in found])


def length(figure, colour):
    """Return the length of all lines of a colour in the drawing, m."""
    found = [c for c in figure.axes[0].collections if isinstance(c, LineCollection)]
    own = [c.get_segments() for c in found if to_hex(c.get_colors()[0]) == colour]
    return sum(np.hypot(*np.diff(segments, axis=1)[:, 0].T).sum() for segments in own)


def test_every_block_joint_layer_and_receiver_is_drawn_in_its_place(pillar):
    record = {"record__stress": [10.0, 20.0, 47.5], "record__velocity": [0.25, 19.75]}
    figure = drawing(pillar(soft_layers=LAYERS, **record)).figure
    ax = figure.axes[0]
    (blocks,) = [c for c in ax.collections if isinstance(c, PolyCollection)]
    joints, *layers = [c for c in ax.collections if isinstance(c, LineCollection)]
    assert len(blocks.get_paths()) == 100
    places = [segment[0][0] for segment in joints.get_segments()]
    np.testing.assert_allclose(places, np.setdiff1d(np.arange(0.5, 50, 0.5), [20.0, 30.0]))
    assert [lines.get_segments()[0][0][0] for lines in layers[:2]] == [20.0, 30.0]
    assert [list(line.get_xdata()) for line in ax.lines] == [[10.0, 20.0, 47.5], [0.25, 19.75]]
    assert words(figure) == [
        *("layer at y = 20 m, 875 MPa/m", "layer at y = 30 m", "free start", "free end"),
        *("section: stress", "point: velocity"),
    ]


@pytest.mark.parametrize(
    ("changes", "count", "said"),
    [
        ({"load__at": [0.1, 0.0]}, 1, []),
        ({"load__at": [0.1, 0.2]}, 1, ["at z = 0.2 m"]),
        ({"load__direction": [0.0, 0.0, 1.0]}, 0, ["load along z"]),
        ({"load__direction": [0.0, 0.8, 0.6]}, 1, ["load also along z"]),
        ({"load__arm": 0.25}, 0, ["couple about (0, 1, 0)"]),
        ({"load__amplitude": 0.0}, 0, []),
        ({"ends__start": "fixed", "load__quantity": "velocity", "load__amplitude": 1.0}, 1, []),
        ({"prestress__normal": 5e5}, 1, ["prestress 500 kPa"]),
        ({"gravity__direction": [0.0, 1.0, 0.0], "ends__end": "fixed"}, 2, ["9.81 m/s²"]),
    ],
)
def test_what_acts_is_drawn_as_arrows_or_said(pillar, changes, count, said):
    figure = drawing(pillar(**changes)).figure
    notes = [text.get_text() for text in figure.axes[0].texts if text.get_text()]
    assert len(arrows(figure)) == count and notes == said


@pytest.mark.parametrize("direction", [[0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [-0.6, 0.8, 0.0]])
def test_an_arrow_points_along_the_load(pillar, direction):
    """As drawn: what is up is stretched."""
    scene = pillar(load__direction=direction)
    ((tail, tip),) = arrows(drawing(scene).figure)
    along = (tip - tail) * [1.0, sketch_of(scene).stretch]
    np.testing.assert_allclose(along / np.hypot(*along), direction[1::-1], atol=1e-12)


def test_load_is_drawn_from_its_history(pillar):
    time, values = pulse_curve(pillar().load, pillar().time.duration)
    assert time[-1] == pytest.approx(0.0125)
    assert [values.min(), values.max()] == pytest.approx([-1e6, 1e6], rel=1e-4)


def test_a_squat_pillar_is_true_to_scale_and_a_slender_one_says_by_how_much(pillar):
    squat = sketch_of(pillar(pillar__length=4.0, pillar__side=2.0, record__stress=[2.0]))
    assert squat.stretch == 1 and "thickness ×" not in squat.size
    slender = sketch_of(pillar())
    assert slender.stretch * 0.5 == pytest.approx(THIN * (slender.high[0] - slender.low[0]))
    assert f"thickness × {slender.stretch:.2g}" in slender.size
    count = 2 * MANY
    blocks, joints, *_ = (many := sketch_of(pillar(pillar__length=0.5 * count))).shapes
    assert blocks.get_rasterized() and joints.get_rasterized()
    assert f"{count:,} blocks of 0.5 m" in many.size


@pytest.mark.parametrize(
    "changes",
    [
        {"prestress__normal": 1e7, "record__stress": [10.0, 25.0], "soft_layers": LAYERS},
        {"gravity__direction": [-1.0, 0.0, 0.0], "ends__end": "fixed", "record__stress": [49.5]},
        {"pillar__length": 2.0, "pillar__side": 1.0, "record__stress": [1.0], "ends__end": "quiet"},
    ],
)
def test_words_lie_over_nothing_else(pillar, collisions, changes):
    assert collisions(drawing(pillar(**changes)).figure) == []


def test_labels_of_slender_rock_in_map_coordinates_lie_beside_each_other(collisions):
    corners = [[1200.0, 300.0], [1202.0, 300.0], [1202.0, 350.0], [1200.0, 350.0]]
    changes = {"joint_sets": TABLES["joint_sets"][:1], "record": {"points": [[1201.0, 325.0]]}}
    assert collisions(mass(domain={"outline": corners}, waves=[], **changes)) == []


def test_variants_that_look_alike_share_a_drawing(pillar, ink):
    picture = drawing(pillar(), pillar(joints__damping_ratio=0.1), pillar(soft_layers=LAYERS))
    titles = [ax.get_title("left") for ax in picture.figure.axes]
    assert titles[::2] == ["(a)  a, b", "(b)  c"]
    parts = Counter(zip(picture.table["variant"], picture.table["what"], strict=True))
    assert parts["a, b", "joints"] == 99 and parts["c", "joints"] == 97
    assert parts["c", "layer at y = 20 m, 875 MPa/m"] == 1 and parts["c", "free start"] == 1
    assert parts["c", "section: stress"] == 1 and len(parts) == 5 + 7
    assert ink(picture.figure) > 0.01


def test_every_joint_and_side_is_drawn_and_is_in_the_table(collisions):
    """Five rows of 10 m less 2 m each of the three that the tunnel takes or runs along; four cross
    joints of 6 m less 2 m each of the two along its faces."""
    picture = drawing(load_tables(TABLES))
    assert length(picture.figure, SETS[0]) == pytest.approx(50 - 3 * 2)
    assert length(picture.figure, SETS[1]) == pytest.approx(24 - 2 * 2)
    assert length(picture.figure, INK) == pytest.approx(2 * (10 + 6) + 2 * (2 + 2))
    sides = ["quiet side", "free side", "fixed side"]
    assert words(picture.figure) == ["rows", "cross", *sides, "point", "point of a joint"]
    loaded = mass(gravity={}, prestress={"xx": 1e6, "yy": 3e6})
    assert not [one for one in collisions(loaded) if "axes" not in one.lower()]
    x, y, to_x, to_y = picture.table.loc[:, "from x (m)":].to_numpy(dtype=float).T
    lengths = picture.table.assign(m=np.hypot(to_x - x, to_y - y)).groupby("what").m.sum()
    assert lengths["rows"] == pytest.approx(44) and lengths["cross"] == pytest.approx(20)
    assert lengths[sides].sum() == pytest.approx(40)
    assert picture.table.what.tolist()[-3:] == ["point"] * 2 + ["point of a joint"]


def test_a_wave_enters_along_its_travel():
    """Its arrow ends where the line through the middle of the domain, (5, 3), meets the bottom or
    the left side: 0.01 of the smaller size, 6 m, before (5 - 3 x 0.6/0.8, 0)."""
    (motion, _), (tail, tip) = arrows(mass())
    along = (tip - tail) / np.hypot(*(tip - tail))
    np.testing.assert_allclose(along, [0.6, 0.8])
    np.testing.assert_allclose(tip, [5 - 2.25 - 0.036, -0.048], atol=1e-12)
    assert motion @ along != pytest.approx(tail @ along)  # of its particles, beside it


FORCE = {"kind": "force", "quantity": "force", "at": [2.0, 2.0], "direction": [0.0, 1.0]}


@pytest.mark.parametrize(
    ("load", "towards"),
    [
        ({"kind": "pressure", "opening": 0}, lambda tip: tip - [5.0, 3.0]),
        ({"kind": "pressure", "side": "right"}, lambda tip: [-1.0, 0.0]),
        (FORCE, lambda tip: [0.0, 1.0]),
    ],
)
def test_a_load_pushes_on_the_rock(load, towards):
    """Arrows of a pressure end on the wall and point into the rock, that of a force at it."""
    tail, tip = arrows(mass(waves=[], loads=[load | PULSE])).swapaxes(0, 1)
    assert ((tip - tail) * towards(tip)).sum(axis=1).min() > 0
    if load == FORCE:
        np.testing.assert_allclose(tip, [FORCE["at"]])
