"""Jump operators as stencils: the same matrix, in fewer numbers."""

import numba
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.sparse import csr_matrix

from continuum.space import stencils as formulas
from continuum.space.stencils import ROUND_OFF, distinct, stencils

add_transposed = numba.njit(lambda *arguments: formulas.add_transposed(*arguments))
multiply_stencils = numba.njit(lambda *arguments: formulas.multiply_stencils(*arguments))


def banded(rows: list[dict[int, float]], columns: int) -> csr_matrix:
    """Return the matrix with these rows, each a coefficient for some columns."""
    row = [i for i, entries in enumerate(rows) for _ in entries]
    column = [c for entries in rows for c in entries]
    value = [v for entries in rows for v in entries.values()]
    return csr_matrix((value, (row, column)), (len(rows), columns))


#: Four joints of alike blocks, one of another block, one point without any, two joints again.
ROWS = [
    *[{3 + i: -1.0, 20 + i: 1.0} for i in range(4)],
    {0: 0.5, 9: -2.0, 30: 1.5},
    {},
    *[{10 + i: -1.0, 27 + i: 1.0} for i in range(2)],
]


def test_neighbouring_joints_of_alike_blocks_are_one_stencil():
    """And nothing else is."""
    matrix = stencils(banded(ROWS, 40))
    assert matrix.first.tolist() == [0, 4, 5, 6, 8]
    assert matrix.column.tolist() == [3, 20, 0, 9, 30, 10, 27]
    assert matrix.value.tolist() == [-1.0, 1.0, 0.5, -2.0, 1.5, -1.0, 1.0]


@pytest.mark.parametrize(
    "change", [{3: -1.0, 21: 1.0}, {4: -1.0, 21: 1.1}, {4: -1.0}, {4: -1.0, 21: 1.0, 30: 1.0}]
)
def test_a_stencil_ends_where_anything_differs(change):
    """A column that does not move on, another coefficient, an entry less or more."""
    same = [{3: -1.0, 20: 1.0}, {4: -1.0, 21: 1.0}]
    assert stencils(banded(same, 40)).first.tolist() == [0, 2]
    assert stencils(banded([same[0], change], 40)).first.tolist() == [0, 1, 2]


def test_round_off_does_not_end_a_stencil():
    """Basis functions at nodes are 1 only to round-off, another one for each point."""
    rows = [{3 + i: 1.0 + 1e-15 * i} for i in range(5)]
    assert stencils(banded(rows, 8)).first.size == 2


entries = st.dictionaries(st.integers(0, 19), st.sampled_from([-1.0, 0.25, 1.0]), max_size=4)


@given(st.lists(st.tuples(entries, st.integers(1, 9)), max_size=6))
def test_products_are_those_of_the_matrix(blocks):
    """B x and f + B^T t, whatever the rows; coefficients and numbers have exact products here."""
    rows = [{c + i: v for c, v in e.items()} for e, count in blocks for i in range(count)]
    dense = banded(rows, 40).toarray()
    matrix = stencils(csr_matrix(dense))
    numbers = np.random.default_rng(len(rows))
    x, t, f = (numbers.integers(-99, 99, n).astype(float) for n in (40, len(rows), 40))
    y = np.full(len(rows), np.nan)
    multiply_stencils(*matrix, x, y, 0)
    assert y.tolist() == (dense @ x).tolist()
    expected = f + dense.T @ t
    add_transposed(*matrix, t, f)
    assert f.tolist() == expected.tolist()


def test_points_on_the_same_nodes_are_one():
    """Told by all directions together and but for round-off; kept along the columns."""
    normal = banded([{5: 1.0}, {2: 1.0}, {5: 1.0 + 1e-14}, {5: 1.0}, {5: 0.5}], 8)
    along = banded([{6: 1.0}, {3: 1.0}, {6: 1.0}, {7: 1.0}, {6: 1.0}], 8)
    kept, group = distinct([normal, along])
    assert normal[kept].indices.tolist() == [2, 5, 5, 5]
    assert group[0] == group[2] and len(set(group.tolist())) == kept.size == 4
    for matrix in (normal, along):
        assert np.abs((matrix[kept][group] - matrix).toarray()).max() <= ROUND_OFF


def test_no_points_at_all():
    """A pillar without joints between its blocks."""
    kept, group = distinct([csr_matrix((0, 8))])
    assert kept.size == group.size == 0
    matrix = stencils(csr_matrix((0, 8)))
    multiply_stencils(*matrix, np.zeros(8), np.zeros(0), 0)
    assert matrix.first.tolist() == [0]


def test_products_of_few_rows_by_hand():
    """Rows of two entries, of which no two are alike, then of three, which repeat themselves."""
    rows = [[2, -3, 0, 0, 0], [0, 5, 0, 7, 0], [1, 2, 4, 0, 0], [0, 1, 2, 4, 0], [0, 0, 0, 0, 6]]
    b = stencils(csr_matrix(np.array(rows, dtype=float)))
    assert b.first.tolist() == [0, 1, 2, 4, 5]
    x = np.array([1.0, 10.0, 100.0, 1000.0, 1e4])
    y = np.full(5, np.nan)
    multiply_stencils(*b, x, y, 1)
    assert np.isnan(y[0]) and y[1:].tolist() == [7050.0, 421.0, 4210.0, 6e4]
    multiply_stencils(*b, x, y, 0)
    assert y[0] == -28.0
    f = np.full(5, 0.5)
    add_transposed(*b, np.array([1.0, 2.0, 3.0, 4.0, 5.0]), f)
    assert f.tolist() == [5.5, 17.5, 20.5, 30.5, 30.5]
