"""The pictures: all that moves does, and the words are there."""

import numpy as np
import pytest
from matplotlib.text import Text

from jointwave.cases.material.calibrate import calibrate
from jointwave.compare.engines import label_of
from jointwave.compare.figures.animation.frame import Frame
from jointwave.compare.figures.animation.settings import settings_for
from jointwave.compare.figures.style import style


@pytest.fixture(scope="module")
def frame(simulated):
    taken = simulated()
    return Frame(taken, settings_for(taken.scene, taken.found))


def test_a_frame_differs_from_others_and_does_not_depend_on_them(frame):
    first = frame.image(20)
    assert first.shape == (720, 1280, 4)
    assert (frame.image(5) != first).any()
    np.testing.assert_array_equal(frame.image(20), first)


def test_blocks_of_both_engines_are_drawn_where_they_are_in_their_colours(frame):
    frame.show(20)
    assert list(frame.views) == ["dem", "continuum-jointed"]
    for name, view in frame.views.items():
        s = frame.simulated.found[name]
        colours = view.faces.to_rgba(view.faces.get_array())
        assert np.abs(colours[:, 0] - colours[:, 2]).max() > 0.2
        corners = frame.bodies[name].rest[frame.bodies[name].faces]
        assert len(view.faces.get_array()) == len(corners) / 2  # the others face away
        assert set(view.faces.get_array()) <= set(frame.bodies[name].values[20])
        places = np.concatenate([path.vertices for path in view.faces.get_paths()])
        moved = s.points[:, 1] + frame.settings.scale * s.displacement[20, :, 1]
        aside = 0.1 * 0.5 * frame.simulated.scene.pillar.side * frame.settings.stretch
        assert places[:, 0].min() == pytest.approx(moved.min() - aside, abs=1e-9)
        assert places[:, 0].max() == pytest.approx(moved.max() + aside, abs=1e-9)
        assert frame.profiles[name].get_color() == style(name).colour
        np.testing.assert_array_equal(frame.profiles[name].get_ydata(), frame.along[name].iloc[20])


@pytest.mark.parametrize("engine", ["dem", "continuum-jointed"])
def test_the_front_of_the_wave_is_where_it_should_be(frame, engine):
    """A tenth of the colours' range is at the far end when the sine gets there at the bar's speed,
    to a frame and what the wave takes through a block."""
    scene, along = frame.simulated.scene, frame.along[engine]
    level = 0.1 * frame.colours.get_clim()[1]  # MPa
    arrived = frame.time[np.argmax(along.iloc[:, -1].to_numpy() > level)]
    p, load = calibrate(scene), scene.load
    rise = np.arcsin(1e6 * level / load.amplitude) * load.period / (2 * np.pi)
    exact = along.columns[-1] / p.bar_speed + rise
    assert abs(arrived - exact) < frame.time[1] + p.spacing / p.bar_speed


def words(frame):
    return "\n".join(text.get_text() for text in frame.figure.findobj(Text))


def test_the_picture_says_when_how_much_and_who(frame):
    frame.show(20)
    said = words(frame)
    assert f"displacements × {frame.settings.scale:,g}" in said and "thickness × 2" not in said
    assert "axial stress (MPa), compression positive" in said and "t = 10.00 ms" in said
    assert all(label_of(name) in said for name in frame.bodies)


def test_nothing_lies_over_anything(frame, collisions):
    frame.show(20)
    assert collisions(frame.figure) == []


@pytest.mark.parametrize("title", ["A title of many words, " * 12, "w" * 200])
def test_a_title_of_any_length_is_whole(simulated, collisions, title):
    taken = simulated()
    scene = taken.scene.model_copy(update={"title": title.strip()})
    reasons = {"continuum-jointed": "it costs $1 or $2 " * 10}
    some = taken._replace(scene=scene, found={"dem": taken.found["dem"]}, reasons=reasons)
    frame = Frame(some, settings_for(taken.scene, some.found))
    frame.show(40)
    assert collisions(frame.figure) == [] and list(frame.views) == ["dem"]
    said = words(frame).replace("\n", "").replace(" ", "")
    assert title.replace(" ", "") in said and "itcosts$1or$2" in said


def test_a_receiver_is_drawn_sample_by_sample_up_to_the_frame(simulated):
    """Six frames miss the wave's peaks; the samples between them are drawn all the same."""
    taken = simulated(6)
    frame = Frame(taken, settings_for(taken.scene, taken.found))
    label = next(iter(frame.traces.values())).axes.get_ylabel()
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
    still = {n: s._replace(displacement=0 * s.displacement, stress=0 * s.stress)
             for n, s in taken.found.items()}  # fmt: skip
    frame = Frame(taken._replace(found=still), settings_for(taken.scene, still))
    assert frame.image(20).std() > 0
