"""Blocks of the user's own: files of every kind, against the complex that they are written from."""

import json
from itertools import pairwise

import meshio
import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from jointwave.cases.errors import SceneError
from jointwave.cases.geometry.blocks import blocks_of
from jointwave.cases.geometry.cell_complex import box
from jointwave.cases.geometry.cut import cut, planes_of
from jointwave.cases.geometry.measure import outline_moments
from jointwave.cases.geometry.own_blocks import complex_of_file, outlines_of, with_sets
from jointwave.cases.gmsh_file import MeshError
from jointwave.cases.partition.scene import blocks_of_scene
from jointwave.cases.partition.shape import SIDES as SIDES_OF_BOX
from jointwave.cases.partition.shape import shape_of
from jointwave.cases.warnings import warnings

TOLERANCE = 1e-9  # m


def cut_by(body, normal, places, joint_set=0, cells=None):
    """Return a complex cut by planes at places along a normal, or some cells of it."""
    family = np.where(np.ones(body.count, bool) if cells is None else cells, 0, -1)
    planes = planes_of(normal, family, [np.array(places)], None, joint_set, TOLERANCE)
    return cut(body, planes, TOLERANCE).body


def complex_with(path, names=(), normals=None):
    """Return the blocks of a file with joint sets by their names and normals."""
    normals = np.empty((0, 2)) if normals is None else np.array(normals)
    return with_sets(*complex_of_file(path), list(names), normals)


def thick(read, *arguments):
    """Return the blocks of a file, unless one is about as thin as the tolerance, or two sets have
    about one direction."""
    try:
        return read(*arguments)
    except MeshError as error:
        assert "is flat" in str(error) or "as near to set" in str(error)
        assume(False)


def random_blocks(dim, seed):
    """Return a box of 10 by 8 (by 6) m, cut at random by sets of planes, each through a part of the
    blocks that there are, and the normals of the sets."""
    rng, normals = np.random.default_rng(seed), []
    body = box(np.zeros(dim), np.array([10.0, 8.0, 6.0])[:dim])
    for k in range(dim):
        normal = rng.normal(size=dim)
        normals.append(normal / np.linalg.norm(normal))
        reach = body.vertices @ normals[k]
        places = np.sort(rng.uniform(reach.min(), reach.max(), 3))
        places = places[np.diff(places, prepend=-9) > 0.2]
        chosen = rng.random(body.count) < 0.7
        chosen[0] = True
        body = cut_by(body, normals[k], places, k, chosen)
    return blocks_of(body, TOLERANCE), normals


def polygons(blocks):
    """Return the faces of each block by their corners, in the plane its one outline."""
    cells = range(blocks.count)
    if blocks.body.dim == 2:
        return [[blocks.outlines.of(cell)] for cell in cells]
    of, _normal, outlines = blocks.faces(TOLERANCE)
    return [[outlines.of(face) for face in np.flatnonzero(of == cell)] for cell in cells]


def in_space(x):
    return np.pad(x, ((0, 0), (0, 3 - x.shape[1])))


def numbered(solids):
    """Return vertices in space [n, 3], and the faces of each block by their own numbers."""
    faces = [face for one in solids for face in one]
    numbers = iter(np.split(np.arange(sum(map(len, faces))), np.cumsum([*map(len, faces)])[:-1]))
    each = [[next(numbers).tolist() for _ in one] for one in solids]
    return in_space(np.concatenate(faces)), each


def write_vtu(path, solids):
    """One cell a block, with vertices of its own."""
    x, blocks = numbered(solids)
    cells = [(f"polyhedron{sum(map(len, faces))}", [faces]) for faces in blocks]
    if solids[0][0].shape[1] == 2:
        cells = [("polygon", faces) for faces in blocks]
    meshio.write(path, meshio.Mesh(x, cells))


def write_obj(path, solids):
    x, blocks = numbered(solids)
    lines = ["# blocks", *("v {:.17g} {:.17g} {:.17g}".format(*one) for one in x)]
    for k, faces in enumerate(blocks):
        lines.append(f"o block {k}")
        lines += ["f " + " ".join(f"{i + 1}//1" for i in face) for face in faces]
    path.write_text("\n".join(lines))


def write_json(path, solids):
    """An assembly as COMPAS writes it."""
    (x, blocks), node = numbered(solids), {}
    for k, faces in enumerate(blocks):
        own = {str(i): dict(zip("xyz", x[i].tolist(), strict=True)) for face in faces for i in face}
        mesh = {"vertex": own, "face": {str(i): face for i, face in enumerate(faces)}}
        node[str(k)] = {"block": {"dtype": "compas_assembly.datastructures/Block", "data": mesh}}
    graph = {"dtype": "compas.datastructures/Graph", "data": {"node": node, "edge": {}}}
    whole = {"dtype": "compas_assembly.datastructures/Assembly", "data": {"graph": graph}}
    path.write_text(json.dumps(whole))


def write_msh(path, solids):
    """One elementary entity a block, in triangles or tetrahedra from its middle."""
    (x, blocks), plane = numbered(solids), solids[0][0].shape[1] == 2
    middles = np.array([np.concatenate(faces).mean(axis=0) for faces in solids])
    cells, tags = [], []
    for k, faces in enumerate(blocks):
        centre = len(x) + k
        if plane:
            own = [[centre, *pair] for face in faces for pair in pairwise([*face, face[0]])]
        else:
            own = [[centre, face[0], *pair] for face in faces for pair in pairwise(face)]
        cells.append(("triangle" if plane else "tetra", np.array(own)))
        tags.append(np.full(len(own), k + 1))
    x = np.concatenate([x, in_space(middles)])
    # one vertex a place within a block, or its parts would not meet
    _, number, which = np.unique(np.round(x, 12), axis=0, return_index=True, return_inverse=True)
    cells = [(kind, which.reshape(-1)[own]) for kind, own in cells]
    data = {"gmsh:physical": [0 * t for t in tags], "gmsh:geometrical": tags}
    meshio.gmsh.write(path, meshio.Mesh(x[number], cells, cell_data=data), "2.2", binary=True)


WRITERS = {"vtu": write_vtu, "obj": write_obj, "json": write_json, "msh": write_msh}


def agree(found, expected):
    """Assert that blocks, contacts and areas of joint sets are the same, in whatever order."""
    assert found.count == expected.count
    tree = np.linalg.norm(found.centroid[:, None] - expected.centroid, axis=2)
    number = tree.argmin(axis=1)
    assert tree.min(axis=1).max() < 1e-9 and len(set(number)) == found.count
    scale = expected.volume.max()
    assert np.abs(found.volume - expected.volume[number]).max() < 1e-12 * scale
    area = {
        tuple(sorted(pair)): a
        for pair, a in zip(expected.contacts.blocks, expected.contacts.area, strict=True)
    }
    pairs = [tuple(sorted(number[pair])) for pair in found.contacts.blocks]
    assert set(pairs) == set(area) and len(pairs) == len(area)
    off = [abs(area[pair] - a) for pair, a in zip(pairs, found.contacts.area, strict=True)]
    assert max(off, default=0) < 1e-12 * scale
    assert found.boundary.area.sum() == pytest.approx(expected.boundary.area.sum(), rel=1e-12)
    sets = [np.bincount(one.contacts.joint_set, one.contacts.area) for one in (found, expected)]
    assert sets[0] == pytest.approx(sets[1], rel=1e-12)


@pytest.mark.parametrize("kind", WRITERS)
@pytest.mark.parametrize("dim", [2, 3])
@settings(max_examples=15)
@given(seed=st.integers(0, 10**6))
def test_blocks_of_a_file_are_those_that_were_written(dim, kind, seed, tmp_path_factory):
    """Joint sets go by the planes of contacts; surfaces are closed, so that blocks can be cut."""
    expected, normals = random_blocks(dim, seed)
    path = tmp_path_factory.mktemp("blocks") / f"blocks.{kind}"
    WRITERS[kind](path, polygons(expected))
    body = thick(complex_with, path, "abc"[:dim], normals)
    agree(blocks_of(body, TOLERANCE), expected)
    cells, normal = body.count, np.ones(dim) / np.sqrt(dim)
    middle = np.array([5.0, 4.0, 3.0])[:dim] @ normal
    again = blocks_of(cut_by(body, normal, [middle]), TOLERANCE)
    assert again.count > cells and again.volume.sum() == pytest.approx(expected.volume.sum())


@pytest.mark.parametrize("dim", [2, 3])
@settings(max_examples=15)
@given(seed=st.integers(0, 10**6))
def test_blocks_of_rounded_corners_touch_as_far_as_without(dim, seed, tmp_path_factory):
    """To seven digits, a tenth of the tolerance: then faces are neither plane nor in one plane."""
    expected, _ = random_blocks(dim, seed)
    path = tmp_path_factory.mktemp("blocks") / "blocks.obj"
    write_obj(path, [[np.round(face, 6) for face in faces] for faces in polygons(expected)])
    found = blocks_of(thick(complex_of_file, path)[0], 1e-5)
    for one in ("contacts", "boundary"):
        area = getattr(expected, one).area.sum()
        assert getattr(found, one).area.sum() == pytest.approx(area, abs=1e-3)


SIDES = [(0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)]


def obj(*objects):
    """Return the text of an OBJ file of objects, each by its corners and faces."""
    lines, first = [], 1
    for k, (corners, faces) in enumerate(objects):
        lines += [f"o {k}", *("v " + " ".join(map(str, x)) for x in corners)]
        lines += ["f " + " ".join(str(first + i) for i in face) for face in faces]
        first += len(corners)
    return "\n".join(lines)


def square(x, y, size=1):
    return [(x, y, 0), (x + size, y, 0), (x + size, y + size, 0), (x, y + size, 0)], [(0, 1, 2, 3)]


def cube(low, size=(1, 1, 1)):
    corners = [(x, y, z) for z in (0, 1) for x, y in ((0, 0), (1, 0), (1, 1), (0, 1))]
    return [tuple(np.add(low, np.multiply(size, x)).tolist()) for x in corners], SIDES


TETRA = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]
OUT = [(0, 2, 1), (0, 1, 3), (1, 2, 3), (2, 0, 3)]
ELL = [(0, 0, 0), (2, 0, 0), (2, 1, 0), (1, 1, 0), (1, 2, 0), (0, 2, 0)]
AROUND = [(0, 1, 7, 6), (1, 2, 8, 7), (2, 3, 9, 8), (3, 4, 10, 9), (4, 5, 11, 10), (5, 0, 6, 11)]
PRISM = [*ELL, *((x, y, 1) for x, y, _ in ELL)], [(5, 4, 3, 2, 1, 0), tuple(range(6, 12)), *AROUND]
MESH = {"vertex": {"0": {"x": 0, "y": 0, "z": 0}}, "face": {}}

CUBE = cube((0, 0, 0))[0]
WITHIN = square(0.5, 0.5)
WARPED = [*CUBE[:6], (1, 1, 1.5), CUBE[7]]
FLAT = [(1, 0, 0), (2, 0, 0), (3, 0, 0)], [(0, 1, 2)]
TURNED = [[1, 0, 0, 3], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]
MOVED = {"transformation": {"data": {"matrix": TURNED}}, "geometry": MESH}
PINCHED = [square(x, y) for x in range(4) for y in range(4) if (x, y) not in ((1, 1), (2, 2))]

#: Names of files, their texts, and words.
BAD = {
    "not convex, in the plane": ("a.obj", obj((ELL, [range(6)])), "face 0 is not convex near ["),
    "not convex, in space": ("a.obj", obj(PRISM), "'0' is not convex, or open, or has"),
    "crossed": ("a.obj", obj(([*TETRA[:3], (1, 1, 0)], [(0, 1, 2, 3)])), "is not convex"),
    "flat": ("a.obj", obj(square(0, 0), FLAT), "'1' is flat"),
    "overlap": ("a.obj", obj(square(0, 0), WITHIN), "'0' and '1' overlap near [0.75, 0.75]"),
    "twice": ("a.obj", obj(square(0, 0), square(0, 0)), "'0' and '1' overlap"),
    "inside": ("a.obj", obj((CUBE, SIDES), cube((0, 0, 0), (0.5, 0.5, 0.5))), "overlap"),
    "not plane": ("a.obj", obj((WARPED, SIDES)), "'0' has a face that is not plane near ["),
    "inverted": ("a.obj", obj((TETRA, [OUT[0][::-1], *OUT[1:]])), "or has a face turned inwards"),
    "open": ("a.obj", obj((CUBE, SIDES[:5])), "'0' is not convex, or open, or has"),
    "apart": ("a.obj", obj(square(0, 0), square(1.1, 0)), "in 2 separate pieces, one near [1.6"),
    "by a corner": ("a.obj", obj(square(0, 0), square(1, 1)), "in 2 separate pieces"),
    "pinched": ("a.obj", obj(*PINCHED), "its outline touches itself near [2, 2]"),
    "no vertex": ("a.obj", "v 0 0 0\nv 1 0 0\nf 1 2 7\n", "with a corner that is no vertex"),
    "not a number": ("a.obj", "v 0 0 x\nf 1 2 3\n", "cannot be read as .obj: could not convert"),
    "no block": ("a.obj", "v 0 0 0\n", "has no blocks"),
    "no mesh": ("a.json", "{}", "has no blocks"),
    "no face": ("a.json", json.dumps(MESH), "has no blocks"),
    "no JSON": ("a.json", "{", "cannot be read as .json: is not valid JSON"),
    "moved": ("a.json", json.dumps(MOVED), "has blocks with a transformation, must have them in"),
    "no VTU": ("a.vtu", "<a/>", "cannot be read as a VTU file of VTK: "),
    "no gmsh": ("a.msh", "nothing", "cannot be read as a gmsh mesh, version 2.2 or 4.1: "),
    "kind": ("a.stl", "", "must be a file of blocks: .vtu, .msh, .json, .obj"),
}


@pytest.mark.parametrize("name, text, words", BAD.values(), ids=BAD)
def test_what_makes_no_blocks_is_said_in_a_line(name, text, words, tmp_path):
    (tmp_path / name).write_text(text)
    with pytest.raises(MeshError) as error:
        outlines_of(complex_with(tmp_path / name))
    assert words in str(error.value) and "\n" not in str(error.value)


def test_a_face_that_is_touched_in_its_middle_is_one_of_both(tmp_path):
    """A cube of half the size on a cube: the rest of the face around it is outside. In the plane
    the edge beside a smaller square is in two parts."""
    path = tmp_path / "two.obj"
    path.write_text(obj(cube((0, 0, 0)), cube((0.25, 0.25, 1), (0.5, 0.5, 0.5))))
    found = blocks_of(complex_with(path, ["one"], [[0.0, 0.0, 1.0]]), TOLERANCE)
    assert found.volume == pytest.approx([1.0, 0.125])
    assert found.contacts.area == pytest.approx([0.25]) and found.contacts.joint_set == [0]
    assert found.boundary.area.sum() == pytest.approx(6 + 5 * 0.25 - 0.25)
    assert outline_moments(found.boundary.outlines).size == pytest.approx(found.boundary.area)
    path.write_text(obj(square(0, 0, 3), square(1, 3)))
    found = blocks_of(complex_with(path), TOLERANCE).boundary
    beside = found.normal[:, 1] * (found.blocks[:, 0] == 0) > 0.5
    assert sorted(found.outlines.corners.reshape(-1, 2, 2)[beside].tolist()) == [
        [[1.0, 3.0], [0.0, 3.0]],
        [[3.0, 3.0], [2.0, 3.0]],
    ]


def test_openings_are_sides_from_left_to_right(tmp_path):
    frame = [square(x, y) for x in range(5) for y in range(3) if (x, y) not in ((1, 1), (3, 1))]
    (tmp_path / "frame.obj").write_text(obj(*frame))
    body = complex_with(tmp_path / "frame.obj")
    outer, *holes = outlines_of(body)
    assert np.ptp(outer, axis=0) == pytest.approx([5, 3])
    assert [hole.mean(axis=0).tolist() for hole in holes] == [[1.5, 1.5], [3.5, 1.5]]
    sides = blocks_of(body, TOLERANCE).boundary
    assert [sides.area[sides.side == k].sum() for k in range(3)] == [16.0, 4.0, 4.0]


def test_sets_that_are_not_told_apart_are_refused(tmp_path):
    """By the dip alone, where a contact is as near to one as to the other."""
    (tmp_path / "a.obj").write_text(obj(square(0, 0), square(1, 0)))
    dips = np.radians([45.0, -45.0])
    normals = np.stack([-np.sin(dips), np.cos(dips)], axis=1)
    said = r"near \[1, 0.5\] whose plane is as near to set 'a' as to 'b'"
    with pytest.raises(MeshError, match=said):
        complex_with(tmp_path / "a.obj", ["a", "b"], normals)
    body = complex_with(tmp_path / "a.obj", ["a"], normals[:1])
    assert body.joint_set[body.inner] == [0]


def grouped(path, joints):
    """Write three squares in a row, surfaces 1 to 3, with the groups of edges given by name."""
    x = np.array([[i, j, 0.0] for i in range(4) for j in range(2)])
    quads = np.array([[0, 2, 3, 1], [2, 4, 5, 3], [4, 6, 7, 5]])
    lines = [np.array(edges) for edges in joints.values()]
    cells = [("quad", quads), *(("line", one) for one in lines)]
    tags = [np.arange(1, 4), *(np.full(len(one), k) for k, one in enumerate(lines, 2))]
    data = {"gmsh:physical": [np.ones(3, int), *tags[1:]], "gmsh:geometrical": tags}
    fields = {"Rock": np.array([1, 2])}
    fields |= {name: np.array([k, 1]) for k, name in enumerate(joints, 2)}
    mesh = meshio.Mesh(x, cells, cell_data=data, field_data=fields)
    meshio.gmsh.write(path, mesh, "2.2", binary=False)


def test_groups_of_gmsh_are_the_joints_and_the_rest_is_rock(tmp_path):
    grouped(tmp_path / "a.msh", {"joint Fault": [[4, 5]]})
    body = complex_with(tmp_path / "a.msh", ["fault"], [[0.0, 1.0]])
    found = blocks_of(body, TOLERANCE).contacts
    assert found.joint_set[np.argsort(found.centroid[:, 0])].tolist() == [-1, 0]
    for edge, place in (([0, 1], "0, 0.5"), ([2, 5], "1.5, 0.5")):  # on the outside, and inside
        grouped(tmp_path / "a.msh", {"joint Fault": [edge]})
        said = rf"1 facets of its joints lie between no two blocks, the first near \[{place}\]"
        with pytest.raises(MeshError, match=said):
            complex_with(tmp_path / "a.msh", ["fault"], [[0.0, 1.0]])


def test_cells_of_a_mesh_are_whole_but_at_joints(tmp_path):
    """Vertices may be there twice along a joint, and nowhere else."""
    grouped(tmp_path / "a.msh", {"joint Fault": [[4, 5]]})
    body, names = complex_of_file(tmp_path / "a.msh", mesh=True)
    assert names == ["fault"] and body.count == 3 and (body.joint_set == 0).sum() == 1
    mesh = meshio.gmsh.read(tmp_path / "a.msh")
    quads = mesh.cells[0].data
    mesh.points = np.concatenate([mesh.points, mesh.points])
    quads[2] = [12, 6, 7, 13]
    meshio.gmsh.write(tmp_path / "b.msh", mesh, "2.2", binary=False)
    assert (complex_of_file(tmp_path / "b.msh", mesh=True)[0].joint_set == 0).sum() == 1
    quads[1] = [10, 12, 13, 11]
    meshio.gmsh.write(tmp_path / "c.msh", mesh, "2.2", binary=False)
    with pytest.raises(MeshError, match=r"2 vertices coincide .* the first near \[1, 0\]"):
        complex_of_file(tmp_path / "c.msh", mesh=True)


def bricks():
    """Return a wall of four courses, offset by half a brick."""
    along, up = np.eye(3)[[0, 2]]
    body = cut_by(box(np.zeros(3), np.array([4.0, 1.0, 2.0])), up, [0.5, 1.0, 1.5])
    odd = (body.centres() @ up * 2).astype(int) % 2 == 1
    for courses, heads in ((odd, [0.5, 1.5, 2.5, 3.5]), (~odd, [1.0, 2.0, 3.0])):
        chosen = np.append(courses, np.zeros(body.count - len(courses), bool))
        body = cut_by(body, along, heads, 1, chosen)
    return blocks_of(body, TOLERANCE)


BED, HEAD = {"dip": 0.0}, {"dip": 90.0, "dip_direction": 90.0}
ON_STEP = [[0.5, 0.5, 0.9], [1.5, 0.5, 0.4]]


@pytest.fixture
def scene_of(rock_with):
    """A function of a file and receivers: blocks between beds and heads, on a fixed bottom."""

    def scene(path, points, sets=(BED, HEAD), **sides):
        return rock_with(
            *sets,
            folder=path.parent,
            domain={"blocks": path.name},
            gravity={},
            boundaries={"bottom": "fixed"} | sides,
            record={"points": points},
        )

    return scene


@pytest.mark.parametrize("kind", WRITERS)
def test_a_scene_of_polyhedra_is_one_in_space(kind, tmp_path, scene_of):
    """Its sides are the faces on the box around it; here it begins at no origin."""
    expected, away = bricks(), np.array([0.5, 0.25, -0.125])
    solids = [[face + away for face in faces] for faces in polygons(expected)]
    WRITERS[kind](tmp_path / f"wall.{kind}", solids)
    scene = scene_of(tmp_path / f"wall.{kind}", [[2.3, 0.5, 1.75]])
    assert scene.in_space and scene.gravity.direction == [0.0, 0.0, -1.0]
    assert np.ptp(scene.domain.corners, axis=0) == pytest.approx([4.0, 1.0, 2.0])
    found = blocks_of_scene(scene)
    assert found.count == expected.count and len(found.contacts) == len(expected.contacts)
    area = np.bincount(found.boundary.side, found.boundary.area, minlength=len(SIDES_OF_BOX[3]))
    assert area == pytest.approx([2, 2, 8, 8, 4, 4, 0], rel=1e-12)
    of_bed = found.contacts.joint_set == 0
    assert found.contacts.area[of_bed].sum() == pytest.approx(3 * 4.0)
    assert len(found.faces(TOLERANCE)[0]) == found.count * 6  # a face is one


STEP = obj(cube((0, 0, 0)), cube((1, 0, 0), (1, 1, 0.5)))


def test_what_lies_on_no_side_of_the_box_is_the_outline(tmp_path, scene_of):
    """A step: its lower top is no side of the box."""
    (tmp_path / "wall.obj").write_text(STEP)
    scene = scene_of(tmp_path / "wall.obj", ON_STEP, outline="quiet")
    outer = blocks_of_scene(scene).boundary
    area = np.bincount(outer.side, outer.area, minlength=len(SIDES_OF_BOX[3]))
    assert area == pytest.approx([1, 0.5, 1.5, 1.5, 2, 1, 1.5])
    normals = shape_of(scene.domain).normals()["outline"]
    assert sorted(normals.tolist()) == [[0, 0, 1], [1, 0, 0]]


@pytest.mark.parametrize(
    "blocks, points, sides, words",
    [
        (STEP, [[1.5, 0.5, 0.9]], {}, "record.points[0] = [1.5, 0.5, 0.9]: must lie"),
        (STEP, [[0.5, 0.5]], {}, "must have 3 numbers: the domain is in space"),
        (obj((CUBE, SIDES)), ON_STEP[:1], {"outline": "fixed"}, "is not a side of this"),
        (obj(square(0, 0)), ON_STEP[:1], {}, "must have 2 numbers: the domain is in the plane"),
        (obj(cube((0, 0, 0)), cube((0.5, 0, 0))), ON_STEP[:1], {}, "overlap near"),
    ],
)
def test_blocks_that_do_not_fit_are_refused(blocks, points, sides, words, tmp_path, scene_of):
    (tmp_path / "wall.obj").write_text(blocks)
    with pytest.raises(SceneError) as error:
        scene_of(tmp_path / "wall.obj", points, **sides)
    said = [str(one) for one in error.value.each]
    assert any(words in line for line in said) and "\n" not in "".join(said)
    assert len(said) == 1 or "overlap" not in words  # the dimension of a file not read is unknown


@pytest.mark.parametrize("unit, count", [(1.0, 0), (1e3, 2)])
def test_blocks_far_from_the_spacing_of_their_sets_are_named(unit, count, tmp_path, scene_of):
    """As those in millimetres are."""
    solids = [[unit * face for face in faces] for faces in polygons(bricks())]
    write_obj(tmp_path / "wall.obj", solids)
    sets = BED | {"spacing": 0.5}, HEAD | {"spacing": 1.0}
    scene = scene_of(tmp_path / "wall.obj", [[2.3, 0.5, 1.75]], sets)
    found = [line for line in warnings(scene) if "in domain.blocks are about" in line]
    assert len(found) == count and all("667 mm" in x or "1.14e+03 mm" in x for x in found)


@pytest.mark.parametrize("gap, count", [(0.0, 0), (1e-6, 0), (3e-6, 1), (9e-3, 1), (0.02, 0)])
def test_faces_that_were_to_touch_are_named(gap, count, tmp_path, scene_of):
    """Two cubes on a plinth, a crack between them; blocks touch within 1e-6 of 2 m, and a hundredth
    of the smallest block's size may be meant."""
    plinth, right = cube((0, 0, 0), (2, 1, 1)), cube((1 + gap, 0, 1), (1 - gap, 1, 1))
    (tmp_path / "wall.obj").write_text(obj(plinth, cube((0, 0, 1)), right))
    found = warnings(scene_of(tmp_path / "wall.obj", [[0.5, 0.5, 1.5]]))
    near = [line for line in found if "pairs of faces" in line]
    assert len(near) == count
    assert all(f"has 1 pairs of faces up to {gap:.3g} m apart" in line for line in near)
