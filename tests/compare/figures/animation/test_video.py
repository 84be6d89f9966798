"""The files as a player meets them: how many pictures, how large, how long."""

import subprocess

import numpy as np
import pytest
from imageio_ffmpeg import count_frames_and_secs, get_ffmpeg_exe, read_frames
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle
from PIL import Image

from jointwave.cases import SceneError
from jointwave.compare.figures.animation.video import refuse, write_video

COUNT, SECONDS, SIZE = 12, 1.5, (64, 48)


@pytest.fixture
def film():
    """A figure of a black bar over white, and what moves the bar."""
    figure = Figure(figsize=(SIZE[0] / 100, SIZE[1] / 100), dpi=100)
    FigureCanvasAgg(figure)
    bar = figure.add_artist(Rectangle((0.0, 0.0), 8 / SIZE[0], 1.0, color="black"))
    return figure, lambda i: bar.set_x(4 * i / SIZE[0])


def picture(i):
    """What the figure shows in frame i."""
    found = np.full((SIZE[1], SIZE[0], 3), 255)
    found[:, 4 * i : 4 * i + 8] = 0
    return found


def test_mp4_is_what_every_player_shows(film, tmp_path):
    path = write_video(tmp_path / "deep" / "bar.mp4", *film, COUNT, SECONDS)
    count, seconds = count_frames_and_secs(str(path))
    assert count == COUNT and seconds == pytest.approx(SECONDS, abs=0.01)
    frames = read_frames(str(path))
    about = next(frames)
    assert about["size"] == SIZE and about["codec"] == "h264" and "yuv420p" in about["pix_fmt"]
    assert about["fps"] == pytest.approx(COUNT / SECONDS)
    for i, data in enumerate(list(frames)):
        shown = np.frombuffer(data, dtype=np.uint8).reshape(SIZE[1], SIZE[0], 3)
        assert np.abs(shown.astype(int) - picture(i)).mean() < 8, i


def test_mp4_can_begin_before_it_is_whole(film, tmp_path):
    """Its index comes first: a page shows it while it loads."""
    path = write_video(tmp_path / "bar.mp4", *film, COUNT, SECONDS)
    assert 0 < path.read_bytes().index(b"moov") < path.read_bytes().index(b"mdat")


def test_gif_has_every_picture_and_the_whole_time(film, tmp_path):
    path = write_video(tmp_path / "bar.gif", *film, COUNT, 1.0)
    with Image.open(path) as file:
        assert file.n_frames == COUNT and file.size == SIZE and file.info["loop"] == 0
        lasted = []
        for i in range(COUNT):
            file.seek(i)
            lasted.append(file.info["duration"])
            shown = np.asarray(file.convert("RGB")).astype(int)
            assert np.abs(shown - picture(i)).mean() < 8, i
    assert sum(lasted) == 1000 and set(lasted) == {80, 90}  # ms; 12 do not divide a second


def test_progress_reaches_each_picture(film, tmp_path):
    seen = []
    write_video(tmp_path / "bar.gif", *film, COUNT, 1.0, seen.append)
    assert seen == [(i + 1) / COUNT for i in range(COUNT)]


@pytest.mark.parametrize("name", ["bar.avi", "bar", "bar.mp4.txt"])
def test_other_endings_are_refused(name, tmp_path):
    with pytest.raises(SceneError, match=r"--out.*must end in .mp4 or .gif"):
        refuse(tmp_path / name)


@pytest.mark.parametrize("ending", [".mp4", ".gif"])
def test_a_foreign_file_stays_and_an_older_animation_goes(film, ending, tmp_path):
    path = tmp_path / f"bar{ending}"
    write_video(path, *film, COUNT, SECONDS)
    write_video(path, *film, COUNT - 2, SECONDS)
    path.write_text("notes of mine")
    with pytest.raises(SceneError, match="is not a result"):
        write_video(path, *film, COUNT, SECONDS)
    assert path.read_text() == "notes of mine"


@pytest.mark.parametrize("ending", [".mp4", ".gif"])
def test_a_picture_that_fails_leaves_nothing(film, ending, tmp_path):
    def fails(i):
        if i == 5:
            raise OSError(28, "No space left on device")
        return film[1](i)

    with pytest.raises(OSError, match="No space"):
        write_video(tmp_path / f"bar{ending}", film[0], fails, COUNT, SECONDS)
    assert not list(tmp_path.iterdir())


def test_the_bundled_ffmpeg_runs():
    done = subprocess.run([get_ffmpeg_exe(), "-version"], capture_output=True, text=True)
    assert done.returncode == 0 and "libx264" in done.stdout
