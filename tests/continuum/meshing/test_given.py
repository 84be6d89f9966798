"""A user's gmsh file: every way to draw joints gives the same mesh, every mistake one line."""

import numpy as np
import pytest

from cases.calibrate import calibrate
from cases.errors import SceneError
from continuum.meshing.cells import DIMENSION, jacobians
from continuum.meshing.given import given_mesh

KINDS = ["quadrilateral", "triangle", "hexahedron", "tetrahedron"]
FLAT, STEEP = (0.5, 0.5), (0.6, 1.3)  # y at x = -0.2 and at x = 0.2: 60 degrees

kinds = pytest.mark.parametrize("kind", KINDS)
doubled = pytest.mark.parametrize("doubled", [False, True], ids=["cut here", "doubled in the file"])


@pytest.fixture
def given(drawn, column):
    """Return a function that draws a file and reads it as the mesh of a scene."""

    def read(kind, *args, dim=None, changes=None, **options):
        scene = column(3, **(changes or {}))
        path = drawn(kind, *args, **options)
        return given_mesh(path, scene, calibrate(scene), dim)

    return read


@pytest.fixture
def fault(given):
    """Return a function that gives the error of a file, which must be one line."""

    def line(*args, **options):
        with pytest.raises(SceneError) as error:
            given(*args, **options)
        text = str(error.value)
        assert text.startswith("free pillar") or "numerics.continuum.mesh = " in text
        assert len(text.splitlines()) == 1
        return text

    return line


@kinds
@doubled
def test_joints_across_the_pillar(kind, doubled, given, volumes, areas, located):
    dim = DIMENSION[kind]
    mesh = given(kind, doubled=doubled, dim=dim)
    section = 0.4 ** (dim - 1)
    assert mesh.cell == kind and mesh.layers == ()
    assert len(mesh.parts) == 3
    for part in mesh.parts:
        assert (jacobians(kind, part.x, part.cells) > 0).all()
        assert volumes(mesh, part).sum() == pytest.approx(0.5 * section, rel=1e-12)
        assert part.shifts.tolist() == [[0.0] * dim] and not part.material.any()
    assert [part.x[:, 1].min() for part in mesh.parts] == pytest.approx([0, 0.5, 1.0], rel=1e-12)
    for joint, y in ((0, 0.5), (1, 1.0)):
        corners = mesh.joints.corners[mesh.joints.joint == joint]
        assert areas(corners).sum() == pytest.approx(section, rel=1e-12)
        assert corners[..., 1] == pytest.approx(y, rel=1e-12)
    _, middle = located(mesh)
    place = mesh.joints.corners[..., 1].mean(axis=1)
    assert (middle[mesh.joints.left, 1] < place).all()
    assert (middle[mesh.joints.right, 1] > place).all()
    for side, y in ((mesh.start, 0.0), (mesh.end, 1.5)):
        assert areas(side.corners).sum() == pytest.approx(section, rel=1e-12)
        assert side.corners[..., 1] == pytest.approx(y, abs=1e-15)


@kinds
@doubled
def test_an_inclined_joint(kind, doubled, given, volumes, areas, located):
    """The normal decides which side is left: middles of steep cells may lie the other way in y."""
    dim = DIMENSION[kind]
    mesh = given(kind, [STEEP], doubled=doubled, names=["joint of a fault"])
    assert len(mesh.parts) == 2
    depth = 0.4 ** (dim - 2)
    below = volumes(mesh, mesh.parts[0]).sum()
    assert below == pytest.approx(0.95 * 0.4 * depth, rel=1e-12)
    area = areas(mesh.joints.corners).sum()
    assert area == pytest.approx(np.hypot(0.4, 0.7) * depth, rel=1e-12)
    assert (mesh.joints.joint == 1).all()  # 0.95 m is nearest to 1.0 m
    first = len(mesh.parts[0].cells)
    assert (mesh.joints.left < first).all() and (mesh.joints.right >= first).all()
    corners, _ = located(mesh)
    apart = np.abs(corners[mesh.joints.right][:, None] - mesh.joints.corners[:, :, None]).max(-1)
    assert apart.min(axis=2).max() < 1e-12


@pytest.mark.parametrize("kind", KINDS)
def test_cut_here_and_doubled_in_the_file_are_the_same_mesh(kind, given):
    cut, double = (given(kind, [FLAT, STEEP], doubled=way) for way in (False, True))
    for one, other in zip(_sorted(cut), _sorted(double), strict=True):
        assert one == pytest.approx(other, abs=1e-12)


def _sorted(mesh):
    """Return the places of cells and facets in an order of their own."""
    for part in mesh.parts:
        yield _rows(part.x)
    yield _rows(mesh.joints.corners.mean(axis=1))


def _rows(x):
    return x[np.lexsort(np.round(x, 9).T)]


@pytest.mark.parametrize("version", [2.2, 4.0, 4.1])
@pytest.mark.parametrize("binary", [0, 1])
def test_all_versions_of_the_format(version, binary, given):
    mesh = given("quadrilateral", version=version, binary=binary)
    assert [len(part.cells) for part in mesh.parts] == [4, 4, 4]
    assert mesh.joints.joint.tolist() == [0, 0, 1, 1]


@doubled
def test_end_faces_without_a_group_are_found_by_their_place(doubled, given):
    with_groups, without = (given("tetrahedron", ends=e, doubled=doubled) for e in (True, False))
    for one, other in ((with_groups.start, without.start), (with_groups.end, without.end)):
        assert (one.cell == other.cell).all() and (one.corners == other.corners).all()


def test_one_tagged_side_is_enough(given):
    mesh = given("hexahedron", doubled=True, untagged=[0])
    assert np.bincount(mesh.joints.joint).tolist() == [4, 4]


def test_inclined_facets_of_one_group_follow_one_law(given):
    """Each by itself would be nearest to either joint; together they are nearest to the first."""
    steep = (0.3, 1.1)
    mesh = given("quadrilateral", [steep], elements=8)
    y = mesh.joints.corners[..., 1].mean(axis=1)
    assert (np.abs(y - 0.5) < np.abs(y - 1.0)).any() and (np.abs(y - 1.0) < np.abs(y - 0.5)).any()
    assert (mesh.joints.joint == 0).all()


def test_groups_apart_follow_laws_apart(given):
    cuts = [(0.3, 0.6), FLAT[:1] + (0.9,), (1.2, 1.4)]
    one = given("quadrilateral", cuts, names=["joints"] * 3)
    apart = given("quadrilateral", cuts)
    assert (one.joints.joint == 1).all()  # their mean is 0.816 m
    assert apart.joints.joint.tolist() == [0, 0, 0, 0, 1, 1]


def test_joints_across_count_by_themselves_in_one_group(given):
    mesh = given("triangle", names=["Joint"] * 2)
    assert mesh.joints.joint.tolist() == [0, 0, 1, 1]


def test_a_mirrored_file_is_turned(given, drawn, column, volumes):
    """Cells drawn the other way round have negative Jacobians in the file."""
    import meshio

    for kind, swap in (("tetrahedron", [0, 2, 1, 3]), ("hexahedron", [0, 3, 2, 1, 4, 7, 6, 5])):
        path, scene = drawn(kind), column()
        file = meshio.gmsh.read(path)
        for block in file.cells:
            if block.dim == 3:
                block.data[:] = block.data[:, swap]
        meshio.write(path, file, "gmsh22")
        mesh = given_mesh(path, scene, calibrate(scene))
        total = sum(volumes(mesh, part).sum() for part in mesh.parts)
        assert total == pytest.approx(1.5 * 0.16, rel=1e-12)
        assert all((jacobians(kind, part.x, part.cells) > 0).all() for part in mesh.parts)


def test_missing_partners_are_counted_and_placed(drawn, column):
    """The far piece moved 1 mm away: the facets of both sides have lost their partners."""
    import meshio

    path, scene = drawn("quadrilateral", doubled=True), column()
    file = meshio.gmsh.read(path)
    far = file.points[:, 1] > 1.0 + 1e-9
    file.points[_of_last_block(file) & ~far, 0] *= 0.5
    meshio.write(path, file, "gmsh22")
    with pytest.raises(SceneError) as error:
        given_mesh(path, scene, calibrate(scene))
    assert "4 facets of its joints have no partner at the same place" in str(error.value)
    assert "the first at (-0.1, 1) m" in str(error.value)


def _of_last_block(file):
    cells = np.concatenate([block.data for block in file.cells if block.type == "quad"])
    last = cells[(file.points[cells, 1].mean(axis=1) > 1.0)]
    return np.isin(np.arange(len(file.points)), last)


@pytest.mark.parametrize("kind", ["quadrilateral", "tetrahedron"])
def test_pieces_that_no_group_joins_are_refused(kind, drawn, column):
    path = drawn(kind, doubled=True, names=["joint", "seam"])
    with pytest.raises(SceneError, match="are in no group 'joint...', the first at") as error:
        given_mesh(path, column(), calibrate(column()))
    count = 2 * 2 if kind == "quadrilateral" else 2 * 8
    assert f"{count} facets meet others at the same place" in str(error.value)


def test_a_joint_on_the_outside_is_refused(fault):
    text = fault("quadrilateral", [(1.5, 1.5)], length=1.5, ends=False)
    assert "facets of its joints lie on the outside of the pillar" in text


MISTAKES = {
    "too short": (dict(length=1.4), ["spans y = 0 to 1.4 m, the pillar 0 to 1.5 m"]),
    "too wide": (dict(side=0.5), ["spans x = -0.25 to 0.25 m, the pillar -0.2 to 0.2 m"]),
    "of second order": (dict(order=2), ["holds quad9 cells, must be first-order"]),
    "of a wrong dimension": (dict(dim=3), ["quadrilateral cells", "dim = 3"]),
    "consistent mass": (
        dict(
            changes=dict(
                numerics__continuum__mass="consistent", numerics__continuum__cell="simplex"
            )
        ),
        ["quadrilateral cells take numerics.continuum.mass = 'lumped'"],
    ),
}


@pytest.mark.parametrize("name", MISTAKES)
def test_what_does_not_fit_is_one_line(name, fault):
    options, words = MISTAKES[name]
    text = fault("quadrilateral", **options)
    for word in words:
        assert word in text


def test_simplices_of_third_order_are_refused(fault):
    text = fault("triangle", changes=dict(numerics__continuum__order=3))
    assert "triangle cells take numerics.continuum.order 1 or 2" in text


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
    "no rock": ('"rock"', '"stone"', "no group whose name starts with 'rock'"),
    "a rock of lines": ('2 1 "rock"', '1 2 "rock"', "line cells"),
    "no cell in the rock": ('2 1 "rock"', '2 7 "rock"', "holds no cells"),
    "two kinds of cells": (
        "2 3 2 1 1 3 4 6 5",
        "2 2 2 1 1 3 4 6",
        "holds quad and triangle cells, must be of one kind",
    ),
    "cells outside the rock": ("2 3 2 1 1", "2 3 2 0 1", "1 of its cells are in no group"),
    "a joint without facets": ('1 2 "joint"', '1 5 "joint"', "group 'joint' holds no facets"),
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
    path = tmp_path / "pillar.msh"
    path.write_text(text)
    scene = column()
    with pytest.raises(SceneError) as error:
        given_mesh(path, scene, calibrate(scene))
    message = str(error.value)
    assert words in message
    assert len(message.splitlines()) == 1 and len(message) < len(str(path)) + 400


def test_the_good_file_is_good(tmp_path, column, capfd):
    path = tmp_path / "pillar.msh"
    path.write_text(GOOD)
    scene = column()
    mesh = given_mesh(path, scene, calibrate(scene))
    assert mesh.joints.joint.tolist() == [0] and len(mesh.parts) == 2
    assert capfd.readouterr() == ("", "")


def test_a_file_that_is_not_there(tmp_path, column):
    for path, words in ((tmp_path / "gone.msh", "does not exist"), (tmp_path, "is no file")):
        with pytest.raises(SceneError, match=words):
            given_mesh(path, column(), calibrate(column()))
