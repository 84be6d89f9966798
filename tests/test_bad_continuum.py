"""Mistakes in how the continuum is meshed and stepped are one line too, told when a scene is read.

A mistake is a change to a good scene: (what is replaced, by what, words that the line must hold).
"""

import os
from pathlib import Path

import pytest

from cases import SceneError, load

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

[[soft_layers]]
y = 20.0
spacing_stiffness = 4.375e8

[load]
shape = "sine"
amplitude = 1.0e6
period = 0.01

[time]
duration = 0.002

[numerics.continuum]
order = 2

[record]
stress = [20.0]
"""

ORDER = "order = 2\n"
STIFFNESS = "spacing_stiffness = 4.375e8\n"
MESH = 'mesh = "pillar.msh"\n'

MISTAKES = {
    # the elements
    "simplices of third order": (
        ORDER,
        'order = 3\ncell = "simplex"\n',
        ["numerics.continuum.order = 3", "1 or 2", "'simplex'"],
    ),
    "consistent mass of hexahedra": (
        ORDER,
        'mass = "consistent"\n',
        ["numerics.continuum.mass = 'consistent'", "needs cell 'simplex'"],
    ),
    "consistent mass in explicit steps": (
        ORDER,
        'mass = "consistent"\ncell = "simplex"\nscheme = "explicit"\n',
        ["numerics.continuum.mass = 'consistent'", "'implicit' or 'auto'"],
    ),
    "unknown cell": (ORDER, 'cell = "cube"\n', ["numerics.continuum.cell = 'cube'", "'simplex'"]),
    "four dimensions": (ORDER, "dim = 4\n", ["numerics.continuum.dim = 4", "at most 3"]),
    "no element across": (
        ORDER,
        "elements_across = 0\n",
        ["numerics.continuum.elements_across = 0", "at least 1"],
    ),
    # a file
    "a file that is not there": (
        ORDER,
        'mesh = "gone.msh"\n',
        ["numerics.continuum.mesh = 'gone.msh'", "no such file"],
    ),
    "a folder": (ORDER, 'mesh = ""\n', ["numerics.continuum.mesh = ''", "must be a gmsh file"]),
    "a pipe": (ORDER, 'mesh = "pipe"\n', ["numerics.continuum.mesh = 'pipe'", "must be a gmsh"]),
    "a bar from a file": (
        ORDER,
        MESH + "dim = 1\n",
        ["numerics.continuum.dim = 1", "is a bar"],
    ),
    "a cell beside a file": (
        ORDER,
        MESH + 'cell = "simplex"\n',
        ["numerics.continuum.cell = 'simplex'", "no meaning with numerics.continuum.mesh"],
    ),
    "elements beside a file": (
        ORDER,
        MESH + "elements_per_block = 2\n",
        ["numerics.continuum.elements_per_block = 2", "no meaning"],
    ),
    "elements across beside a file": (
        ORDER,
        MESH + "elements_across = 1\n",
        ["numerics.continuum.elements_across = 1", "no meaning"],
    ),
    # layers with a thickness
    "a layer as thick as a block": (
        STIFFNESS,
        STIFFNESS + "thickness = 0.5\n",
        ["soft_layers[0].thickness = 0.5", "less than pillar.block = 0.5"],
    ),
    "a layer of no stiffness": (
        STIFFNESS,
        "thickness = 0.1\n",
        ["soft_layers[0].thickness = 0.1", "needs a spacing_stiffness or normal_stiffness"],
    ),
    "a layer with friction": (
        STIFFNESS,
        STIFFNESS + "thickness = 0.1\nfriction_angle = 30.0\n",
        ["soft_layers[0].friction_angle = 30.0", "a layer with thickness is rock"],
    ),
    "a layer with cohesion": (
        STIFFNESS,
        STIFFNESS + "thickness = 0.1\ncohesion = 0.0\n",
        ["soft_layers[0].cohesion = 0.0", "a layer with thickness is rock"],
    ),
    "a layer that opens": (
        STIFFNESS,
        STIFFNESS + "thickness = 0.1\ntension = false\n",
        ["soft_layers[0].tension = false", "a layer with thickness is rock"],
    ),
    "a layer that breaks": (
        STIFFNESS,
        STIFFNESS + "thickness = 0.1\ntensile_strength = 1e5\nfracture_energy = 100.0\n",
        ["soft_layers[0].tensile_strength = 100000.0", "a layer with thickness is rock"],
    ),
}


def write(folder: Path, text: str) -> Path:
    """Write a scene beside an empty mesh and a pipe, and return its path."""
    os.mkfifo(folder / "pipe")
    (folder / "pillar.msh").touch()
    path = folder / "scene.toml"
    path.write_text(text)
    return path


def line_of(path: Path) -> str:
    """Return the one line that a scene is refused with."""
    with pytest.raises(SceneError) as error:
        load(path)
    message = str(error.value)
    assert message.startswith(str(path)) and len(message.splitlines()) == 1
    assert len(message) < len(str(path)) + 400
    return message


@pytest.mark.parametrize("name", MISTAKES)
def test_mistake_is_one_line(name, tmp_path):
    old, new, words = MISTAKES[name]
    assert GOOD.count(old) == 1
    message = line_of(write(tmp_path, GOOD.replace(old, new)))
    for word in words:
        assert word in message


def test_a_layer_beside_a_file_is_one_line(tmp_path):
    thick = GOOD.replace(STIFFNESS, STIFFNESS + "thickness = 0.1\n")
    message = line_of(write(tmp_path, thick.replace(ORDER, MESH)))
    assert "soft_layers[0].thickness = 0.1: cannot be meshed with numerics" in message


def test_the_mesh_is_found_beside_the_scene(tmp_path, monkeypatch):
    """Whatever the folder that the command runs in, also as the scene is passed on."""
    path = write(tmp_path, GOOD.replace(ORDER, MESH))
    monkeypatch.chdir(tmp_path.parent)
    (scene,) = load(path.relative_to(tmp_path.parent))
    numerics = scene.numerics.continuum
    assert numerics.mesh == "pillar.msh"
    assert numerics.mesh_path == tmp_path / "pillar.msh"
    assert numerics.model_copy().mesh_path == tmp_path / "pillar.msh"


def test_a_scene_without_a_mesh_has_no_path(tmp_path):
    (scene,) = load(write(tmp_path, GOOD))
    assert scene.numerics.continuum.mesh_path is None
