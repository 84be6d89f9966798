"""The drawing of a scene shows all its parts, at their positions."""

from collections import Counter

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.figure import Figure
from matplotlib.patches import FancyArrowPatch, Rectangle

import cases
from compare.figures.drawing.actions import THICK, WIDTH, placement
from compare.figures.drawing.pulses import pulse_curve
from compare.figures.drawing.scene import draw_section, scene_figure
from compare.figures.drawing.side import MOST, _apart, draw_strip
from compare.misfit.pairs import Comparison
from compare.scenes import find

KEPT = (None, "blocks", "joints")  # groups whose parts no words stand near
LAYERS = [
    {"y": 20.0, "spacing_stiffness": 4.375e8},
    {"y": 30.0, "cohesion": 5.0e4},
]


def strip(scene) -> Axes:
    """Return the drawing of a pillar from the side."""
    ax = Figure().add_subplot()
    draw_strip(ax, scene)
    return ax


def section(scene) -> Axes:
    """Return the drawing of its section."""
    ax = Figure().add_subplot()
    draw_section(ax, scene)
    return ax


def parts(ax, name):
    """Return the artists of a drawing whose group is NAME-i."""
    return [a for a in ax.get_children() if (a.get_gid() or "").startswith(f"{name}-")]


def arrows(ax):
    return [p for p in ax.patches if isinstance(p, FancyArrowPatch)]


def words(ax):
    return [text.get_text() for text in ax.texts]


def test_every_block_joint_layer_and_receiver_is_drawn_in_its_place(pillar):
    scene = pillar(
        soft_layers=LAYERS, record__stress=[10.0, 20.0, 47.5], record__velocity=[0.25, 19.75]
    )
    ax, place = strip(scene), placement(scene)
    (blocks,) = [c for c in ax.collections if isinstance(c, PolyCollection)]
    (joints,) = [c for c in ax.collections if isinstance(c, LineCollection)]
    assert len(blocks.get_paths()) == 100 and len(joints.get_segments()) == 99
    at = [segment[0][0] for segment in joints.get_segments()]
    np.testing.assert_allclose(at, [place.x(y) for y in np.arange(0.5, 50, 0.5)])
    for name, key in (("stress", scene.record.stress), ("velocity", scene.record.velocity)):
        found = [float(mark.get_xdata()[0]) for mark in parts(ax, name)]
        np.testing.assert_allclose(found, [place.x(y) for y in key])
    middles = [patch.get_xy()[:4, 0].mean() for patch in parts(ax, "layer")]
    np.testing.assert_allclose(middles, [place.x(20.0), place.x(30.0)])
    assert {"σ 47.5 m", "v 0.25 m", "layer, 875 MPa/m", "cohesion 50 kPa"} <= set(words(ax))


def test_a_pillar_of_very_many_blocks_is_one_piece_with_its_count(pillar):
    count = 2 * MOST
    ax = strip(pillar(pillar__length=0.5 * count))
    (blocks,) = [c for c in ax.collections if isinstance(c, PolyCollection)]
    assert len(blocks.get_paths()) == 1
    assert any(f"{count} blocks of 0.5 m" in text for text in words(ax))


@pytest.mark.parametrize(
    ("end", "walls", "lines"), [("free", 0, 0), ("fixed", 1, 1), ("quiet", 1, 5), ("matched", 1, 6)]
)
def test_ends_are_drawn_as_what_holds_them(pillar, end, walls, lines):
    """A dashpot has four lines, a spring one, and so has the face of a wall."""
    held, free = strip(pillar(ends__end=end)), strip(pillar(ends__end="free"))
    hatched = [p for p in held.patches if isinstance(p, Rectangle) and p.get_hatch()]
    assert len(hatched) == walls
    assert len(held.lines) - len(free.lines) == lines
    assert f"{end} end" in words(held) and "free start" in words(held)


@pytest.mark.parametrize(
    ("changes", "count"),
    [
        ({}, 3),
        ({"ends__start": "matched"}, 2),
        ({"load__at": [0.1, 0.0]}, 1),
        ({"load__direction": [1.0, 0.0, 0.0]}, 1),
        ({"load__arm": 0.25}, 2),
        ({"load__amplitude": 0.0}, 0),
        ({"ends__start": "fixed", "load__quantity": "velocity", "load__amplitude": 1.0}, 1),
        ({"prestress__normal": 5e5}, 5),
        ({"gravity__direction": [0.0, 1.0, 0.0], "ends__end": "fixed"}, 4),
    ],
)
def test_what_acts_is_drawn_as_arrows(pillar, changes, count):
    assert len(arrows(strip(pillar(**changes)))) == count


@pytest.mark.parametrize("direction", [[0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [-0.6, 0.8, 0.0]])
def test_arrows_point_along_the_load(pillar, direction):
    for arrow in arrows(strip(pillar(load__direction=direction))):
        (x0, y0), (x1, y1) = arrow._posA_posB
        along = np.array([y1 - y0, x1 - x0]) / np.hypot(x1 - x0, y1 - y0)
        np.testing.assert_allclose(along, direction[:2], atol=1e-12)


@pytest.mark.parametrize(("normal", "inward"), [(5e5, True), (-5e5, False)])
def test_prestress_points_inward_in_compression(pillar, normal, inward):
    scene = pillar(prestress__normal=normal, load__amplitude=0.0)
    middle = placement(scene).x(25.0)
    for arrow in arrows(strip(scene)):
        (x0, _), (x1, _) = arrow._posA_posB
        assert (abs(x1 - middle) < abs(x0 - middle)) == inward


@pytest.mark.parametrize(("n", "rule"), [(2, "midpoint"), (3, "gauss")])
def test_contact_points_are_drawn_where_the_scene_moves_in_space(pillar, n, rule):
    joints = {"joints__contact_points": n, "joints__point_rule": rule}
    ax = section(pillar(load__at=[0.1, 0.0], **joints))
    (points,) = [c for c in ax.collections if c.get_gid() == "contacts"]
    assert len(points.get_offsets()) == n * n
    assert not section(pillar(**joints)).collections


def test_a_squat_pillar_is_true_to_scale_and_a_slender_one_says_by_how_much(pillar):
    squat = pillar(pillar__length=4.0, pillar__side=2.0, record__stress=[2.0])
    place = placement(squat)
    assert place.thick == pytest.approx(place.scale * 2.0) and place.thick > THICK
    assert not any("thickness ×" in text for text in words(strip(squat)))
    slender = strip(pillar())
    place = placement(pillar())
    times = place.thick / (place.scale * 0.5)
    assert times > 5 and any(f"thickness × {times:.2g}" in text for text in words(slender))


def test_labels_move_apart_as_far_as_they_must():
    """By the least shifts, and within the available width."""
    wanted, widths = np.array([1.0, 1.1, 1.2, 5.0]), np.full(4, 0.5)
    assert _apart(wanted, widths, 7.0) == pytest.approx([0.6, 1.1, 1.6, 5.0])
    assert _apart(wanted, widths, 5.0) == pytest.approx([0.6, 1.1, 1.6, 4.75])
    assert _apart(wanted - 1.0, widths, 7.0) == pytest.approx([0.25, 0.75, 1.25, 4.0])


@pytest.mark.parametrize(
    "changes",
    [
        {"prestress__normal": 1e7, "record__stress": [10.0, 25.0], "soft_layers": LAYERS},
        {"record__stress": [6.25 * i for i in range(9)], "prestress__normal": -1.5e6},
        {"gravity__direction": [-1.0, 0.0, 0.0], "ends__end": "fixed", "record__stress": [49.5]},
        {"pillar__length": 2.0, "pillar__side": 1.0, "record__stress": [1.0], "ends__end": "quiet"},
        {"ends__end": "matched", "record__velocity": [19.75, 20.25], "prestress__normal": 5e5},
    ],
)
def test_words_lie_over_nothing_else(pillar, collisions, changes):
    """Neither over each other nor over arrows, layers and the marks of receivers."""
    picture = scene_figure("fig", [Comparison(pillar(**changes))]).figure
    assert collisions(picture) == []
    renderer = picture.canvas.get_renderer()
    ax = picture.axes[0]
    drawn = [*ax.patches, *(a for a in ax.get_children() if a.get_gid() not in KEPT)]
    for text in ax.texts:
        box = text.get_window_extent(renderer)
        for artist in drawn:
            assert not box.overlaps(artist.get_window_extent(renderer)), (text, artist)


def test_no_labels_where_there_is_no_room_for_them(pillar):
    ax = strip(pillar(record__stress=[float(y) for y in range(1, 50)]))
    assert len(parts(ax, "stress")) == 49
    assert not any(text.startswith("σ") for text in words(ax))


def test_load_is_drawn_from_its_history(pillar):
    time, values = pulse_curve(pillar().load, pillar().time.duration)
    assert time[-1] == pytest.approx(0.0125)
    assert values.max() == pytest.approx(1e6, rel=1e-4) and values.min() == pytest.approx(
        -1e6, rel=1e-4
    )
    step_load = pillar(load={"shape": "step", "amplitude": 2e5}).load
    _, step = pulse_curve(step_load, 0.12)
    assert (step[1:] == 2e5).all()


def test_variants_that_look_alike_share_a_drawing(pillar, ink):
    scenes = [
        pillar().model_copy(update={"name": "a"}),
        pillar(joints__damping_ratio=0.1).model_copy(update={"name": "b"}),
        pillar(soft_layers=LAYERS).model_copy(update={"name": "c"}),
    ]
    picture = scene_figure("fig", [Comparison(scene) for scene in scenes])
    assert [text.get_text() for text in picture.figure.texts] == ["(a)  a, b", "(b)  c"]
    parts = Counter(zip(picture.table["variant"], picture.table["part"], strict=True))
    assert parts["a, b", "block"] == parts["c", "block"] == 100
    assert parts["c", "soft layer"] == 2 and parts["a, b", "soft layer"] == 0
    assert parts["c", "joint"] == 99 and parts["c", "receiver"] == 1 and parts["c", "end"] == 2
    assert ink(picture.figure) > 0.01


@pytest.mark.parametrize(
    "name",
    [
        "beyond/eccentric-blow",
        "beyond/torsion",
        "beyond/shaken-base",
        "beyond/block-on-incline",
        "beyond/thin-layer",
        "beyond/blast-history",
        "hard/everything-fails",
    ],
)
def test_shipped_scenes_are_drawn_within_the_figure(name, ink):
    scenes = cases.load(find(name))
    picture = scene_figure("fig", [Comparison(scene) for scene in scenes])
    assert 0.005 < ink(picture.figure) < 0.3
    strips = [ax for ax in picture.figure.axes if ax.get_xlim() == (0.0, WIDTH)]
    renderer = picture.figure.canvas.get_renderer()
    for ax in strips:
        frame_box = ax.get_window_extent(renderer)
        for text in ax.texts:
            box = text.get_window_extent(renderer)
            assert box.x0 >= frame_box.x0 - 1 and box.x1 <= frame_box.x1 + 1, text.get_text()
            assert box.y0 >= frame_box.y0 - 1 and box.y1 <= frame_box.y1 + 1, text.get_text()
