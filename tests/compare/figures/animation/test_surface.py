"""The outside of blocks: no face between cells of one block, every edge once, nothing moved."""

import numpy as np
import pytest

from compare.figures.animation.surface import in_front, seen, solid, surface_of
from results.snapshots import snapshots

X, Y, Z = np.eye(3)


@pytest.mark.parametrize("kind", ["line", "quad", "hexahedron"])
def test_lines_and_sheets_become_boxes_of_the_section(row, kind):
    """Each block is its box from side to side; nodes keep their y and their motion."""
    thin = row(kind=kind, displacement=lambda x: 0.1 * x)
    box = solid(thin, 1.0)
    assert box.kind == "hexahedron" and box.cells.shape == (3, 8)
    for i, cell in enumerate(box.cells):
        corners = box.points[cell]
        assert corners.min(axis=0).tolist() == [-0.5, i, -0.5]
        assert corners.max(axis=0).tolist() == [0.5, i + 1, 0.5]
    assert set(np.unique(box.displacement[1][:, 1])) == set(np.unique(thin.displacement[1][:, 1]))
    same = box.points[:, 1, None] == thin.points[:, 1]
    assert all(
        (box.displacement[1, n, 1] == thin.displacement[1, same[n], 1]).any() for n in (0, -1)
    )


def test_a_box_has_six_faces_turned_outwards_and_twelve_edges(row):
    surface = surface_of(row(count=2))
    assert surface.faces.shape == (12, 4) and surface.edges.shape == (24, 2)
    assert np.bincount(surface.cells).tolist() == [6, 6]
    points = row(count=2).points[surface.faces]
    normals = np.cross(points[:, 1] - points[:, 0], points[:, 2] - points[:, 1])
    middle = np.array([[0.0, 0.5 + c, 0.0] for c in surface.cells])
    assert ((points.mean(axis=1) - middle) * normals).sum(axis=1) == pytest.approx(0.5)


def test_cells_of_one_block_have_no_face_and_no_edge_between_them(row):
    """Two boxes that share four nodes: ten faces, and the twelve edges of the longer box in halves,
    but none around its middle."""
    two = row(count=2)
    joined = np.arange(16)
    for node in range(8, 16):
        same = np.flatnonzero((two.points[:8] == two.points[node]).all(axis=1))
        if same.size:
            joined[node] = same[0]
    surface = surface_of(two._replace(cells=joined[two.cells]))
    assert len(surface.faces) == 10 and len(surface.edges) == 4 + 4 + 2 * 4
    across = np.abs(np.diff(two.points[surface.edges], axis=1)[:, 0])
    assert (two.points[surface.edges[across[:, 1] == 0]][:, 0, 1] != 1).all()


def test_inverted_cells_are_turned_over(row):
    """Whichever way round a mesh lists its corners."""
    box = row(count=1)
    mirrored = box._replace(cells=box.cells[:, [0, 3, 2, 1, 4, 7, 6, 5]])
    for s in (box, mirrored):
        surface = surface_of(s)
        front = in_front(surface, seen(s.points, X))
        assert len(front) == 1
        assert (s.points[surface.faces[front[0]], 2] == -0.5).all()  # y right, x up: from -z


def test_flat_cells_are_seen_from_both_sides():
    triangle = snapshots(
        np.zeros(1), np.eye(3)[:, :2], "triangle", [[0, 1, 2]], [0], np.zeros((1, 3, 2)),
        np.zeros((1, 3, 2)),
    )  # fmt: skip
    surface = surface_of(triangle)
    assert len(surface.edges) == 3
    for up in (X, -X):
        assert in_front(surface, seen(triangle.points, up)).tolist() == [0]


def test_a_turned_block_shows_a_second_side_behind_the_first(row):
    """About x, so that the side at its end faces the viewer, at -z."""
    box = row(count=1)
    x, y, z = box.points.T
    turned = np.stack([x, y - 0.1 * z, z + 0.1 * y], axis=1)
    surface = surface_of(box)
    front = in_front(surface, seen(turned, X))
    assert len(front) == 2 and (box.points[surface.faces[front[1]], 2] == -0.5).all()
    assert (box.points[surface.faces[front[0]], 1] == 0).all()


def test_a_tetrahedron_shows_the_side_towards_the_viewer():
    points = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
    cell = snapshots(np.zeros(1), points, "tetra", [range(4)], [0], points[None], points[None])
    surface = surface_of(cell)
    (front,) = in_front(surface, seen(points, X))
    assert (points[surface.faces[front], 2] == 0).all()


@pytest.mark.parametrize("up", [X, Z, (X + Z) / np.sqrt(2)])
def test_the_view_keeps_lengths_and_right_hands(up):
    axes = seen(np.eye(3), up)
    np.testing.assert_allclose(axes @ axes.T, np.eye(3), atol=1e-15)
    assert np.linalg.det(axes) == pytest.approx(1)
    assert seen(Y, up).tolist() == pytest.approx([1, 0, 0])
    assert seen(up, up) == pytest.approx(np.array([0, 1, 0]))
