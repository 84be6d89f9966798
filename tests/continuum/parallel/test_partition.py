"""Dealing out the cells of a mesh: all of them, each once, in stretches along the pillar."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.sparse import coo_matrix, csr_matrix, diags, identity, kron

from jointwave.cases.errors import SceneError
from jointwave.continuum.mesh.description import Joints, Mesh, Part
from jointwave.continuum.parallel.graph import halved
from jointwave.continuum.parallel.partition import WHOLE, copies_of, ranks_of_cells, restrict


def bar(counts: list[tuple[int, int]]) -> Mesh:
    """Return a bar of parts with so many cells and copies, 1 m long each, joints between all."""
    parts, places = [], np.random.default_rng(0).permutation(sum(c for _, c in counts))
    for cells, copies in counts:
        vertex = np.arange(cells + 1)
        shifts, places = places[:copies, None].astype(float), places[copies:]
        ends = np.stack([vertex[:-1], vertex[1:]], axis=1)
        parts.append(Part(vertex[:, None] / cells, ends, np.zeros(cells, dtype=np.int64), shifts))
    first = copies_of(Mesh("interval", tuple(parts), (), None, {}))
    begin = np.concatenate([p.shifts[:, 0] for p in parts])
    order = np.argsort(begin)
    last = (first.first + first.cells - 1)[order][:-1]
    right = first.first[order][1:]
    corners = begin[order][1:, None, None]
    joints = Joints(np.arange(len(last)), last, right, corners)
    return Mesh("interval", tuple(parts), (), joints, {})


some_parts = st.lists(st.tuples(st.integers(1, 40), st.integers(1, 12)), min_size=1, max_size=4)


@given(counts=some_parts, size=st.integers(1, 9))
def test_every_cell_and_every_joint_belongs_to_one_process(counts, size):
    """What all processes hold of their own is the whole mesh; ghosts lie beyond own joints."""
    mesh = bar(counts)
    total = sum(cells * copies for cells, copies in counts)
    if size > total:
        with pytest.raises(SceneError, match=f"at most {total}"):
            ranks_of_cells(mesh, size)
        return
    rank_of = ranks_of_cells(mesh, size)
    shares = [restrict(mesh, rank_of, rank) for rank in range(size)]
    own = np.concatenate([share.cell[~share.ghost] for share in shares])
    assert np.sort(own).tolist() == list(range(total))
    joints = np.concatenate([share.joints.joint for share in shares])
    assert np.sort(joints).tolist() == mesh.joints.joint.tolist()
    for rank, share in enumerate(shares):
        assert np.unique(share.cell).size == share.cell.size
        assert (rank_of[share.joints.left] == rank).all()
        beyond = share.joints.right[rank_of[share.joints.right] != rank]
        assert set(share.cell[share.ghost]) == set(beyond)


@given(counts=some_parts, size=st.integers(1, 9))
def test_processes_follow_one_another_along_the_pillar_with_equal_loads(counts, size):
    """Nobody has more than its share by more than the copies that stay whole at both its ends."""
    mesh = bar(counts)
    total = sum(cells * copies for cells, copies in counts)
    size = min(size, total)
    rank_of = ranks_of_cells(mesh, size)
    copies = copies_of(mesh)
    middle = np.concatenate([(p.x[p.cells, 0].mean(1) + p.shifts).ravel() for p in mesh.parts])
    assert (np.diff(rank_of[np.argsort(middle)]) >= 0).all()
    share = total / size
    small = copies.cells[copies.cells <= WHOLE * share].max(initial=1)
    assert np.abs(np.bincount(rank_of, minlength=size) - share).max() <= max(small, 1)
    for first, cells in zip(copies.first, copies.cells, strict=True):
        if cells <= WHOLE * share:
            assert np.ptp(rank_of[first : first + cells]) == 0


def grid(width: int, height: int) -> csr_matrix:
    """Return the graph of a grid of squares, row by row, each joined to its neighbours."""
    across, up = (diags(np.ones(n - 1), 1, (n, n)) for n in (width, height))
    half = kron(identity(height), across) + kron(up, identity(width))
    return csr_matrix(half + half.T)


def cut_edges(graph: csr_matrix, part: np.ndarray) -> int:
    """Return how many edges join vertices of different parts."""
    edges = coo_matrix(graph)
    return int((part[edges.row] != part[edges.col]).sum()) // 2


@given(width=st.integers(1, 25), height=st.integers(1, 25), size=st.integers(1, 7))
def test_a_graph_is_halved_into_equal_parts_with_short_borders(width, height, size):
    """Parts differ by a vertex for each time that they were halved; of an oblong grid the border of
    two is no longer than a few rows."""
    graph, weight = grid(width, height), np.ones(width * height)
    size = min(size, width * height)
    part = halved(graph, weight, size)
    counts = np.bincount(part, minlength=size)
    assert counts.min() > 0 and np.ptp(counts) <= 1 + np.log2(size)
    if size == 2:
        assert cut_edges(graph, part) <= 2 * min(width, height) + 1
