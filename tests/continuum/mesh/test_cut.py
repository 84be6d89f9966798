"""Cutting four squares around one vertex, by hand."""

import numpy as np
import pytest

from jointwave.continuum.mesh.cut import pieces, split

X = np.array([(x, y) for y in range(3) for x in range(3)], dtype=float)
CELLS = np.array([[0, 1, 3, 4], [1, 2, 4, 5], [3, 4, 6, 7], [4, 5, 7, 8]])
#: The four facets inside, each by its two cells and their local numbers.
LOW, HIGH, LEFT, RIGHT = ((0, 2), (1, 1)), ((2, 2), (3, 1)), ((0, 3), (2, 0)), ((1, 3), (3, 0))


def cut(*facets):
    marked = np.zeros((4, 4), dtype=bool)
    for sides in facets:
        for cell, local in sides:
            marked[cell, local] = True
    return split("quadrilateral", X, CELLS, marked)


@pytest.mark.parametrize(
    ("facets", "vertices", "middle", "parts"),
    [
        ((), 9, 1, 1),
        ((LOW,), 10, 1, 1),  # the middle is the tip of the cut
        ((LOW, HIGH), 12, 2, 2),
        ((LOW, LEFT), 12, 2, 2),  # one corner cell comes off
        ((LOW, HIGH, LEFT), 14, 3, 3),
        ((LOW, HIGH, LEFT, RIGHT), 16, 4, 4),
    ],
)
def test_vertices_are_doubled_where_the_rock_is_cut_through(facets, vertices, middle, parts):
    x, cells = cut(*facets)
    assert len(x) == vertices == len(np.unique(cells))
    assert (x == 1).all(axis=1).sum() == middle
    assert (x[cells] == X[CELLS]).all()
    assert len(np.unique(pieces(cells))) == parts


def test_cells_that_touch_at_a_vertex_away_from_the_cut_still_do():
    """Only what lies on a cut may come apart: cells 0 and 3 alone share the middle vertex."""
    x, cells = split("quadrilateral", X, CELLS[[0, 3]], np.zeros((2, 4), dtype=bool))
    assert len(x) == 7
    assert (pieces(cells) == 0).all()


def test_shuffled_cells_are_cut_alike():
    order = np.random.default_rng(0).permutation(4)
    marked = np.zeros((4, 4), dtype=bool)
    for cell, local in (*LOW, *HIGH):
        marked[cell, local] = True
    x, cells = split("quadrilateral", X, CELLS[order], marked[order])
    assert len(x) == 12
    assert (
        pieces(cells)[np.argsort(order)] == pieces(cells)[np.argsort(order)][[0, 1, 0, 1]]
    ).all()
