"""A user's gmsh file as a pillar: every way to draw joints gives the same body."""

import numpy as np
import pytest

from jointwave.continuum.run import simulate
from jointwave.continuum.scene import body_of
from jointwave.continuum.space.compat import cell_nodes
from tests.continuum.bodies import STIFFNESS, blow, pushed, springs
from tests.continuum.drawing import DIMENSION, drawn

STEEP = (0.6, 1.3)  # y at x = -0.2 and at x = 0.2: 60 degrees
MODULUS, POISSON, DENSITY = 5e10, 0.2, 2600.0
ROUND = 1e-11  # gmsh places nodes on curves to some 1e-12 of their length

ROCK = {
    "rock": {"density": DENSITY, "intact_modulus": MODULUS, "intact_poisson": POISSON},
    "joints": dict(zip(("normal_stiffness", "shear_stiffness"), STIFFNESS, strict=True)),
    "damping": {},
}


@pytest.fixture
def given(tmp_path, column):
    """Return a function that draws a file and gives the body of the pillar of it."""

    def read(kind, *args, order=1, model="jointed", **options):
        path = drawn(tmp_path / "pillar.msh", kind, *args, **options)
        scene = column(path, numerics__continuum__order=order, **ROCK)
        return body_of(scene, model, dim=DIMENSION[kind]).body

    return read


@pytest.mark.parametrize(("order", "doubled"), [(1, False), (2, True)])
@pytest.mark.parametrize("kind", DIMENSION)
def test_uniform_stress_is_in_balance_through_an_inclined_joint(kind, order, doubled, given):
    """The upper piece moves by what the joint opens and slides; each of its facets and of those of
    the sides is there once, cut here or doubled in the file."""
    dim, name = DIMENSION[kind], ["joint of a fault"]
    body = given(kind, [STEEP], order=order, names=name, doubled=doubled)
    stress = np.array([[1.0, 0.5, 0.3], [0.5, -3.0, 0.2], [0.3, 0.2, 2.0]])[:dim, :dim] * 1e6
    strain = ((1 + POISSON) * stress - POISSON * np.trace(stress) * np.eye(dim)) / MODULUS
    normal = np.array([-0.7, 0.4, 0.0])[:dim] / np.hypot(0.7, 0.4)
    traction = stress @ normal
    opening = (traction @ normal) * normal
    jump = opening / STIFFNESS[0] + (traction - opening) / STIFFNESS[1]
    nodes, far = cell_nodes(body.space), np.zeros(len(body.x), bool)
    middle = body.x[nodes].mean(axis=1) - np.array([0.0, 0.95, 0.0])[:dim]
    far[nodes[middle @ normal > 0]] = True
    u = (body.x @ strain + far[:, None] * jump).ravel()
    force = (body.stiffness + springs(body)) @ u - pushed(body, stress)
    assert np.abs(force).max() < 1e-10 * np.abs(body.stiffness).max() * np.abs(u).max()
    assert (body.joints.column == 1).all()  # 0.95 m is nearest to 1.0 m
    assert body.joints.weight.sum() == pytest.approx(np.hypot(0.4, 0.7) * 0.4 ** (dim - 2))
    assert body.mass.sum() == pytest.approx(dim * DENSITY * 1.5 * 0.4 ** (dim - 1), rel=ROUND)


LAW = {"friction_angle": 20.0, "cohesion": 1e4, "tension": False, "damping_ratio": 0.02}
ACTING = {"joints": ROCK["joints"] | LAW, "ends": {"start": "quiet", "end": "matched"}}
ACTING |= {"time__duration": 2e-3, "record__interval": 5e-5}


@pytest.mark.parametrize("kind", ["quadrilateral", "hexahedron"])
def test_a_pillar_of_a_file_moves_as_the_built_one(kind, tmp_path, column):
    """With every joint sliding and opening, in other numbers of nodes."""
    dim = DIMENSION[kind]
    keys = ROCK | ACTING | {"load": blow(dim), "numerics__continuum__order": 2}
    given = column(drawn(tmp_path / "pillar.msh", kind, doubled=True), **keys)
    many = {"elements_per_block": 2, "elements_across": 2}
    keys |= {f"numerics__continuum__{key}": value for key, value in many.items()}
    found, built = (simulate(scene, dim=dim) for scene in (given, column(**keys)))
    assert found.attrs["dt"] == built.attrs["dt"]
    for name in ("velocity", "displacement", "stress", "energy"):
        peak = np.abs(built[name]).max()
        assert peak > 0 and np.abs(found[name] - built[name]).max() < 1e-10 * peak, name


@pytest.mark.parametrize(("version", "binary"), [(2.2, 0), (2.2, 1), (4.1, 0), (4.1, 1)])
def test_both_versions_of_the_format(version, binary, given):
    body = given("quadrilateral", version=version, binary=binary)
    assert len(body.block) == 12 and np.bincount(body.joints.column).tolist() == [4, 4]


@pytest.mark.parametrize("doubled", [False, True])
def test_end_faces_and_one_side_of_a_doubled_joint_need_no_group(doubled, given):
    untagged = [0] if doubled else []
    whole = given("tetrahedron", doubled=doubled)
    found = given("tetrahedron", ends=False, doubled=doubled, untagged=untagged)
    for name in ("start", "end"):
        assert (found.sides[name].place == whole.sides[name].place).all()
    assert (found.joints.place == whole.joints.place).all()


def test_facets_of_one_group_follow_one_law(given):
    """Each by itself would be nearest to either joint; together they are nearest to the first, or
    to the second by the mean of three lines, 0.816 m. Groups apart follow laws apart."""
    joints = given("quadrilateral", [(0.3, 1.1)], elements=8).joints
    assert joints.place[:, 1].min() < 0.5 and joints.place[:, 1].max() > 1.0
    assert (joints.column == 0).all()
    cuts = [(0.3, 0.6), (0.5, 0.9), (1.2, 1.4)]
    one = given("quadrilateral", cuts, names=["joints"] * 3)
    assert (one.joints.column == 1).all()
    assert np.bincount(given("quadrilateral", cuts).joints.column).tolist() == [8, 4]


@pytest.mark.parametrize(
    ("kind", "swap"), [("tetrahedron", [0, 2, 1, 3]), ("hexahedron", [0, 3, 2, 1, 4, 7, 6, 5])]
)
def test_a_mirrored_file_is_turned(kind, swap, tmp_path, column):
    """Cells drawn the other way round have negative Jacobians in the file."""
    import meshio

    path = drawn(tmp_path / "pillar.msh", kind)
    file = meshio.gmsh.read(path)
    for block in file.cells:
        if block.dim == 3:
            block.data[:] = block.data[:, swap]
    meshio.write(path, file, "gmsh22")
    body = body_of(column(path, numerics__continuum__order=1, **ROCK)).body
    assert body.mass.min() > 0
    assert body.mass.sum() == pytest.approx(3 * DENSITY * 1.5 * 0.16, rel=ROUND)


def test_the_homogenised_bar_has_no_joints(given):
    """What the file has twice is one there: it moves in one piece."""
    body = given("triangle", doubled=True, model="equivalent")
    assert not body.joints.weight.size
    modes = np.linalg.eigvalsh(body.stiffness.toarray())
    assert (modes < 1e-9 * modes.max()).sum() == 3
