"""The files as a player meets them: how many pictures, how large, how long."""

import numpy as np
import pytest
from imageio_ffmpeg import count_frames_and_secs, read_frames
from PIL import Image

from jointwave.cases.errors import SceneError
from jointwave.compare.figures.animation.video import write_video

COUNT, SECONDS, SIZE = 12, 1.5, (64, 48)


def picture(i):
    """A black bar over white."""
    found = np.full((SIZE[1], SIZE[0], 4), 255, dtype=np.uint8)
    found[:, 4 * i : 4 * i + 8, :3] = 0
    return found


def write(path, count=COUNT, seconds=SECONDS):
    return write_video(path, map(picture, range(count)), SIZE, count / seconds)


def off(shown, i):
    """Return how far a picture is from the i-th, of 255."""
    return np.abs(shown.astype(int) - picture(i)[..., :3]).mean()


def test_mp4_is_what_every_player_shows(tmp_path):
    """Its index comes first: a page shows it while it loads."""
    path = write(tmp_path / "deep" / "bar.mp4")
    assert count_frames_and_secs(str(path)) == (COUNT, pytest.approx(SECONDS, abs=0.01))
    about, *frames = read_frames(str(path))
    assert about["size"] == SIZE and about["codec"] == "h264" and "yuv420p" in about["pix_fmt"]
    assert about["fps"] == pytest.approx(COUNT / SECONDS)
    for i, data in enumerate(frames):
        assert off(np.frombuffer(data, dtype=np.uint8).reshape(SIZE[1], SIZE[0], 3), i) < 8
    assert 0 < path.read_bytes().index(b"moov") < path.read_bytes().index(b"mdat")


def test_gif_has_every_picture_and_the_whole_time(tmp_path):
    """In place of an older one."""
    path = tmp_path / "bar.gif"
    write(path, COUNT - 2)
    write(path, seconds=1.0)
    with Image.open(path) as file:
        assert file.n_frames == COUNT and file.size == SIZE and file.info["loop"] == 0
        lasted = []
        for i in range(COUNT):
            file.seek(i)
            lasted.append(file.info["duration"])
            assert off(np.asarray(file.convert("RGB")), i) < 8
    assert sum(lasted) == 1000 and set(lasted) == {80, 90}  # ms; 12 do not divide a second


@pytest.mark.parametrize(("ending", "most"), [(".mp4", 1000), (".gif", 100)])
def test_more_frames_a_second_than_a_file_holds_are_refused(ending, most, tmp_path):
    with pytest.raises(SceneError, match=rf"1200 frames a second, at most {most}: --frames, --sec"):
        write(tmp_path / f"bar{ending}", seconds=0.01)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("ending", [".mp4", ".gif"])
def test_a_picture_that_fails_leaves_nothing(ending, tmp_path):
    def images():
        yield picture(0)
        raise OSError(28, "No space left on device")

    with pytest.raises(OSError, match="No space"):
        write_video(tmp_path / f"bar{ending}", images(), SIZE, 8.0)
    assert not list(tmp_path.iterdir())


def test_a_failure_of_ffmpeg_is_one_line_and_leaves_nothing(tmp_path):
    """H.264 in 4:2:0 has no odd sizes."""
    odd = np.full((3, 5, 4), 255, dtype=np.uint8)
    with pytest.raises(OSError, match="ffmpeg ended with code") as caught:
        write_video(tmp_path / "bar.mp4", [odd], (5, 3), 8.0)
    assert "\n" not in str(caught.value) and not list(tmp_path.iterdir())
