"""Rock masses on meshes of users: files that gmsh has made, with joints at any angle and shape."""

import re

import numpy as np
import pytest

from jointwave.cases.errors import SceneError
from jointwave.cases.read import load
from jointwave.compare.engines import solver
from jointwave.compare.solvers.incident import incident
from jointwave.continuum.loads.forces import pushes
from jointwave.continuum.mesh.session import gmsh_session
from jointwave.continuum.run import simulate
from jointwave.continuum.scene import body_of
from jointwave.results.dataset import energy_residual
from tests.continuum.bodies import springs
from tests.continuum.drawing import crossed, grouped

SIZE = 10.0  # m, of the square

SCENE = """
title = "a mesh"
domain = { mesh = "rock.msh" }
rock = { density = 2600.0, intact_modulus = 5e10 }
waves = [{ kind = "P", direction = [0.0, 1.0], shape = "ricker", amplitude = 1e6, period = 4e-3 }]
boundaries = { left = "quiet", right = "quiet", bottom = "quiet", top = "quiet" }
time = { duration = 8e-3 }
record = { points = [[5.0, 2.0], [5.0, 8.0]], joints = [[5.0, 5.0]], interval = 1e-4 }
numerics = { continuum = { order = 2, scheme = "explicit" } }

[[joint_sets]]
name = "Fault"
dip = 30.0
normal_stiffness = 2e10
shear_stiffness = 8e9
"""
NATIVE = SCENE.replace('{ mesh = "rock.msh" }', "{ size = [10.0, 10.0] }")
NATIVE += "through = [5.0, 5.0]\n"


def through(dip):
    """Return the ends of a joint through the middle of the square, on its sides."""
    half = SIZE / 2 * np.tan(np.radians(dip))
    return [(0.0, SIZE / 2 - half), (SIZE, SIZE / 2 + half)]


@pytest.fixture
def given(tmp_path):
    """Return a function that gives the scene on a mesh that gmsh makes as it is asked to."""

    def scene(joints=None, text=SCENE, **asked):
        lines = {"joint fault": through(30.0)} if joints is None else joints
        crossed(tmp_path / "rock.msh", lines, 0.0, SIZE, **asked)
        (tmp_path / "scene.toml").write_text(text)
        (found,) = load(tmp_path / "scene.toml")
        return found

    return scene


@pytest.mark.parametrize(
    "asked",
    [{}, {"version": 2.2, "crack": True}, {"quads": True, "size": 1.0}],
    ids=["once", "twice", "quads"],
)
def test_a_joint_of_a_mesh_is_that_of_a_set(asked, given, tmp_path):
    """As the mesh of the same joint that the program makes itself, to the error of both: at some 14
    elements of order 2 in a wavelength of S waves."""
    scene = given(**asked)
    (tmp_path / "native.toml").write_text(NATIVE)
    (native,) = load(tmp_path / "native.toml", {"numerics.continuum.size": 0.5})
    field = incident(native)
    found, expected = (simulate(one, incident=field) for one in (scene, native))
    for name in ("velocity", "stress", "traction", "gap", "slip"):
        off = np.abs(found[name] - expected[name]).max() / np.abs(expected[name]).max()
        assert off < 0.01


CROSS = SCENE.replace("time =", """\
loads = [{ kind = "pressure", opening = 0, shape = "ricker", amplitude = 1e6, period = 4e-3 }]
time =""") + """
[[joint_sets]]
name = "cross"
dip = 80.0
normal_stiffness = 2e10
shear_stiffness = 8e9
"""  # fmt: skip
#: A joint that bends and ends inside the rock, one that ends at it, and a hole.
BENT = {"Joint FAULT": [(0, 3), (4, 5), (7, 5.5)], "joint_cross": [(3, 0), (4, 5)]}


def test_joints_of_a_mesh_may_bend_and_end_inside_the_rock(given):
    """Both sides of a joint are apart but at its tip; rock is whole around it; a hole is an opening
    that a pressure acts in: its forces are in balance."""
    scene = given(BENT, CROSS, hole=(7.5, 8.0), size=1.0)
    found = body_of(scene)
    contacts, body = found.blocks.contacts, found.body
    length = np.sqrt(20) + np.hypot(3, 0.5), np.hypot(1, 5)
    for k, expected in enumerate(length):
        own = contacts.area[contacts.joint_set == k].sum()
        assert own == pytest.approx(expected, rel=1e-12)
    short = sum(length) - body.joints.weight.sum()
    assert 0 < short < 1.0 / 6  # of an element of at most 1 m: its node at the tip does not open
    assert np.isclose(found.blocks.volume.sum(), 100 - np.pi, rtol=0.01)
    tip, bend = (np.hypot(*(body.x - x).T) < 1e-9 for x in ((7.0, 5.5), (4.0, 5.0)))
    assert tip.sum() == 1 and bend.sum() == 3
    stiffness = body.stiffness + springs(body)
    for motion in (np.ones_like(body.x), body.x @ [[0.0, 1.0], [-1.0, 0.0]]):
        force = stiffness @ motion.ravel()
        assert np.abs(force).max() < 1e-13 * np.abs(stiffness).max() * np.abs(motion).max()
    result = simulate(scene, incident=incident(scene))
    assert energy_residual(result) < 1e-10
    (push,) = pushes(scene, body, "jointed")
    assert np.abs(push.share).max() > 0.1
    assert np.abs(push.share.reshape(-1, 2).sum(axis=0)).max() < 1e-12


@pytest.mark.parametrize(
    "joints, text, words",
    [
        (None, SCENE.replace("Fault", "other"), "'joint fault', but no joint set has this name"),
        (None, CROSS, r"must have a group 'joint cross' for joint_sets\[1\]"),
        ({"joint fault": [(0.0, 0.0), (SIZE, 0.0)]}, SCENE, "between no two blocks, the first"),
        (None, SCENE.replace("dip = 30.0", "dip = 30.0\nthrough = [1.0, 1.0]"), "has no effect"),
        (None, SCENE.replace("rock.msh", "lost.msh"), "domain.mesh = 'lost.msh': cannot be read"),
        (None, SCENE.replace("5.0, 8.0]", "5.0, 18.0]"), r"record.points\[1\]"),
        (None, SCENE.replace('.msh"', '.msh", size = [1.0, 1.0]'), "exactly one of domain.size"),
    ],
)
def test_what_does_not_fit_a_mesh_is_said_in_a_line(joints, text, words, given):
    with pytest.raises(SceneError) as error:
        given(joints, text)
    said = [str(one) for one in error.value.each]
    assert any(re.search(words, line) for line in said) and "\n" not in "".join(said)


def test_only_the_continuum_takes_a_mesh(given):
    """Its cells are no rigid blocks, and no exact solution knows where its joints are."""
    scene = given()
    assert solver("continuum-jointed").applies(scene)
    for name, words in {"dem": "domain.mesh", "parallel-joints": "those of a mesh"}.items():
        answer = solver(name).applies(scene)
        assert not answer and words in answer.reason


def test_tetrahedra_in_space(tmp_path):
    """A plane joint through a box: volume, areas, sides, and joints between two sets of cells."""
    with gmsh_session() as gmsh:
        occ = gmsh.model.occ
        box, plane = occ.addBox(0, 0, 0, 2, 1, 1), occ.addRectangle(-1, -1, 0.5, 4, 4)
        occ.rotate([(2, plane)], 1, 0.5, 0.5, 0, 1, 0, 0.3)
        occ.fragment([(3, box)], [(2, plane)])
        occ.synchronize()
        each = [(k, len(gmsh.model.getAdjacencies(2, k)[0])) for _, k in gmsh.model.getEntities(2)]
        gmsh.model.removeEntities([(2, tag) for tag, cells in each if not cells], True)
        grouped(gmsh, 3, "rock", [1, 2])
        grouped(gmsh, 2, "joint fault", [tag for tag, cells in each if cells == 2])
        gmsh.option.setNumber("Mesh.MeshSizeMax", 0.6)
        gmsh.model.mesh.generate(3)
        gmsh.write(str(tmp_path / "rock.msh"))
    lines = [one for one in SCENE.splitlines() if not one.startswith(("waves", "boundaries"))]
    text = "\n".join(lines).replace("order = 2", "order = 1")
    text = text.replace("dip = 30.0", "dip = 17.0\ndip_direction = 90.0")
    text = re.sub("record = .*", "record = { points = [[0.5, 0.5, 0.5]] }", text)
    (tmp_path / "scene.toml").write_text(text)
    (scene,) = load(tmp_path / "scene.toml")
    body = body_of(scene).body
    assert body.mass.sum() == pytest.approx(3 * 2600.0 * 2.0, rel=1e-12)
    assert body.joints.weight.sum() == pytest.approx(2.0 / np.cos(0.3), rel=1e-9)
    assert np.abs(body.joints.frame[:, 0, 1]).max() < 1e-9
    areas = {name: side.weight.sum() for name, side in body.sides.items()}
    expected = {"left": 1, "right": 1, "front": 2, "back": 2, "bottom": 2, "top": 2}
    assert areas == pytest.approx(expected, rel=1e-9)
    pieces = np.linalg.eigvalsh(body.stiffness.toarray())
    assert (pieces < 1e-9 * pieces.max()).sum() == 12
