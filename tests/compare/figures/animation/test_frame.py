"""The pictures: all that moves does, where it is, and the words are there."""

import numpy as np
import pytest
from matplotlib.text import Text

from jointwave.cases.read import load_tables
from jointwave.compare.engines import label_of
from jointwave.compare.figures.animation.frame import Frame, draw_snapshots
from jointwave.compare.figures.animation.snapshots import SceneSnapshots, settings_for
from jointwave.compare.figures.export import save
from jointwave.compare.figures.style import style
from jointwave.results.snapshots import snapshots


def words(frame):
    return "\n".join(text.get_text() for text in frame.figure.findobj(Text))


@pytest.fixture(scope="module")
def frame(simulated):
    return Frame(simulated())


def test_blocks_of_both_engines_are_drawn_where_they_are_in_their_colours(frame):
    first = frame.image(20)
    assert first.shape == (720, 1280, 4) and (frame.image(5) != first).any()
    np.testing.assert_array_equal(frame.image(20), first)
    assert list(frame.views) == ["dem", "continuum-jointed"]
    for name, view in frame.views.items():
        s, body = frame.simulated.found[name], frame.bodies[name]
        colours = view.faces.to_rgba(view.faces.get_array())
        assert np.abs(colours[:, 0] - colours[:, 2]).max() > 0.2
        assert len(view.faces.get_array()) == len(body.faces) / 2  # the others face away
        assert set(view.faces.get_array()) <= set(body.values[20])
        places = np.concatenate([path.vertices for path in view.faces.get_paths()])
        moved = s.points[:, 1] + frame.settings.scale * s.displacement[20, :, 1]
        aside = 0.1 * 0.5 * frame.simulated.scene.pillar.side * frame.settings.stretch
        assert places[:, 0].min() == pytest.approx(moved.min() - aside, abs=1e-9)
        assert places[:, 0].max() == pytest.approx(moved.max() + aside, abs=1e-9)
        assert frame.profiles[name].get_color() == style(name).colour
        np.testing.assert_array_equal(frame.profiles[name].get_ydata(), frame.along[name].iloc[20])


def test_the_picture_says_when_how_much_and_who(frame, collisions):
    frame.show(20)
    said = words(frame)
    assert f"displacements × {frame.settings.scale:,g}" in said and "thickness × 2" not in said
    assert "axial stress (MPa), compression positive" in said and "t = 10.00 ms" in said
    assert all(label_of(name) in said for name in frame.bodies)
    assert collisions(frame.figure) == []


@pytest.mark.parametrize("title", ["A title of many words, " * 12, "w" * 200])
def test_a_title_of_any_length_is_whole(simulated, collisions, title):
    taken = simulated()
    scene = taken.scene.model_copy(update={"title": title.strip()})
    reasons = {"continuum-jointed": "it costs $1 or $2 " * 10}
    frame = Frame(taken._replace(scene=scene, found={"dem": taken.found["dem"]}, reasons=reasons))
    frame.show(40)
    frame.clock.set_animated(False)
    assert collisions(frame.figure) == [] and list(frame.views) == ["dem"]
    said = words(frame).replace("\n", "").replace(" ", "")
    assert title.replace(" ", "") in said and "itcosts$1or$2" in said


def test_a_receiver_is_drawn_sample_by_sample_up_to_the_frame(simulated):
    """Six frames miss the wave's peaks; the samples between them are drawn all the same."""
    taken = simulated(6)
    frame = Frame(taken)
    (label,) = {trace.axes.get_ylabel() for trace in frame.traces.values()}
    size = {"stress\n(MPa)": 1e6, "stress\n(kPa)": 1e3}[label]
    for i in (0, 3, 5):
        frame.show(i)
        for name, result in taken.results.items():
            times, values = frame.traces[name].get_data()
            recorded = result.stress.values[0, result.time.values <= frame.time[i] + 1e-9] / size
            np.testing.assert_allclose(values, recorded)
            assert times[-1] == pytest.approx(1e3 * frame.time[i])


def test_a_pillar_at_rest_is_drawn(simulated):
    taken = simulated()
    still = {
        n: s._replace(displacement=0 * s.displacement, stress=0 * s.stress)
        for n, s in taken.found.items()
    }
    assert Frame(taken._replace(found=still)).image(20).std() > 0


def test_snapshots_are_drawn_in_the_colour_of_their_stress(row, pillar, collisions, tmp_path):
    """Three unit blocks: the second moves a little to the right, the third turns about x. The three
    faces of each block that face the viewer are drawn, compression red and tension blue; each
    instant is a group of the SVG."""

    def moved(points):
        at = np.repeat([0, 1, 2], 8)
        turned = np.where(at == 2, 0.1, 0.0)  # rad
        along = 0.01 * (at == 1) + turned * points[:, 2]
        return np.stack([0 * along, along, -turned * (points[:, 1] - 2.5)], axis=1)

    scene = pillar(pillar={"length": 3.0, "side": 1.0, "block": 1.0}, record={"stress": [1.0]})
    blocks = row(displacement=moved, stress=[[0.0, 0.0, 0.0], [2e6, -1e6, 0.0]])
    figure = draw_snapshots("row", scene, blocks)
    assert collisions(figure) == []
    first, second = (ax.collections[0].get_facecolor() for ax in figure.axes[:2])
    assert len(first) == len(second) == 9
    red_over_blue = second[:, 0] - second[:, 2]
    assert (red_over_blue > 0.2).sum() == (red_over_blue < -0.2).sum() == 3
    assert [ax.get_ylabel() for ax in figure.axes[:2]] == ["0 ms", "1 ms"]
    assert "displacements × " in figure.axes[1].get_xlabel()
    svg = save(figure, tmp_path, "row", "A row").file("svg").read_text()
    assert 'id="row-0"' in svg and 'id="row-1"' in svg and "compression positive" in svg


SQUARE = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])


@pytest.fixture
def squares(one_joint):
    """Two squares of 1 m, of which the right one moves by 1e-4 m along (0.6, 0.8) at 2 m/s."""
    points = np.concatenate([SQUARE, np.add(SQUARE, [1.0, 0.0])])
    along = np.zeros((2, 8, 2))
    along[1, 4:] = 0.6, 0.8
    cells = np.arange(8).reshape(2, 4)
    times = np.array([0.0, 0.01])
    taken = snapshots(times, points, "quad", cells, [0, 1], 1e-4 * along, 2.0 * along)
    reasons = {"continuum-jointed": "it has not been asked"}
    scene = one_joint(domain={"size": [2.0, 1.0]}, joint_sets=[], record={"points": [[0.5, 0.5]]})
    return SceneSnapshots(load_tables(scene), {"dem": taken}, reasons, {})


def test_the_name_of_a_narrow_body_and_the_clock_stand_apart(squares, collisions):
    thin = squares.found["dem"]._replace(points=squares.found["dem"].points * [0.1, 5.0, 1.0])
    frame = Frame(squares._replace(found={"dem": thin}))
    frame.show(1)
    frame.clock.set_animated(False)
    assert not [pair for pair in collisions(frame.figure) if "t = " in pair]


def test_cells_are_displaced_and_coloured_by_their_speed(squares):
    """Displacements as they can be seen: 4 % of 2 m over 1e-4 m is 800; of 1, 2, 5 times a power of
    ten at most that is 500."""
    assert settings_for(squares.scene, squares.found).scale == 500
    frame = Frame(squares, 1000.0)
    frame.show(1)
    assert "t = 10 ms" in frame.clock.get_text()
    body = frame.bodies["dem"]
    np.testing.assert_allclose(body.values, [[0, 0], [0, 2.0]])
    corners = (body.rest + body.motion[1])[body.faces][..., [0, 2]]
    np.testing.assert_allclose(corners, [SQUARE, np.add(SQUARE, [1.06, 0.08])])
