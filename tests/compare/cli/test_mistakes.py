"""What is wrong with a command is one line, before anything is run or written."""

import re
from pathlib import Path

import pytest

from jointwave.compare.cli.scene_files import starter

SCENE = "guo-li-2002/fig-03"
SHORT = ("--set", "time.duration=0.02")
NO_TENSION = ("--engine", "exact", "--model", "no-tension-chain")
TOO_LATE = "--time: must be greater than 0 and at most time.duration = 0.12 s, not"
OF_SPACE = "jointwave: --explode: is of a scene in space, not of"

BAD = [
    (("my-scene.toml", "--all"), "a command comes first, such as jointwave compare my-scene.toml;"),
    ((SCENE,), f"a command comes first, such as jointwave compare {SCENE};"),
    (("",), "No such command ''"),
    (("run",), "Missing argument"),
    (("run", "nothing.toml"), "nothing.toml: cannot be read: No such file"),
    (("run", SCENE, "--variant", "none"), "variants.name"),
    (("run", SCENE, "--engine", "fem"), "fem"),
    (("run", SCENE, "--model", "jointed"), "--model: jointed: needs --engine continuum\n"),
    (("run", SCENE, "--model", "joints"), "--model: joints: must be one of jointed, equivalent, "),
    (("run", SCENE, *NO_TENSION), "tension"),
    (("run", SCENE, *SHORT, "--out", "taken.pdf"), "taken.pdf: is a file, must be a folder"),
    (("compare", SCENE, "--out", "taken.pdf"), "taken.pdf: is a file, must be a folder"),
    (("explain", SCENE, "--bogus"), "--bogus"),
    (("animate", SCENE, "--out", "wave.avi"), "--out: wave.avi: must end in .mp4 or .gif"),
    (("animate", SCENE, "--out", "taken.mp4"), "is not a result and would be overwritten"),
    (("animate", SCENE, "--scale", "nan"), "--scale: must be a positive number, not nan"),
    (("animate", SCENE, "--frames", "1"), "'--frames'"),
    (("animate", "no-such-scene"), "is neither a file nor a shipped scene"),
    (("animate", "rock-mass/tunnel", "--map", "across"), "must be one of speed, stress, not"),
    (("view", SCENE, "--out", "wave.jpg"), "--out: wave.jpg: must end in .png"),
    (("view", SCENE, "--out", "taken.png"), "is not a result and would be overwritten"),
    (("view", SCENE, "--map", "slip"), "--map: must be one of stress, speed, across, not slip"),
    (("view", SCENE, "--time", "9"), f"{TOO_LATE} 9"),
    (("view", SCENE, "--time", "nan"), f"{TOO_LATE} nan"),
    (("figure", SCENE, "--out", "figure.doc"), "must end in .pdf or .svg or .png"),
    (("figure", SCENE, "--out", "figure.pdf", "--width", "3"), "width"),
    (("figure", SCENE, "--out", "taken.pdf", "--engine", "dem"), "would be overwritten"),
    (("figure", SCENE, "--out", "a.pdf", "--font-size", "40"), "--width: 90: must be at least 200"),
    (("animate", SCENE, "--out", "/proc/no/a.gif"), "/proc/no/a.gif: cannot be written: "),
    (("picture", SCENE, "--map", "ppv"), f"--map: is of results: `jointwave run {SCENE} --set"),
    (("picture", SCENE, "--out", "a.gif"), "--out: a.gif: must end in .pdf or .svg or .png"),
    (("explain", "xyz", "--json"), "xyz: is neither a file nor a shipped scene"),
    (("picture", "xyz"), "xyz: is neither a file nor a shipped scene"),
    (("plan", SCENE, "--misfit", "2"), "plan: misfit = 2.0: must be a positive number of at m"),
    (("picture", "."), ".: has no result of an engine, such as dem.nc"),
    (("picture", "rock-mass/tunnel", "--explode", "0.2"), f"{OF_SPACE} rock-mass/tunnel\n"),
    (("picture", ".", "--explode", "0.2"), f"{OF_SPACE} a folder\n"),
    (("compare", SCENE, "--read", "--sweep", "load.period=1,2"), "--read: is not of a sweep: --o"),
    (("compare", SCENE, "--align"), "--align: needs --with"),
    (("new", "x", "--from", "nothing"), "is neither a file nor a shipped scene"),
]


@pytest.mark.parametrize(("arguments", "message"), BAD, ids=[" ".join(a) for a, _ in BAD])
def test_a_mistake_is_one_line_and_exit_2(jointwave, arguments, message):
    """A file of one's own is not replaced."""
    own = [Path(f"taken.{kind}") for kind in ("mp4", "pdf", "png")]
    for file in own:
        file.write_text("mine")
    done = jointwave(*arguments, code=2)
    assert message in done.err and done.err.count("\n") == 1 and not done.out
    assert set(Path().iterdir()) == set(own)
    assert [file.read_text() for file in own] == 3 * ["mine"]


def test_a_message_about_a_long_argument_is_short(jointwave):
    done = jointwave("run" + "x" * 50_000, SCENE, code=2)
    assert done.err.startswith("jointwave: No such command 'runxxx")
    assert done.err.count("\n") == 1 and len(done.err) < 1600 and " ... " in done.err


@pytest.mark.parametrize(
    ("typed", "meant"),
    [
        (("explain", "fig-3"), "guo-li-2002/fig-03"),
        (("explain", "gou-li/fig-10"), "guo-li-2002/fig-10"),
        (("explain", "beyond/spal.toml"), "beyond/spall"),
        (("explain", "pilar-of-mine.toml"), "pillar-of-mine.toml"),  # a file of the folder
        (("new", "a", "--from", "spall"), "beyond/spall"),
        (("explain", SCENE, "--set", "pillar.lenght=1"), "length"),
        (("explain", SCENE, "--set", "pilar.length=1"), "pillar"),
        (("explain", SCENE, "--variant", "zeta 0.2"), "zeta 0.02"),
        (("study", "dimension"), "dimensions"),
        (("run", SCENE, "--engine", "exact", "--model", "latice"), "lattice"),
        (("explain", SCENE, "--set", "expect.dem ~ latice=1"), "lattice"),
        (("explain", SCENE, "--set", "expect.dem ~ lattice: PVP=1"), "PPV"),
    ],
)
def test_a_name_that_is_unknown_is_told_the_nearest(jointwave, typed, meant):
    Path("pillar-of-mine.toml").touch()
    assert jointwave(*typed, code=2).err.endswith(f"; did you mean {meant}?\n")


SLIPS = ("--set", "load.period=0.001", "--set", "rock.density=2.4")
STRICT = {
    "run": (),
    "explain": (),
    "compare": (),
    "figure": ("--out", "a.pdf"),
    "effects": (),
    "plan": ("--misfit", "0.1"),
    "animate": (),
    "fit": ("--with", "a.csv", "--free", "load.amplitude"),
    "picture": ("--out", "a.png"),
    "view": ("--out", "a.png"),
}


@pytest.mark.parametrize("command", STRICT)
def test_strict_refuses_what_is_warned_of(jointwave, command):
    said = jointwave(command, SCENE, *STRICT[command], *SLIPS, "--strict", code=2)
    first, second = said.err.splitlines()
    assert re.search(r"fig-03.toml: rock.density = 2.4 .*\(an error by --strict\)", first)
    assert "fig-03.toml: pillar.block" in second and "(an error by --strict)" in second
    assert said.out == "" and not list(Path().iterdir())


def test_strict_refuses_a_sweep_and_a_page(jointwave):
    """The page takes only files."""
    Path("new.toml").write_text(starter("new.toml").replace("2400.0", "2.4"))
    for options in (("run", SCENE, "--sweep", "load.period=0.01,0.001"), ("report", "new.toml")):
        assert "--strict" in jointwave(*options, "--strict", "--out", "out", code=2).err
        assert not Path("out").exists()
