"""`jointwave animate` and `jointwave view` as a user meets them."""

import re
import subprocess
import sys

import pytest
from imageio_ffmpeg import count_frames_and_secs
from PIL import Image

from jointwave.compare.scenes import SHIPPED

SCENE = "guo-li-2002/fig-03"
SHORT = ("--set", "time.duration=0.01", "--set", "pillar.length=10", "--set", "record.stress=[5]")


@pytest.fixture(autouse=True)
def headless(monkeypatch, tmp_path):
    """No display, and a folder of its own."""
    for name in ("DISPLAY", "WAYLAND_DISPLAY"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.chdir(tmp_path)


def test_animate_writes_an_animation_of_both_engines(jointwave, tmp_path):
    film = tmp_path / "wave.mp4"
    options = ("--frames", 12, "--seconds", 1.5, "--out", film)
    said = jointwave("animate", SCENE, *SHORT, *options).out
    assert said.startswith(f"{film}: rigid blocks and jointed rock, displacements × ")
    assert count_frames_and_secs(film) == (12, 1.5)


def test_animate_names_the_file_by_scene_and_variant(jointwave, tmp_path):
    options = ("--variant", "zeta 0.02", "--frames", 3, "--scale", 500)
    done = jointwave("animate", SCENE, *SHORT, *options)
    assert [p.name for p in tmp_path.iterdir()] == ["fig-03-zeta-0.02.mp4"]
    assert done.out == "fig-03-zeta-0.02.mp4: rigid blocks and jointed rock, displacements × 500\n"


def test_animate_shows_one_engine_where_the_other_does_not_apply(jointwave, tmp_path):
    """Joints without tension: no intact rock is given, and a homogenised bar has no joints."""
    text = (SHIPPED / "guo-li-2002" / "fig-09.toml").read_text()
    (tmp_path / "own.toml").write_text(re.sub("(?m)^intact_.*", "", text))
    options = ("--variant", "no tension", "--frames", 3, "--out", "wave.gif")
    said = jointwave("animate", "own.toml", *SHORT, *options).out
    assert "jointed rock is not shown: the jointed rock needs" in said
    with Image.open("wave.gif") as file:
        assert file.n_frames == 3 and file.size == (1280, 720)


BAD = [
    (("animate", SCENE, "--out", "wave.avi"), "--out: wave.avi: must end in .mp4 or .gif"),
    (("animate", SCENE, "--scale", "0"), "--scale: must be a positive number, not 0"),
    (("animate", SCENE, "--scale", "nan"), "--scale: must be a positive number, not nan"),
    (("animate", SCENE, "--seconds", "-1"), "--seconds: must be a positive number, not -1"),
    (("animate", SCENE, "--frames", "1"), "'--frames'"),
    (("animate", "no-such-scene"), "is neither a file nor a shipped scene"),
    (("animate", SCENE, "--variant", "none"), "variants.name"),
    (("view", SCENE, "--out", "wave.jpg"), "--out: wave.jpg: must end in .png"),
    (("view", SCENE, "--map", "slip"), "--map: must be one of stress, speed, across, not slip"),
    (("animate", "rock-mass/tunnel", "--map", "across"), "must be one of speed, stress, not"),
    (("view", SCENE, "--time", "0"), "--time: must be greater than 0 and at most"),
    (("view", SCENE, "--time", "9"), "time.duration = 0.12 s, not 9"),
    (("view", SCENE, "--time", "nan"), "--time: must be greater than 0 and at most"),
]


@pytest.mark.parametrize(("arguments", "message"), BAD, ids=[" ".join(a[1:]) for a, _ in BAD])
def test_a_mistake_is_one_line_before_anything_is_run(jointwave, arguments, message, tmp_path):
    done = jointwave(*arguments, code=2)
    assert message in done.err and done.err.count("\n") == 1 and not done.out
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(("command", "name"), [("animate", "wave.mp4"), ("view", "wave.png")])
def test_a_foreign_file_is_not_replaced(jointwave, command, name, tmp_path):
    (tmp_path / name).write_text("notes")
    done = jointwave(command, SCENE, *SHORT, "--out", tmp_path / name, code=2)
    assert "is not a result and would be overwritten" in done.err
    assert (tmp_path / name).read_text() == "notes"


def test_view_without_a_display_writes_a_picture(jointwave, tmp_path):
    done = jointwave("view", SCENE, *SHORT, "--time", "0.008")
    assert done.err == ""
    assert done.out.startswith("fig-03.png: rigid blocks and jointed rock, displacements × ")
    with Image.open(tmp_path / "fig-03.png") as file:
        assert file.size == (1280, 720) and len(file.getcolors(1_000_000)) > 100


def test_view_of_a_rock_mass_shows_its_speed(jointwave, tmp_path):
    short = ("--variant", "", "--set", "time.duration=0.01", "--out", "mass.png")
    assert "mass.png: rigid blocks" in jointwave("view", "rock-mass/one-joint", *short).out
    with Image.open(tmp_path / "mass.png") as file:
        assert file.size == (1280, 720) and len(file.getcolors(1_000_000)) > 100


def test_view_shows_the_quantity_that_is_asked_for(jointwave, tmp_path):
    """Of the results that the first picture has left."""
    for quantity in ("stress", "speed"):
        shown = ("--map", quantity, "--out", f"{quantity}.png")
        said = jointwave("view", SCENE, *SHORT, *shown)
        assert said.out.startswith(f"{quantity}.png: rigid blocks and jointed rock")
    first, other = (Image.open(tmp_path / f"{name}.png") for name in ("stress", "speed"))
    assert first.getcolors(1_000_000) != other.getcolors(1_000_000)


def test_help_draws_nothing():
    """Neither figures nor engines are imported for a command's help."""
    script = (
        "import sys; sys.argv = ['jointwave', 'animate', '--help']\n"
        "from jointwave.compare.cli.program import main\n"
        "try:\n    main()\nexcept SystemExit:\n    pass\n"
        "heavy = {'matplotlib', 'pyvista', 'imageio_ffmpeg', 'PIL', 'xarray', 'dolfinx', 'numba'}\n"
        "print('heavy:', sorted(heavy & set(sys.modules)))"
    )
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True)
    assert done.stdout.endswith("heavy: []\n") and "--frames" in done.stdout
