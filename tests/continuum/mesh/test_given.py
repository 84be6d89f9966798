"""A user's gmsh file: every way to draw joints gives the same mesh."""

import numpy as np
import pytest

from jointwave.cases.material.calibrate import calibrate
from jointwave.continuum.mesh.cells import DIMENSION, jacobians
from jointwave.continuum.mesh.given import given_mesh

KINDS = ["quadrilateral", "triangle", "hexahedron", "tetrahedron"]
FLAT, STEEP = (0.5, 0.5), (0.6, 1.3)  # y at x = -0.2 and at x = 0.2: 60 degrees

#: m; gmsh places nodes on curves to some 1e-12 of their length, from the end they start at.
ROUND = 1e-11

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
        assert volumes(mesh, part).sum() == pytest.approx(0.5 * section, rel=ROUND)
        assert part.shifts.tolist() == [[0.0] * dim] and not part.material.any()
    assert [part.x[:, 1].min() for part in mesh.parts] == pytest.approx([0, 0.5, 1.0], rel=ROUND)
    for joint, y in ((0, 0.5), (1, 1.0)):
        corners = mesh.joints.corners[mesh.joints.joint == joint]
        assert areas(corners).sum() == pytest.approx(section, rel=ROUND)
        assert corners[..., 1] == pytest.approx(y, rel=ROUND)
    _, middle = located(mesh)
    place = mesh.joints.corners[..., 1].mean(axis=1)
    assert (middle[mesh.joints.left, 1] < place).all()
    assert (middle[mesh.joints.right, 1] > place).all()
    for side, y in ((mesh.start, 0.0), (mesh.end, 1.5)):
        assert areas(side.corners).sum() == pytest.approx(section, rel=ROUND)
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
    assert below == pytest.approx(0.95 * 0.4 * depth, rel=ROUND)
    area = areas(mesh.joints.corners).sum()
    assert area == pytest.approx(np.hypot(0.4, 0.7) * depth, rel=ROUND)
    assert (mesh.joints.joint == 1).all()  # 0.95 m is nearest to 1.0 m
    first = len(mesh.parts[0].cells)
    assert (mesh.joints.left < first).all() and (mesh.joints.right >= first).all()
    corners, _ = located(mesh)
    apart = np.abs(corners[mesh.joints.right][:, None] - mesh.joints.corners[:, :, None]).max(-1)
    assert apart.min(axis=2).max() < ROUND


@pytest.mark.parametrize("kind", KINDS[:3])  # free tetrahedra do not fill a block alike twice
def test_cut_here_and_doubled_in_the_file_are_the_same_mesh(kind, given):
    cut, double = (given(kind, [FLAT, STEEP], doubled=way) for way in (False, True))
    for one, other in zip(_sorted(cut), _sorted(double), strict=True):
        assert one == pytest.approx(other, abs=ROUND)


def _sorted(mesh):
    """Return the places of cells and facets in an order of their own."""
    for part in mesh.parts:
        yield _rows(part.x)
    yield _rows(mesh.joints.corners.mean(axis=1))


def _rows(x):
    return x[np.lexsort(np.round(x, 9).T + 0.0)]


@pytest.mark.parametrize("version", [2.2, 4.1])
@pytest.mark.parametrize("binary", [0, 1])
def test_both_versions_of_the_format(version, binary, given):
    mesh = given("quadrilateral", version=version, binary=binary)
    assert [len(part.cells) for part in mesh.parts] == [4, 4, 4]
    assert mesh.joints.joint.tolist() == [0, 0, 1, 1]


@doubled
def test_end_faces_without_a_group_are_found_by_their_place(doubled, given):
    with_groups, without = (given("tetrahedron", ends=e, doubled=doubled) for e in (True, False))
    for one, other in ((with_groups.start, without.start), (with_groups.end, without.end)):
        assert (one.cell == other.cell).all() and (one.corners == other.corners).all()


def test_inclined_facets_of_one_group_follow_one_law(given):
    """Each by itself would be nearest to either joint; together they are nearest to the first."""
    steep = (0.3, 1.1)
    mesh = given("quadrilateral", [steep], elements=8)
    y = mesh.joints.corners[..., 1].mean(axis=1)
    assert (np.abs(y - 0.5) < np.abs(y - 1.0)).any() and (np.abs(y - 1.0) < np.abs(y - 0.5)).any()
    assert (mesh.joints.joint == 0).all()


def test_groups_apart_follow_laws_apart(given):
    cuts = [(0.3, 0.6), (0.5, 0.9), (1.2, 1.4)]
    one = given("quadrilateral", cuts, names=["joints"] * 3)
    apart = given("quadrilateral", cuts)
    assert (one.joints.joint == 1).all()  # their mean is 0.816 m
    assert apart.joints.joint.tolist() == [0, 0, 0, 0, 1, 1]


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
        assert total == pytest.approx(1.5 * 0.16, rel=ROUND)
        assert all((jacobians(kind, part.x, part.cells) > 0).all() for part in mesh.parts)


#: Four squares around (0, 0.75), the facet from there to the right side tagged.
NOTCH = """\
$MeshFormat
2.2 0 8
$EndMeshFormat
$PhysicalNames
2
2 1 "rock"
1 2 "joint"
$EndPhysicalNames
$Nodes
9
1 -0.2 0 0
2 0 0 0
3 0.2 0 0
4 -0.2 0.75 0
5 0 0.75 0
6 0.2 0.75 0
7 -0.2 1.5 0
8 0 1.5 0
9 0.2 1.5 0
$EndNodes
$Elements
5
1 3 2 1 1 1 2 5 4
2 3 2 1 1 2 3 6 5
3 3 2 1 1 4 5 8 7
4 3 2 1 1 5 6 9 8
5 1 2 2 1 5 6
$EndElements
"""


def test_a_joint_may_end_inside_the_rock(tmp_path, column):
    """Only its mouth is doubled; the tip is one vertex of all four cells."""
    path, scene = tmp_path / "notch.msh", column()
    path.write_text(NOTCH)
    mesh = given_mesh(path, scene, calibrate(scene))
    (part,) = mesh.parts
    assert len(part.x) == 10
    assert (part.x == (0.2, 0.75)).all(axis=1).sum() == 2
    assert (part.x == (0.0, 0.75)).all(axis=1).sum() == 1
    assert (mesh.joints.left.tolist(), mesh.joints.right.tolist()) == ([1], [3])
