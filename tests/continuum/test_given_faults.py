"""A gmsh file that does not fit the scene is refused in one line that says what is wrong."""

import numpy as np
import pytest

from jointwave.cases.errors import SceneError
from jointwave.continuum.scene import body_of
from tests.continuum.drawing import DIMENSION, drawn


@pytest.fixture
def fault(tmp_path, column):
    """Return a function that draws a file and gives the one line that it is refused with."""

    def line(kind, changes=None, **options):
        keys = {"numerics__continuum__dim": DIMENSION[kind], **(changes or {})}
        scene = column(drawn(tmp_path / "pillar.msh", kind, **options), **keys)
        with pytest.raises(SceneError) as error:
            body_of(scene)
        text = str(error.value)
        assert "numerics.continuum.mesh = " in text and len(text.splitlines()) == 1
        return text

    return line


def test_missing_partners_are_counted_and_placed(tmp_path, column):
    """The last block's lower face is made narrower: facets of both sides lose their partners."""
    import meshio

    path = drawn(tmp_path / "pillar.msh", "quadrilateral", doubled=True)
    file = meshio.gmsh.read(path)
    cells = np.concatenate([block.data for block in file.cells if block.type == "quad"])
    of_last = cells[file.points[cells, 1].mean(axis=1) > 1.0]
    lower = np.intersect1d(of_last, np.flatnonzero(file.points[:, 1] < 1.0 + 1e-9))
    file.points[lower, 0] *= 0.5
    meshio.write(path, file, "gmsh22")
    with pytest.raises(SceneError) as error:
        body_of(column(path), dim=2)
    assert "4 facets of its joints have no coincident partner" in str(error.value)
    assert "the first at (-0.1, 1) m" in str(error.value)


@pytest.mark.parametrize("kind", ["quadrilateral", "tetrahedron"])
def test_pieces_that_no_group_joins_are_refused(kind, fault):
    text = fault(kind, doubled=True, names=["joint", "seam"])
    count = 2 * 2 if kind == "quadrilateral" else 2 * 8
    assert f"{count} facets coincide with others and are in no group 'joint" in text


MISTAKES = {
    "too short": (dict(length=1.4), ["spans y = 0 to 1.4 m, the pillar 0 to 1.5 m"]),
    "too wide": (dict(side=0.5), ["spans x = -0.25 to 0.25 m, the pillar -0.2 to 0.2 m"]),
    "of second order": (dict(order=2), ["has quad9 cells, must be first-order"]),
    "of a wrong dimension": (
        dict(changes=dict(numerics__continuum__dim=3)),
        ["quadrilateral cells", "dim = 3"],
    ),
}


@pytest.mark.parametrize("version", [2.2, 4.1])
def test_a_file_saved_without_regard_to_groups_is_refused(version, fault):
    text = fault("quadrilateral", version=version, save_all=1)
    assert "save it with Mesh.SaveAll = 0" in text


@pytest.mark.parametrize("name", MISTAKES)
def test_what_does_not_fit_is_one_line(name, fault):
    options, words = MISTAKES[name]
    text = fault("quadrilateral", **options)
    for word in words:
        assert word in text


def test_simplices_of_third_order_are_refused(fault):
    text = fault("triangle", changes=dict(numerics__continuum__order=3))
    assert "triangle cells support numerics.continuum.order 1 or 2" in text


GOOD = """\
$MeshFormat
2.2 0 8
$EndMeshFormat
$PhysicalNames
2
2 1 "rock"
1 2 "joint"
$EndPhysicalNames
$Nodes
6
1 -0.2 0 0
2 0.2 0 0
3 -0.2 0.5 0
4 0.2 0.5 0
5 -0.2 1.5 0
6 0.2 1.5 0
$EndNodes
$Elements
3
1 3 2 1 1 1 2 4 3
2 3 2 1 1 3 4 6 5
3 1 2 2 1 3 4
$EndElements
"""

FILES = {
    "empty": ("", "", "cannot be read as a gmsh mesh"),
    "no mesh": (GOOD, "a,b\n1,2\n", "cannot be read as a gmsh mesh"),
    "cut short": (GOOD[GOOD.index("4 0.2 0.5") :], "", "cannot be read as a gmsh mesh"),
    "a vertex of a number without end": (
        "6 0.2 1.5 0",
        "6000000000 0.2 1.5 0",
        "cannot be read as a gmsh mesh, version 2.2 or 4.1: ",
    ),
    "no rock": ('"rock"', '"stone"', "no group whose name starts with 'rock'"),
    "a rock of lines": ('2 1 "rock"', '1 2 "rock"', "line cells"),
    "no cell in the rock": ('2 1 "rock"', '2 7 "rock"', "has no cells"),
    "two kinds of cells": (
        "2 3 2 1 1 3 4 6 5",
        "2 2 2 1 1 3 4 6",
        "has quad and triangle cells, must be of one kind",
    ),
    "cells outside the rock": ("2 3 2 1 1", "2 3 2 0 1", "1 of its cells are in no group"),
    "a joint without facets": ('1 2 "joint"', '1 5 "joint"', "group 'joint' has no facets"),
    "a joint inside a cell": ("2 2 1 3 4", "2 2 1 3 6", "belong to no rock cell"),
    "a joint on the outside": ("2 2 1 3 4", "2 2 1 3 1", "(-0.2, 0.25) m"),
    "a cell inside out": ("1 1 2 4 3", "1 1 2 3 4", "1 of its cells are flat or inside out"),
    "a flat cell": ("3 -0.2 0.5 0", "3 0.2 0.5 0", "cells are flat or inside out"),
    "off the plane": ("3 -0.2 0.5 0", "3 -0.2 0.5 0.1", "spans z = 0 to 0.1 m"),
    "a start that is not": ('1 2 "joint"', '1 2 "start"', "start face must lie at y = 0 m"),
}


@pytest.mark.parametrize("name", FILES)
def test_a_bad_file_is_one_line(name, tmp_path, column):
    old, new, words = FILES[name]
    text = GOOD.replace(old, new, 1) if old else new
    assert text != GOOD
    with pytest.raises(SceneError) as error:
        read_text(text, tmp_path, column)
    message = str(error.value)
    assert words in message
    assert len(message.splitlines()) == 1 and len(message) < len(str(tmp_path)) + 400


def read_text(text, tmp_path, column):
    path = tmp_path / "pillar.msh"
    path.write_text(text)
    return body_of(column(path), dim=2).body


def test_the_good_file_is_good(tmp_path, column, capfd):
    body = read_text(GOOD, tmp_path, column)
    assert (body.joints.column == 0).all() and len(body.x) == 2 * 9
    assert capfd.readouterr() == ("", "")


def test_a_cell_that_the_file_repeats_for_another_group_counts_once(tmp_path, column):
    again = "3 1 2 2 1 3 4\n4 3 2 9 1 3 4 6 5\n5 1 2 3 1 4 3\n"
    text = GOOD.replace("3 1 2 2 1 3 4\n", again).replace("$Elements\n3", "$Elements\n5")
    text = text.replace("$PhysicalNames\n2", '$PhysicalNames\n4\n2 9 "top"\n1 3 "joint too"')
    body = read_text(text, tmp_path, column)
    assert (body.joints.column == 0).all() and len(body.x) == 2 * 9


def test_a_file_that_is_not_there(tmp_path, column):
    for path, words in ((tmp_path / "gone.msh", "no such file"), (tmp_path, "must be a file")):
        with pytest.raises(SceneError, match=words):
            body_of(column(path))
