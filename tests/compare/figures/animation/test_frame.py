"""The pictures: all that moves does, nothing is clipped, and the words are there."""

import numpy as np
import pytest

from cases.material.calibrate import calibrate
from compare.figures.animation.frame import Frame
from compare.figures.animation.view_settings import settings_for
from compare.figures.style import style


@pytest.fixture(scope="module")
def frame(simulated):
    taken = simulated()
    return Frame(taken, settings_for(taken.scene, taken.found), dots=50)


def test_every_frame_differs_from_the_one_before(frame):
    before = frame.image(0)
    assert before.shape == (360, 640, 4)
    for i in range(1, len(frame.time)):
        now = frame.image(i)
        assert (now != before).any(), i
        before = now


def test_a_frame_does_not_depend_on_those_before_it(frame):
    first = frame.image(20)
    frame.image(5)
    np.testing.assert_array_equal(frame.image(20), first)


def test_blocks_of_both_engines_are_drawn_in_the_colours_of_the_bar(frame):
    frame.image(20)
    assert list(frame.faces) == ["dem", "continuum-jointed"]
    for name, drawn in frame.faces.items():
        wave = frame.waves[name]
        _, faces, _ = wave.drawn(20)
        expected = frame.colour.to_rgba(1e-6 * wave.values[20, faces])
        np.testing.assert_array_equal(drawn.get_facecolor(), expected)
        assert np.abs(expected[:, 0] - expected[:, 2]).max() > 0.2
        assert frame.profiles[name].get_color() == style(name).colour
        np.testing.assert_array_equal(frame.profiles[name].get_ydata(), 1e-6 * wave.profile[20])


def redness(colours):
    """How much more red than blue a colour is; 0 where nothing is stressed."""
    return colours[..., 0] - colours[..., 2]


def test_far_end_takes_colour_when_the_wave_is_there(frame):
    """As soon as a tenth of the colours' range is to be seen there: the sine, at the bar's speed,
    through the middle of the last block; to a frame and what the wave takes through a block."""
    wave, scene = frame.waves["dem"], frame.simulated.scene
    last, reds = int(wave.y.argmax()), []
    for i in range(len(frame.time)):
        frame.image(i)
        _, faces, _ = wave.drawn(i)
        of_block = int(np.flatnonzero(wave.surface.cells[faces] == last)[0])
        reds.append(redness(frame.faces["dem"].get_facecolor()[of_block]))
    enough = redness(np.array(frame.colour.to_rgba(0.1 * frame.peak)))
    arrived = frame.time[np.argmax(np.array(reds) > enough)]
    p, load = calibrate(scene), scene.load
    rise = np.arcsin(0.1e6 * frame.peak / load.amplitude) * load.period / (2 * np.pi)
    exact = wave.y[last] / p.bar_speed + rise
    assert abs(arrived - exact) < frame.time[1] + p.spacing / p.bar_speed
    assert exact > 5 * frame.time[1] and max(reds[:5]) < 0.02


def test_the_picture_says_when_how_much_and_who(frame):
    frame.image(20)
    said = " ".join(t.get_text() for t in frame.figure.texts)
    assert f"displacements × {frame.settings.scale:,g}" in said and "thickness × 2" not in said
    assert "axial stress (MPa), compression positive" in said and "t = 10.00 ms" in said
    strips = [drawn.axes for drawn in frame.faces.values()]
    assert [ax.get_title(loc="left") for ax in strips] == list(frame.waves)


def test_nothing_is_clipped(frame, collisions):
    """Words lie inside the picture and beside each other, pillars inside their strips."""
    frame.image(20)
    for part in frame.animated:
        part.set_animated(False)
    assert collisions(frame.figure) == []
    for part in frame.animated:
        part.set_animated(True)
    for i in (0, 20, 40):
        frame.show(i)
        for name, drawn in frame.faces.items():
            ax = drawn.axes
            corners = np.concatenate([path.vertices for path in drawn.get_paths()])
            (left, right), (low, high) = ax.get_xlim(), ax.get_ylim()
            assert left < corners[:, 0].min() and corners[:, 0].max() < right, name
            assert low < corners[:, 1].min() and corners[:, 1].max() < high, name


@pytest.mark.parametrize("title", ["A title of many words, " * 12, "w" * 200])
def test_a_title_of_any_length_is_whole(simulated, collisions, title):
    taken = simulated()
    scene = taken.scene.model_copy(update={"title": title.strip()})
    reasons = {"continuum-jointed": "a reason of many words " * 10}
    some = taken._replace(scene=scene, found={"dem": taken.found["dem"]}, reasons=reasons)
    frame = Frame(some, settings_for(taken.scene, some.found), dots=50)
    frame.clock.set(text="t = 1000.00 ms", animated=False)
    assert collisions(frame.figure) == []
    said = "".join(t.get_text() for t in frame.figure.texts).replace("\n", "").replace(" ", "")
    assert title.replace(" ", "") in said


def test_a_receiver_is_drawn_sample_by_sample_up_to_the_frame(simulated):
    """Six frames miss the wave's peaks; the samples between them are drawn all the same."""
    taken = simulated(6)
    frame = Frame(taken, settings_for(taken.scene, taken.found), dots=50)
    label = next(iter(frame.traces.values())).axes.get_ylabel()
    size = {"stress\n(MPa)": 1e6, "stress\n(kPa)": 1e3}[label]
    for i in (0, 3, 5):
        frame.show(i)
        for name, result in taken.results.items():
            times, values = frame.traces[name].get_data()
            recorded = result.stress.values[0, result.time.values <= frame.time[i] + 1e-9] / size
            np.testing.assert_allclose(values, recorded)
            assert times[-1] == pytest.approx(1e3 * frame.time[i])
    result = taken.results["dem"]
    at_frames = result.stress.sel(time=frame.time, method="nearest").values[0] / size
    assert np.abs(frame.traces["dem"].get_ydata()).max() > 1.02 * np.abs(at_frames).max()


def test_an_engine_that_does_not_apply_is_named_with_the_reason(simulated):
    taken = simulated()
    one = taken._replace(
        found={"dem": taken.found["dem"]}, reasons={"continuum-jointed": "it costs $1 or $2"}
    )
    frame = Frame(one, settings_for(one.scene, one.found), dots=50)
    said = [t.get_text() for t in frame.figure.texts]
    assert "continuum-jointed does not apply: it costs $1 or $2" in said
    assert len(frame.faces) == 1 and frame.image(3).std() > 0


def test_a_pillar_at_rest_is_drawn(simulated):
    taken = simulated()
    still = {n: s._replace(displacement=0 * s.displacement, stress=0 * s.stress)
             for n, s in taken.found.items()}  # fmt: skip
    frame = Frame(taken._replace(found=still), settings_for(taken.scene, still), dots=50)
    assert frame.image(20).std() > 0
