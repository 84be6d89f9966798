"""Every mistake in a scene is one line that names file, key, value and what is allowed."""

import os
from pathlib import Path

import pytest

from jointwave.cases import load

GOOD = """\
title = "good"
[pillar]
length = 50.0
side = 0.5
block = 0.5
[rock]
density = 2400.0
p_speed = 2200.0
s_speed = 800.0
intact_modulus = 8.64e10
[joints]
damping_ratio = 0.02
[[soft_layers]]
y = 20.0
spacing_stiffness = 4.375e8
[load]
shape = "sine"
amplitude = 1.0e6
period = 0.01
[ends]
end = "quiet"
[time]
duration = 0.002
[record]
stress = [20.0]
velocity = [19.75, 20.25]
[expect]
"dem ~ lattice" = 2e-3
[[variants]]
name = "undamped"
"""

REQUIRED = "is required"
STRONG = "joints.tensile_strength = 100000.0"
SHAPED = "no load.period; load.amplitude = 1.0"
WEAK = "joints.weakening_distance = 0.001"
RATE = (
    "joints.direct_effect = 0.01; joints.evolution_effect = 0.015; "
    "joints.critical_slip_distance = 0.0001; joints.reference_rate = 1e-06"
)
SLIPS = "joints.friction_angle = 30.0"
DILATES = "joints.dilation_distance = 0.001"
RAYLEIGH = "damping.rayleigh.frequencies = [10.0, 20.0]; damping.rayleigh.ratios = [0.02, 0.02]"
SEGMENT = "segments = [{ y = [10.0, 30.0] }]"
MESH = "numerics.continuum.mesh = 'pillar.msh'"
THICK = "soft_layers[0].thickness = 0.1"

#: What is changed first, and then by one mistake each; the words that its line must hold behind the
#: key and its value as they are changed last, or behind those that follow an arrow.
MISTAKES = {
    "": {
        # types
        "pillar.length = '50'": "a number",
        "rock.density = 2400-01-01": "a number",
        "title = 3": "must be a string",
        "gravity = 'down'": "must be a table",
        "record.stress = 20.0": "a list",
        "record.stress = ['20'] -> record.stress[0] = '20'": "a number",
        "no joints.damping_ratio; joints.tension = 0": "or false",
        "load.cycles = 1.5": "a whole number",
        "soft_layers = { y = 20.0 } -> soft_layers": "[[soft_layers]]",
        # unknown and missing keys
        "loads = {} -> loads": "unknown key ... load, ends",
        "rock.speed = 1": "p_speed, s_speed",
        "soft_layers[0].K = 1": "thickness",
        "numerics.dem.dt = 1": "step_fraction",
        "name = 'x'": "[[variants]]",
        "no pillar.length": REQUIRED,
        "no record.stress; no record.velocity -> record": "at least one of record.stress",
        # numbers: the bounds of each key stand in the reference
        "pillar.side = nan": "finite",
        "rock.density = 0.0": "greater than 0",
        "joints.damping_ratio = -0.02": "at least 0",
        "pillar.side = 1e+200": "1e30",
        "numerics.continuum.order = 9": "at most 4",
        "damping.local = 1.0": "less than 1",
        # the pillar and what lies on it
        "pillar.block = 0.3": "whole number",
        "pillar.block = 60.0": "2 to",
        "pillar.block = 5e-11": "10,000,000 blocks",
        "soft_layers[0].y = 20.1": "multiple of 0.5",
        "soft_layers[0].y = 50.0": "from 0.5 to 49.5",
        "soft_layers[1] = { y = 20.0, spacing_stiffness = 4e8 } -> soft_layers[1].y": "already",
        "soft_layers[0].normal_stiffness = 1e9 -> soft_layers[0].spacing_stiffness": "not both",
        "record.stress = [20.0, 50.1] -> record.stress = 50.1": "0 and 50 m",
        "record.stress = [-1.0] -> record.stress[0] = -1.0": "at least 0",
        "record.stress = [20.0, 20.0]": "repeat",
        "record.interval = 1.0": "time.duration = 0.002",
        "record.interval = 1e-12": "10,000,000 samples",
        # the rock
        "rock.equivalent_modulus = 4e9; rock.equivalent_poisson = 0.4 -> rock = [": "one pair",
        "no rock.s_speed -> rock = ['p_speed']": "exactly one pair",
        "no rock.p_speed; no rock.s_speed -> rock": "exactly one pair",
        "rock.p_speed = 900.0": "sqrt(4/3)",
        "rock.intact_modulus = 4000000000.0": "4.374e+09",
        # the load
        "load.shape = 'square'": "'ricker', 'gabor'",
        "no load.period": "load.shape = 'sine'",
        "load.shape = 'step' -> load.period = 0.01": "no meaning",
        "load.shape = 'gabor'; load.amplitude = 1.0 -> load.cycles": REQUIRED,
        "load.amplitude = 1.1e+30": "between 1e-30 and 1e30",
        "load.rise = 0.1": "has no meaning for shape 'sine'",
        "load.direction = [0, 0, 0]": "unit vector",
        "load.direction = [0, 1]": "3 numbers",
        "load.at = [0.0, 0.3]": "on the face, within 0.25 m",
        "load.at = [0.1, 0.0]; load.arm = 0.2": "takes no load.at",
        "motion.rotation = 'none'; load.at = [0.1, 0.0]": "motion.rotation = 'none'",
        "ends.start = 'fixed'": "'velocity' or 'acceleration'",
        "load.quantity = 'velocity'": "ends.start = 'fixed'",
        "ends.start = 'quiet'; load.quantity = 'velocity'; load.direction = [0.6, 0.8, 0.0]": (
            "along or across the axis"
        ),
        "load.quantity = 'velocity'; load.at = [0.1, 0.0]": "for load.quantity 'velocity'",
        # all joints alike
        "soft_layers[0].contact_points = 3": "applies to all joints",
        "joints.contact_points = 3": "needs point_rule = 'midpoint' or 'gauss'",
        # gravity
        "gravity.direction = [0, -1, 0] -> gravity.static = true": "needs a fixed end ... or",
        "gravity.direction = [0, -1, 0]; gravity.static = false -> ends.end = 'quiet'": (
            "pulls the pillar off it ... needs a fixed"
        ),
        # scatter
        "scatter.seed = 1 -> scatter": "give scatter.spacing",
        "scatter.spacing = 0.2 -> scatter.seed": REQUIRED,
        "scatter.seed = 1; scatter.compliance = 0.6": "at most 0.5",
        # variants and expectations
        "variants = { zeta = 1 } -> variants": "[[variants]]",
        "no variants[0].name": "must be a string",
        "variants[0].name = '../x'": "/",
        "variants[0].name = 'a'; variants[1] = { name = 'a' } -> variants[1].name = 'a'": "unique",
        "variants[0].joints.zeta = 1 -> joints.zeta = 1": "damping_ratio",
        "variants[0].joints.damping_ratio = 'none' -> joints.damping_ratio = 'none'": "a number",
        "expect.dem ~ truth = 0.002 -> expect.dem ~ truth": "'a ~ b' ... jointed-bar",
        "expect.dem ~ dem = 0.002 -> expect.dem ~ dem": "'a ~ b'",
        # the elements
        "numerics.continuum.cell = 'simplex'; numerics.continuum.order = 3": "1 or 2 ... 'simplex'",
        "numerics.continuum.mesh = 'gone.msh'": "No such file",
        "numerics.continuum.mesh = ''": "must be a file",
        "numerics.continuum.mesh = 'pipe'": "regular file",
        "soft_layers[0].thickness = 0.5": "less than pillar.block = 0.5",
        "no soft_layers[0].spacing_stiffness; soft_layers[0].thickness = 0.1": "needs a spacing",
    },
    SHAPED: {
        "load.shape = 'ricker' -> load.period": "is required for load.shape = 'ricker'",
        "load.shape = 'triangle'; load.rise = 0.01 -> load.decay": REQUIRED,
        "load.shape = 'table' -> load.file": REQUIRED,
        "load.shape = 'table'; load.file = 'gone.csv'": "No such file",
    },
    # the strength of joints
    STRONG: {
        "joints.cohesion = 1e4 -> joints.fracture_energy": "is required with joints.tensile",
        "joints.fracture_energy = 1.0; joints.tension = false": "contradicts tensile_strength",
        "joints.fracture_energy = 1.0; prestress.normal = -200000.0": (
            "is a tension of which joints as in joints carry at most 100000 Pa"
        ),
        "joints.fracture_energy = 0.5": "snaps back ... at least 0.5716 J/m2",
        "joints.fracture_energy = 1.0 -> soft_layers[0].fracture_energy = 1.0": (
            "snaps back ... at least 5.744 J/m2"
        ),
    },
    "no joints.damping_ratio": {
        "soft_layers[0].fracture_energy = 10.0 -> soft_layers[0].tensile_strength": REQUIRED,
        "joints.residual_cohesion = 10000.0": "needs a cohesion",
        "joints.cohesion = 1e4; joints.residual_cohesion = 20000.0": "at most the cohesion 10000",
        "joints.cohesion = 1e4; soft_layers[0].residual_cohesion = 20000.0": "at most the cohesion",
        "joints.friction_angle = 90.0": "less than 90",
    },
    WEAK: {
        f"{SLIPS} -> joints.dynamic_friction_angle": REQUIRED,
        "joints.dynamic_friction_angle = 20.0": "needs a friction_angle",
        f"{SLIPS}; joints.dynamic_friction_angle = 40.0": "at most friction_angle = 30",
    },
    RATE: {
        "joints.cohesion = 1e4 -> joints.direct_effect = 0.01": "needs a friction_angle",
        f"{SLIPS}; {WEAK}; joints.dynamic_friction_angle = 20.0 -> joints.dynamic_friction_angle": (
            "contradicts direct_effect"
        ),
        f"{SLIPS}; {DILATES}; joints.dilation_angle = 5.0 -> joints.dilation_angle": (
            "contradicts direct_effect"
        ),
    },
    SLIPS: {
        "joints.initial_state = 1.0 -> joints.direct_effect": "is required with joints.initial",
        "joints.direct_effect = 0.01 -> joints.evolution_effect": REQUIRED,
    },
    DILATES: {
        "joints.dilation_angle = 5.0 -> joints.dilation_angle = 5": "needs a friction_angle",
        f"{SLIPS}; joints.dilation_angle = 31.0 -> joints.dilation_angle": "at most friction_angle",
        f"{SLIPS}; joints.dynamic_friction_angle = 10.0; {WEAK}; joints.dilation_distance = 1.0; "
        "joints.dilation_angle = 15.0 -> joints.dilation_angle = 15": (
            "must be at most 10.01 ... friction at dynamic_friction_angle = 10"
        ),
    },
    RAYLEIGH: {
        "joints.damping_ratio = 0.02": "damping.rayleigh already sets ... give one",
        "no joints.damping_ratio; soft_layers[0].damping_ratio = 0.1": "already sets ... give one",
        "no joints.damping_ratio; joints.viscosity = 1e6 -> joints.viscosity": "of single joints",
        "damping.mass_proportional = 3.0": "damping.rayleigh already sets ... give one",
        "damping.rayleigh.ratios = [0.01, 0.1]": "alpha = -6.702 1/s ... beta = 0.002016 s",
        "damping.rayleigh.frequencies = [20.0, 20.0]": "increasing",
    },
    # segments
    SEGMENT: {
        "segments[1] = {} -> segments[1].y": REQUIRED,
        "segments[1] = { y = [40.0, 35.0] } -> segments[1].y = [40.0, 35.0]": "increasing",
        "segments[1] = { y = [40.0, 51.0] } -> segments[1].y": "within pillar.length = 50",
        "segments[1] = { y = [29.5, 40.0] } -> segments[1].y": "ends at 30 m ... overlaps",
        "segments[1] = { y = [30.0, 40.2] } -> segments[1].y": "0.5 m must divide ... 30 to 40.2 m",
        "segments[0].block = 1e-09": "at most 10,000,000 blocks",
        "segments[0].block = 0.3": "10 to 30 m",
        "segments[0].modulus = 1e9 -> segments[0].modulus": "intact_modulus",
        "segments[0].p_speed = 3000.0": "one pair or none",
        "segments[0].s_speed = 800.0; segments[0].p_speed = 900.0": "sqrt(4/3) times s_speed = 800",
        "segments[0].intact_modulus = 1000000000.0": "exceed the equivalent modulus ... joints",
        "segments[0].joints = false; segments[0].normal_stiffness = 1000000000.0": (
            "segments[0].joints = false give intact_modulus"
        ),
        "gravity.direction = [0, 1, 0]; gravity.static = false -> gravity.acceleration = 9.81": (
            "is not supported with segments or scatter"
        ),
        "load.direction = [1, 0, 0] -> segments = 1": "axial motion only ... a component across",
        "motion.rotation = 'none'": "segments",
        "numerics.dem.scheme = 'fourth-order'": "'leapfrog'",
        "no joints.damping_ratio; no soft_layers[0].spacing_stiffness; segments[0].joints = false "
        "-> soft_layers[0].y = 20.0": "needs a normal_stiffness",
        THICK: "must be a segment",
        "soft_layers[0].y = 20.25": "must be on a joint",
    },
    MESH: {
        "numerics.continuum.dim = 1": "is a bar",
        "numerics.continuum.cell = 'simplex'": "no meaning with numerics.continuum.mesh",
        "numerics.continuum.elements_per_block = 2": "no meaning",
        THICK: "cannot be meshed with numerics",
    },
    THICK: {
        "soft_layers[0].friction_angle = 30.0": "a layer with thickness is rock",
        "soft_layers[0].tension = false": "a layer with thickness is rock",
        "soft_layers[0].fracture_energy = 100.0; soft_layers[0].tensile_strength = 100000.0": (
            "a layer with thickness is rock"
        ),
    },
}
EACH = [(first, one, words) for first, each in MISTAKES.items() for one, words in each.items()]

#: The same of the text of a file: (what is replaced, by what, words).
IN_TEXT = {
    "an integer of 400 digits": ("side = 0.5", "side = 1" + "0" * 400, "pillar.side ... bits"),
    "not TOML": ("[pillar]", "[pillar", "not valid TOML ... line 2"),
    "the same key twice": ("side = 0.5", "side = 0.5\nside = 0.5", "not valid TOML ... line 5"),
    "an integer of 5000 digits": ("side = 0.5", "side = 1" + "0" * 5000, "not valid TOML"),
    "a key of many parts": ("side = 0.5", "a." * 40_000 + "b = 1", "a key has more than 64 parts"),
    "a quoted key of many parts": ("side = 0.5", '"a" . ' * 70 + "b = 1", "more than 64 parts"),
    "nested too deep": ("side = 0.5", "side = " + "[" * 5000 + "]" * 5000, "not valid TOML"),
    "too many variants": (
        '[[variants]]\nname = "undamped"\n',
        "".join(f'[[variants]]\nname = "{i}"\n' for i in range(1002)),
        "variants: 1,002 variants given; at most 1,000",
    ),
}

#: Beside those of `field_cases/test_records.py`, which a load and a curve have in common.
HISTORIES = {
    "empty history": ("", "two or more numbers"),
    "three columns": ("0,0,0\n1,1,1\n", "two columns ... not 3"),
    "an empty cell": ("0;0\n1;\n2;1\n", "line 2: value = nan or empty ... finite number"),
    "binary history": (b"\x93NUMPY\xff\x00", "neither text (line 1 ... nor a seismogram in SAC"),
    "history in Latin-1": ("Zeit (\xb5s),p\n0,0\n1,1\n".encode("latin-1"), "not UTF-8 text"),
}

OVERRIDES = {
    "pillar.width=1": "pillar.width = 1 ... length, side, block",
    "pillar.side=wide": "pillar.side = 'wide' ... a number",
    "pillar.side.half=1": "pillar.side.half = 1 ... not a table",
    "pillar.side": "pillar.side ... must be key=value",
    "=1": "=1 ... must be key=value",
    "pillar.side=" + "[" * 5000: "pillar.side = '[[[ ... a number",
    "numerics.dem.step_fraction=1.5": "step_fraction = 1.5 ... critical step ... allow_unstable",
    "numerics.dem.step_fraction=1e-15": "step_fraction = 1e-15 ... steps of ... at most 1e+12",
}


def write(path: Path, content: str | bytes) -> Path:
    """Write a text or bytes and return the path."""
    path.write_bytes(content.encode() if isinstance(content, str) else content)
    return path


@pytest.fixture
def line_of(jointwave):
    """Return a function of a scene that returns the first line of what `jointwave run` says of it
    behind its file: exit 2, every line names the file and stands there once, no output."""

    def line(path):
        said = jointwave("run", path, "--out", out := path.parent / "out", code=2)
        lines = said.err.splitlines()
        assert said.out == "" and not out.exists() and len({*lines}) == len(lines)
        assert all(one.startswith(f"jointwave: {path}") for one in lines)
        assert len(lines[0]) < len(str(path)) + 500
        return lines[0].removeprefix(f"jointwave: {path}")

    return line


def assert_words(words, line):
    for word in words.split(" ... "):
        assert word in line


def test_the_good_scene_is_good(tmp_path):
    """Dots in a text or a list make no key of many parts; its mesh would be none."""
    places = ", ".join(f"{0.5 * i}" for i in range(1, 100))
    text = GOOD.replace('title = "good"', f'title = "{"..." * 100} {"a b. " * 100}"')
    file = write(tmp_path / "good.toml", text.replace("[20.0]", f"[{places}]"))
    scene, undamped = load(file)
    assert (scene.name, undamped.name) == ("", "undamped") and len(scene.record.stress) == 99
    assert scene.numerics.continuum.mesh_path is None


@pytest.mark.parametrize("first, mistake, words", EACH, ids=[one for _, one, _ in EACH])
def test_mistake_is_one_line(first, mistake, words, tmp_path, spoilt, line_of):
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "pillar.msh").touch()
    text, named = spoilt(GOOD, f"{first}; {mistake}" if first else mistake)
    line = line_of(write(tmp_path / "scene.toml", text))
    assert line.partition(": ")[2].startswith(named), line
    assert_words(words, line)


@pytest.mark.parametrize("name", IN_TEXT)
def test_mistake_in_the_text_is_one_line(name, tmp_path, line_of):
    old, new, words = IN_TEXT[name]
    assert old in GOOD
    assert_words(words, line_of(write(tmp_path / "scene.toml", GOOD.replace(old, new, 1))))


def test_the_mesh_is_found_beside_the_scene(tmp_path, monkeypatch, changed):
    """Whatever the folder that the command runs in, also as the scene is passed on."""
    (tmp_path / "pillar.msh").touch()
    path = write(tmp_path / "scene.toml", changed(GOOD, MESH))
    monkeypatch.chdir(tmp_path.parent)
    numerics = load(path.relative_to(tmp_path.parent))[0].numerics.continuum
    assert numerics.mesh == "pillar.msh"
    assert numerics.mesh_path == tmp_path / "pillar.msh"
    assert numerics.model_copy().mesh_path == tmp_path / "pillar.msh"


@pytest.mark.parametrize("name", HISTORIES)
def test_bad_history_is_one_line(name, tmp_path, changed, line_of):
    content, words = HISTORIES[name]
    write(tmp_path / "blast.csv", content)
    keys = f"{SHAPED}; load.shape = 'table'; load.file = 'blast.csv'"
    line = line_of(write(tmp_path / "scene.toml", changed(GOOD, keys)))
    assert_words(f"load.file = 'blast.csv' ... {words}", line)


def test_scene_that_cannot_be_read(tmp_path, line_of):
    os.mkfifo(tmp_path / "pipe.toml")
    (tmp_path / "dangling.toml").symlink_to("gone.toml")
    assert "no such scene" in line_of(tmp_path / "gone.toml")
    assert "No such file" in line_of(tmp_path / "dangling.toml")
    assert "directory" in line_of(tmp_path)
    assert "regular file" in line_of(tmp_path / "pipe.toml")
    assert "UTF-8" in line_of(write(tmp_path / "latin.toml", 'title = "Säule"'.encode("latin-1")))
    assert "10 MB" in line_of(write(tmp_path / "huge.toml", "#" * 10_000_001))
    assert "title: is required" in line_of(write(tmp_path / "empty.toml", ""))


@pytest.mark.parametrize("override", OVERRIDES, ids=lambda override: override[:40])
def test_bad_override_on_the_command_line(override, tmp_path, jointwave, without_warnings):
    """What is unusual in the scene may have been warned of before its engines were built."""
    scene, out = write(tmp_path / "scene.toml", GOOD), tmp_path / "out"
    said = jointwave("run", scene, "--set", override, "--out", out, code=2)
    (line,) = without_warnings(said.err)
    assert_words(OVERRIDES[override], line)
    assert (str(scene) in line) != ("must be key=value" in line)  # there the file is right
    assert said.out == "" and not out.exists()


@pytest.fixture
def blamed(tmp_path, jointwave):
    """Return a function of a command and a scene's text that returns what its lines blame."""

    def keys(command, text):
        said = jointwave(command, scene := write(tmp_path / "scene.toml", text), code=2).err
        each = [line.removeprefix(f"jointwave: {scene}") for line in said.splitlines()]
        return [line.removeprefix(": ").partition(": must")[0] for line in each]

    return keys


def test_every_mistake_of_a_file_has_its_line(blamed, changed):
    """Of several tables, of one check and of the next, and of a variant; what all variants share
    stands there once."""
    wrong = "pillar.side = 'thin'; rock.density = -1.0; variants[0].time.duration = 0.0"
    found = blamed("compare", changed(GOOD, wrong))
    assert found == wrong.replace("variants[0].", " [undamped]: ").split("; ")
    apart = blamed("explain", changed(GOOD, "record.stress = [60.0]; soft_layers[0].y = 20.1"))
    assert [key.split(" = ")[0] for key in apart] == ["soft_layers[0].y", "record.stress"]


def test_every_mistake_of_a_rock_mass_has_its_line(blamed, one_joint, in_toml):
    """Of three checks of one scene whose tables are each right."""
    up, quiet = {"direction": [0.0, 1.0]}, dict.fromkeys(("left", "right", "bottom"), "quiet")
    record = {"points": [[30.0, 5.0]], "interval": 1.0}
    found = blamed("explain", in_toml(one_joint(gravity=up, boundaries=quiet, record=record)))
    keys = [key.split(" = ")[0] for key in found]
    assert keys == ["record.points[0]", "gravity.static", "record.interval"]


def test_of_very_many_mistakes_the_first_hundred_are_listed(blamed, changed):
    places = ", ".join(f"'{i}'" for i in range(300))
    lines = blamed("compare", changed(GOOD, f"record.stress = [{places}]"))
    assert len(lines) == 101 and lines[-1] == "jointwave: and 200 more"
