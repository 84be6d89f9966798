"""Scenes of blocks from a file."""

import json
from itertools import pairwise

import numpy as np
import pytest

from jointwave.cases.errors import SceneError
from jointwave.cases.read import load
from jointwave.cases.warnings import warnings
from jointwave.compare.cli.scene_files import write_new
from jointwave.compare.engines import solver
from jointwave.compare.runs.checkpoint.signature import differences, signature

SCENE = """
title = "A brick wall"
domain = { blocks = "wall.obj" }
rock = { density = 2600.0, intact_modulus = 5e10, intact_poisson = 0.2 }
waves = [{ kind = "P", direction = [0.0, 1.0], shape = "ricker", amplitude = 1e6, period = 4e-3 }]
boundaries = { bottom = "quiet", top = "quiet" }
time = { duration = 6e-3 }
record = { points = [[2.3, 0.25], [2.3, 1.75]], joints = [[2.5, 1.0]], interval = 1e-4 }

[[joint_sets]]
name = "bed"
dip = 0.0
spacing = 0.5
normal_stiffness = 2e10
shear_stiffness = 8e9

[[joint_sets]]
name = "head"
dip = 90.0
spacing = 1.0
normal_stiffness = 3e10
shear_stiffness = 8e9
"""
CUT = SCENE.replace('{ blocks = "wall.obj" }', "{ size = [4.0, 2.0] }")
CUT += 'ends_at = ["bed"]\noffset = 0.5\n'


def wall(windows=()):
    """Return the text of an OBJ file of bricks of 1 by 0.5 m in four courses."""
    lines, count = [], 0
    for row in range(4):
        heads = [0.0, *np.arange(0.5 if row % 2 else 1.0, 4.0), 4.0]
        for number, (left, right) in enumerate(pairwise(heads)):
            if (row, number) in windows:
                continue
            lines.append(f"o brick {row} {number}")
            for x, y in ((left, 0.0), (right, 0.0), (right, 0.5), (left, 0.5)):
                lines.append(f"v {x} {y + row / 2} 0")
            lines.append("f " + " ".join(str(count + k) for k in (1, 2, 3, 4)))
            count += 4
    return "\n".join(lines)


@pytest.fixture
def scene(tmp_path):
    def read(text=SCENE, blocks=None):
        (tmp_path / "wall.obj").write_text(wall() if blocks is None else blocks)
        (tmp_path / "scene.toml").write_text(text)
        (found,) = load(tmp_path / "scene.toml")
        return found

    return read


#: Triangles of a block follow the order of its edges, those of homogenised rock all of it.
OFF = {"dem": 1e-12, "continuum-jointed": 1e-5, "continuum-equivalent": 0.05}


@pytest.mark.parametrize("name", OFF)
def test_waves_in_a_wall_of_bricks_are_those_in_the_wall_that_is_cut(name, scene):
    engine = solver(name)
    own, cut = scene(), scene(CUT)
    assert engine.applies(own)
    found, expected = engine.run(own), engine.run(cut)
    assert np.abs(expected.velocity).max() > 0.01
    for one in ("velocity", "stress"):
        assert np.abs(found - expected)[one].max() < OFF[name] * np.abs(expected[one]).max()


def test_a_run_of_blocks_of_a_file_is_of_that_file(scene, tmp_path):
    """It is not resumed once the file is another, of the same blocks too."""
    found = scene()
    one = signature(found, "dem", 1)
    assert differences(one, signature(found, "dem", 1)) == []
    (tmp_path / "wall.obj").write_text(wall() + "\n# another")
    assert differences(one, signature(found, "dem", 1)) == ["scene"]


def test_a_copy_of_a_scene_has_its_blocks(scene, tmp_path):
    """`jointwave new --from` copies the file beside the scene, which runs there."""
    scene()
    path, blocks = write_new(str(tmp_path / "other" / "copy"), str(tmp_path / "scene.toml"))
    assert blocks == path.parent / "wall.obj"
    assert load(path)[0].domain.holes == []


def test_a_window_is_an_opening(scene):
    load = 'loads = [{ kind = "pressure", opening = 0, shape = "step", amplitude = 1e6 }]\n'
    (window,) = scene(load + SCENE, wall(windows=[(1, 2)])).domain.holes
    assert np.min(window, axis=0).tolist() == [1.5, 0.5]
    assert np.max(window, axis=0).tolist() == [2.5, 1.0]


def test_a_sweep_runs_anew_where_the_blocks_have_changed(scene, tmp_path, jointwave):
    """The file of the scene has not."""
    swept = ("run", tmp_path / "scene.toml", "--sweep", "waves.0.amplitude=1e6,2e6", "--workers", 1)
    found = []
    for windows in ((), [(1, 2)], [(1, 2)]):
        scene(blocks=wall(windows))
        said = jointwave(*swept, "--out", tmp_path / "out", "--json").out
        found.append([row["peak"] for row in json.loads(said)["rows"]])
    assert found[0] != found[1] == found[2]


but = SCENE.replace
BARE = but("spacing = 0.5\n", "").replace("spacing = 1.0\n", "")


@pytest.mark.parametrize(
    "text, blocks, words",
    [
        (SCENE, "", "domain.blocks = 'wall.obj': has no blocks"),
        (but("wall.obj", "lost.obj"), None, "domain.blocks = 'lost.obj': cannot be read"),
        (SCENE + 'ends_at = ["bed"]\n', None, "has no effect: domain.blocks has the joints"),
        (but('obj"', 'obj", openings = [[[1.0, 1.0]]]'), None, "are part of domain.blocks"),
        (but('.obj"', '.obj", size = [1.0, 1.0]'), None, "exactly one of domain.size"),
    ],
)
def test_what_does_not_fit_blocks_is_said_in_a_line(text, blocks, words, scene):
    with pytest.raises(SceneError) as error:
        scene(text, blocks)
    said = [str(one) for one in error.value.each]
    assert any(words in line for line in said) and "\n" not in "".join(said)


@pytest.mark.parametrize(
    "text, words",
    [
        (but("[[jo", "numerics = { dem = { block = 0.2 } }\n[[jo", 1), "as they are"),
        (but("ies = {", 'ies = { left = "periodic", right = "periodic",'), "periodic"),
        (BARE, "only where joint_sets have a spacing (m)"),
    ],
)
def test_rigid_blocks_are_those_of_the_file(text, words, scene):
    answer = solver("dem").applies(scene(text))
    assert not answer and words in answer.reason


def test_warnings_are_of_the_blocks_of_the_file(scene):
    """Bricks of 1 m by 0.5 m, an S wave of 6.8 m, and spacings in millimetres."""
    apart, sizes = warnings(scene(but("spacing = 0.5", "spacing = 500.0")))
    assert "the largest of domain.blocks gives 9.62 rigid blocks per wavelength of S" in sizes
    assert "joint_sets[0].spacing = 500 m, but its joints in domain.blocks are about 0.6" in apart
    assert "500 mm is 0.5 m" in apart
