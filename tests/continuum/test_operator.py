"""The operator of all blocks: every block gets its own K x, to the last bit, wherever it stands."""

import numba
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.sparse import csr_matrix, random

from jointwave.continuum.space import operator as formulas
from jointwave.continuum.space.operator import (
    layout,
    operator,
    spread,
    without_round_off,
)
from jointwave.numerics.cache_lines import zeros

multiply = numba.njit(lambda *arguments: formulas.multiply(*arguments))
COUNTS = (1, 2, 7, 8, 9, 17, 25, 33, 40, 41, 48, 100)  # every width of a tile, full and not


def symmetric(size: int, seed: int = 0) -> csr_matrix:
    """Return a random positive definite matrix, with some rows that couple to nothing."""
    half = random(size, size, 0.2, random_state=seed)
    return csr_matrix(half @ half.T + csr_matrix(np.diag(np.linspace(0.1, 1.0, size))))


def in_turn(matrix: csr_matrix, x: np.ndarray) -> list[float]:
    """Return K x in Python's numbers, products added in the order of the columns."""
    products = []
    for i in range(matrix.shape[0]):
        total = 0.0
        for k in range(matrix.indptr[i], matrix.indptr[i + 1]):
            total += float(matrix.data[k]) * float(x[matrix.indices[k]])
        products.append(total)
    return products


def places_of(where, sizes, counts):
    """Return for each block its part and the indices of its values."""
    part = np.repeat(np.arange(len(counts)), counts)
    return [(p, where.first[b] + where.stride[b] * np.arange(sizes[p])) for b, p in enumerate(part)]


@settings(max_examples=20)
@given(
    st.lists(st.tuples(st.sampled_from(COUNTS), st.integers(3, 40)), min_size=1, max_size=4),
    st.sampled_from([1.0, -1.0, 0.1]),
)
def test_every_block_gets_its_own_product(parts, factor):
    """Bit by bit that of scalar arithmetic without fused products, whatever else is in the vector;
    what belongs to no block stays zero."""
    counts, sizes = zip(*parts, strict=True)
    matrices = [without_round_off(symmetric(size, p)) for p, size in enumerate(sizes)]
    where = layout(counts, sizes)
    x, y = zeros(where.length), zeros(where.length)
    blocks = places_of(where, sizes, counts)
    numbers = np.random.default_rng(1)
    for _, places in blocks:
        x[places] = numbers.standard_normal(places.size)
    multiply(*operator(where, matrices), x, y, factor)
    left = np.ones(where.length, dtype=bool)
    for p, places in blocks:
        assert y[places].tolist() == [factor * total for total in in_turn(matrices[p], x[places])]
        left[places] = False
    assert not y[left].any()


def test_a_large_block():
    """A thousand rows, and more entries than one row of lanes holds, against scipy.

    |error| <= n eps |K| |x| with n entries in the longest row (Higham, Accuracy and Stability of
    Numerical Algorithms, 2002, section 3.1), for either.
    """
    matrix = without_round_off(symmetric(1000))
    where = layout([5], [1000])
    x, y = spread(where, [np.linspace(-1.0, 2.0, 1000)]), zeros(where.length)
    multiply(*operator(where, [matrix]), x, y, 1.0)
    values = x[where.first[0] + where.stride[0] * np.arange(1000)]
    got = y[where.first[4] + where.stride[4] * np.arange(1000)]
    entries = np.diff(matrix.indptr).max()
    bound = 2 * entries * np.finfo(float).eps * (abs(matrix) @ np.abs(values))
    assert (np.abs(got - matrix @ values) <= bound).all()


def test_round_off_is_told_from_small_entries():
    """By the diagonal: a soft layer's small entries stay, what cancels in stiff rock goes."""
    matrix = np.diag([1.0, 1.0, 1e-20, 1e-20])
    matrix[0, 1] = matrix[1, 0] = 1e-15
    matrix[2, 3] = matrix[3, 2] = -1e-20
    matrix[1, 2] = matrix[2, 1] = 1e-12
    kept = without_round_off(csr_matrix(matrix))
    matrix[0, 1] = matrix[1, 0] = 0.0
    assert (kept.toarray() == matrix).all()
    assert kept.nnz == 8


def test_an_empty_matrix_gives_zero():
    """A part without dashpots among others that have them."""
    where = layout([9, 2], [4, 3])
    viscous = operator(where, [csr_matrix((4, 4)), csr_matrix(np.eye(3))])
    y = np.ones(where.length)
    multiply(*viscous, np.ones(where.length), y, 1.0)
    assert not y[: 4 * 16].any() and (y[4 * 16 :] == 1.0).all()


def test_pairs_of_rows_are_the_same_matrix():
    """The last part, which stands once, in blocks of 2 x 2 of its upper triangle."""
    matrices, counts = [symmetric(6), symmetric(10, 1)], [9, 1]
    numbering = layout(counts, [6, 10])
    x = np.random.default_rng(1).standard_normal(numbering.length)
    found, own = [], slice(numbering.offset[-1], numbering.offset[-1] + 10)
    for paired in (False, True):
        made, y = operator(numbering, matrices, paired), np.full(numbering.length, np.nan)
        multiply(*made, x, y, -2.0)
        found.append(y[own])
        assert (made.pairs is not None) == paired and len(made.tiles) == 2 - paired
    expected = -2.0 * (matrices[1] @ x[own])
    for y in found:
        assert y == pytest.approx(expected, rel=1e-13, abs=1e-13)
