"""The jump operators of joints: exact for what elements can represent, blind to numbering."""

import numpy as np
import pytest

from jointwave.continuum.mesh.description import Mesh
from jointwave.continuum.space.body import Body
from jointwave.continuum.space.interface import jumps

CELLS = [
    *[(dim, "hexahedron", order) for dim in (1, 2, 3) for order in (1, 2, 3, 4)],
    *[(dim, "simplex", order) for dim in (2, 3) for order in (1, 2)],
]
cells = pytest.mark.parametrize(("dim", "cell", "order"), CELLS)
BLOCKS = 3


def block_of_nodes(body: Body) -> np.ndarray:
    """Return which copy each node belongs to, of a mesh of one part or of parts that stand once."""
    if len(body.mesh.parts) == 1:
        return np.repeat(np.arange(BLOCKS), len(body.x) // BLOCKS)
    inside = np.array([len(part.cells) for part in body.mesh.parts])
    found = np.empty(len(body.x), dtype=int)
    found[body.cells] = np.repeat(np.arange(BLOCKS), inside)[:, None]
    return found


def displaced(body: Body, motion) -> np.ndarray:
    """Return the freedoms of a displacement: motion(block, x) gives [n, components], m."""
    u = np.zeros(body.mass.size)
    found = motion(block_of_nodes(body), body.x)
    for c in range(body.section.components):
        u[body.freedom(np.arange(len(body.x)), c)] = found[:, c]
    return u


def polynomials(dim: int, components: int, order: int):
    """Return a motion: in each block another polynomial of this degree, in all coordinates."""
    random = np.random.default_rng(3)
    shift = random.normal(size=(BLOCKS, components))
    slope = random.normal(size=(BLOCKS, dim, components))
    bend = random.normal(size=(BLOCKS, dim, components))

    def motion(block, x):
        linear = np.einsum("nd,ndc->nc", x, slope[block])
        return shift[block] + linear + np.einsum("nd,ndc->nc", x**order, bend[block])

    return motion


def measured(body: Body, u: np.ndarray) -> np.ndarray:
    """Return the jumps [q, directions] at all points: the gap, then slips along x and z."""
    at = jumps(body)
    return np.stack([b @ u for b in at.matrices], axis=1)


@cells
def test_jump_is_exact_for_any_motion_of_the_elements_own_degree(dim, cell, order, body):
    """Far side less near side, along y, x and z."""
    at = body(dim, cell, order)
    components = at.section.components
    motion, found = polynomials(dim, components, order), jumps(at)
    near, far = (motion(found.joint + side, found.x) for side in (0, 1))
    expected = (far - near)[:, [0] if components == 1 else [1, 0, 2][:components]]
    assert np.abs(measured(at, displaced(at, motion)) - expected).max() < 1e-12


@pytest.mark.parametrize(("dim", "cell", "order"), [c for c in CELLS if c[0] > 1])
def test_jump_across_an_inclined_joint_is_along_its_own_axes(dim, cell, order, body):
    """Planes y = 0.6 x + const: gap along the normal, slip along what is nearest to x and z."""
    slope = np.zeros((dim, dim))
    slope[0, 1] = 0.6
    at = body(dim, cell, order, bent=lambda x: x + x @ slope)
    motion, found = polynomials(dim, dim, order), jumps(at)
    jump = motion(found.joint + 1, found.x) - motion(found.joint, found.x)
    normal, along_x = np.array([[-0.6, 1.0, 0.0], [1.0, 0.6, 0.0]])[:, :dim] / np.hypot(1, 0.6)
    axes = np.stack([normal, along_x, np.array([0, 0, 1.0])[:dim]])[:dim]
    assert np.abs(measured(at, displaced(at, motion)) - jump @ axes.T).max() < 1e-12
    assert not found.flat.any()
    area = np.bincount(found.joint, found.weight)
    assert area == pytest.approx(np.full(2, 0.25 * np.hypot(1, 0.6)), rel=1e-12)


#: Corners of a cell turned in its own frame, without mirroring it.
TURNED = {
    "interval": [0, 1],
    "triangle": [1, 2, 0],
    "quadrilateral": [1, 3, 0, 2],
    "tetrahedron": [1, 2, 0, 3],
    "hexahedron": [0, 4, 1, 5, 2, 6, 3, 7],
}


def shuffled(mesh: Mesh, seed: int = 5) -> Mesh:
    """Return the same mesh with vertices, cells and the pairs of joints in another order.

    Every other cell is turned as well.
    """
    random = np.random.default_rng(seed)
    parts, where, first = [], [], 0
    for part in mesh.parts:
        vertex, cell = random.permutation(len(part.x)), random.permutation(len(part.cells))
        cells = np.argsort(vertex)[part.cells][cell]
        cells[::2] = cells[::2, TURNED[mesh.cell]]
        parts.append(part._replace(x=part.x[vertex], cells=cells, material=part.material[cell]))
        for _ in range(part.copies):
            where.append(first + np.argsort(cell))
            first += cell.size
    to = np.concatenate(where)
    pair, joints = random.permutation(len(mesh.joints.joint)), mesh.joints
    joints = type(joints)(
        joints.joint[pair], to[joints.left[pair]], to[joints.right[pair]], joints.corners[pair]
    )
    sides = {name: side._replace(cell=to[side.cell]) for name, side in mesh.sides.items()}
    return mesh._replace(parts=tuple(parts), joints=joints, sides=sides)


def by_place(body: Body, points: np.ndarray, joint: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the order of points and of freedoms by where they are and what they belong to."""
    node = np.repeat(np.arange(len(body.x)), body.section.components)
    component = np.tile(np.arange(body.section.components), len(body.x))
    place = np.round(body.x / 0.5, 6)
    freedoms = np.lexsort([component, *place[node].T, block_of_nodes(body)[node]])
    order = np.lexsort([*np.round(points / 0.5, 6).T, joint])
    return order, body.freedom(node, component)[freedoms]


@cells
def test_jumps_do_not_depend_on_the_numbering(dim, cell, order, body, rebuilt):
    """Shuffled vertices and facets, turned cells: the same B and W, rows and columns reordered.

    So the side that opens is that towards the far end, whichever cell comes first.
    """
    one = body(dim, cell, order)
    other = rebuilt(one, shuffled(one.mesh))
    entries = []
    for at in (one, other):
        found = jumps(at)
        rows, columns = by_place(at, found.x, found.joint)
        parts = found.matrices
        entries.append(np.stack([part.toarray()[rows][:, columns] for part in parts]))
        entries.append(found.weight[rows])
    assert np.abs(entries[0] - entries[2]).max() < 1e-12
    assert entries[1] == pytest.approx(entries[3], rel=1e-13)
