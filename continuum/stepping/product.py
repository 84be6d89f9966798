"""The product of a symmetric matrix with a vector of freedoms, chosen by the matrix's structure.

Equal blocks share one matrix, whose entries are read once for `LANES` blocks. Otherwise the d rows
of a node are multiplied together, with 32-bit indices; of a matrix beyond the cache only the half
on and above the diagonal is read.
"""

from collections.abc import Callable
from functools import cache
from typing import Any, NamedTuple

import numpy as np
from scipy.sparse import bsr_matrix, csr_matrix

from jointwave.joints.formula import formula

LANES = 32  # blocks with interleaved freedoms
LEAST_BLOCKS = 12  # from which a shared matrix is faster
SAME = 1e-12  # difference of the matrices of equal blocks, over the largest entry
CACHE = 8 << 20  # bytes of a matrix from which memory bandwidth limits the product

ROWS, HALF, SHARED = "rows", "half", "shared"


class Table(NamedTuple):
    """A matrix for kernels in CSR form, by rows of nodes or for `SHARED` of freedoms.

    start : int64 [rows + 1]. column : uint32. value : float.
    """

    start: np.ndarray
    column: np.ndarray
    value: np.ndarray


class Product(NamedTuple):
    """A product: kind : ROWS, HALF or SHARED. table : the matrix. place : place of each freedom of
    the body in vectors [freedoms]; other places below `size` are padding."""

    kind: str
    table: Table
    place: np.ndarray
    size: int

    @property
    def stride(self) -> int:
        """Distance of the freedoms of a node in vectors."""
        return stride_of(self.kind)

    def beyond(self, count: int, dim: int) -> np.ndarray:
        """Return the places of `count` more freedoms, `dim` a node, after all others [count]."""
        node, component = np.divmod(np.arange(count), dim)
        tile, lane = np.divmod(node, self.stride)
        return self.size + (tile * dim + component) * self.stride + lane


def stride_of(kind: str) -> int:
    """Return the distance of the freedoms of a node in vectors of a kind of product."""
    return LANES if kind == SHARED else 1


def table_of(matrix: csr_matrix, dim: int) -> Table:
    """Return a matrix by rows of nodes."""
    rows = bsr_matrix(matrix, blocksize=(dim, dim))
    rows.sort_indices()
    return Table(rows.indptr.astype(np.int64), rows.indices.astype(np.uint32), rows.data.ravel())


def product_of(matrix: csr_matrix, dim: int, block: np.ndarray, x: np.ndarray) -> Product:
    """Return the product with a matrix [freedoms, freedoms]; it defines the order of all vectors.

    block : of each node [nodes]. x : [nodes, d], m. Columns beyond the rows are freedoms of other
    processes, which follow in vectors.
    """
    shared = shared_by_blocks(matrix, dim, block, x)
    if shared is not None:
        return shared
    place = np.arange(matrix.shape[0])
    if matrix.nnz * 9 > CACHE:
        half = bsr_matrix(matrix, blocksize=(dim, dim))
        row = np.repeat(np.arange(len(half.indptr) - 1), np.diff(half.indptr))
        upper = half.indices >= row
        start = np.append(0, np.bincount(row[upper], minlength=len(half.indptr) - 1).cumsum())
        table = Table(start, half.indices[upper].astype(np.uint32), half.data[upper].ravel())
        return Product(HALF, table, place, place.size)
    return Product(ROWS, table_of(matrix, dim), place, place.size)


def shared_by_blocks(
    matrix: csr_matrix, dim: int, block: np.ndarray, x: np.ndarray
) -> Product | None:
    """Return the product with a matrix that all blocks share; None if they differ."""
    count, nodes = int(block.max(initial=-1)) + 1, np.bincount(block)
    if count < LEAST_BLOCKS or nodes.min() != nodes.max():
        return None
    corner = np.full((count, x.shape[1]), np.inf)
    np.minimum.at(corner, block, x)
    grid = np.rint((x - corner[block]) / (1e-7 * np.ptp(x, axis=0).max())).astype(np.int64)
    order = np.lexsort((*grid.T, block))
    freedoms = (dim * order[:, None] + np.arange(dim)).ravel()
    own = csr_matrix(matrix[freedoms][:, freedoms])
    own.sum_duplicates()
    m = dim * nodes[0]
    if own.nnz < matrix.nnz:  # another process has a part of some block
        return None
    if np.ptp(np.diff(own.indptr).reshape(count, m), axis=0).any():
        return None
    column = own.indices.reshape(count, -1) - m * np.arange(count)[:, None]
    value = own.data.reshape(count, -1)
    if np.ptp(column, axis=0).any() or np.ptp(value, axis=0).max() > SAME * np.abs(value).max():
        return None
    number, lane = np.divmod(np.arange(count), LANES)
    place = np.empty(matrix.shape[0], dtype=np.int64)
    places = (number[:, None] * m + np.arange(m)) * LANES + lane[:, None]
    place[freedoms] = places.ravel()
    table = in_fours(own.indptr[: m + 1].astype(np.int64), column[0], value[0])
    return Product(SHARED, table, place, (-(-count // LANES)) * m * LANES)


def in_fours(start: np.ndarray, column: np.ndarray, value: np.ndarray) -> Table:
    """Return a matrix with rows padded to multiples of four entries by zeros."""
    count = np.diff(start)
    filled = np.maximum(-(-count // 4), 1) * 4
    first = np.append(0, filled.cumsum())
    at = np.arange(len(column)) + np.repeat(first[:-1] - start[:-1], count)
    columns, values = np.zeros(first[-1], np.uint32), np.zeros(first[-1])
    columns[at], values[at] = column, value
    return Table(first, columns, values)


@cache
def product_for(kind: str, dim: int) -> Callable[..., None]:
    """Return the formula (table, x, product) that sets product = -A x, a force, for this kind."""
    formulas: dict[str, Any] = {ROWS: rows_for, HALF: half_for, SHARED: shared_for}
    return formulas[kind](dim)


def rows_for(dim: int) -> Callable[..., None]:
    """Return the formula for rows of nodes."""
    of_node, plane, space = dim * dim, dim > 1, dim > 2

    @formula
    def rows(table, x, product):
        column, value = table.column, table.value
        for i in range(table.start.size - 1):
            a, b, c = 0.0, 0.0, 0.0
            for k in range(table.start[i], table.start[i + 1]):
                j, p = dim * column[k], of_node * k
                if space:
                    u, v, w = x[j], x[j + 1], x[j + 2]
                    a -= value[p] * u + value[p + 1] * v + value[p + 2] * w
                    b -= value[p + 3] * u + value[p + 4] * v + value[p + 5] * w
                    c -= value[p + 6] * u + value[p + 7] * v + value[p + 8] * w
                elif plane:
                    u, v = x[j], x[j + 1]
                    a -= value[p] * u + value[p + 1] * v
                    b -= value[p + 2] * u + value[p + 3] * v
                else:
                    a -= value[p] * x[j]
            product[dim * i] = a
            if plane:
                product[dim * i + 1] = b
            if space:
                product[dim * i + 2] = c

    return rows


def half_for(dim: int) -> Callable[..., None]:
    """Return the formula for the half on and above the diagonal; rows start with the diagonal."""
    of_node, plane, space = dim * dim, dim > 1, dim > 2

    @formula
    def half(table, x, product):
        column, value = table.column, table.value
        for i in range(product.size):
            product[i] = 0.0
        for i in range(table.start.size - 1):
            first, o = table.start[i], dim * i
            a, b, c, y, z = 0.0, 0.0, 0.0, 0.0, 0.0
            if plane:
                y = x[o + 1]
            if space:
                z = x[o + 2]
            for k in range(first, table.start[i + 1]):
                j, p = dim * column[k], of_node * k
                # The diagonal block acts once: not in its transpose.
                u, v, w = x[o] if k > first else 0.0, y, z
                if k == first:
                    v, w = 0.0, 0.0
                if space:
                    a -= value[p] * x[j] + value[p + 1] * x[j + 1] + value[p + 2] * x[j + 2]
                    b -= value[p + 3] * x[j] + value[p + 4] * x[j + 1] + value[p + 5] * x[j + 2]
                    c -= value[p + 6] * x[j] + value[p + 7] * x[j + 1] + value[p + 8] * x[j + 2]
                    product[j] -= value[p] * u + value[p + 3] * v + value[p + 6] * w
                    product[j + 1] -= value[p + 1] * u + value[p + 4] * v + value[p + 7] * w
                    product[j + 2] -= value[p + 2] * u + value[p + 5] * v + value[p + 8] * w
                elif plane:
                    a -= value[p] * x[j] + value[p + 1] * x[j + 1]
                    b -= value[p + 2] * x[j] + value[p + 3] * x[j + 1]
                    product[j] -= value[p] * u + value[p + 2] * v
                    product[j + 1] -= value[p + 1] * u + value[p + 3] * v
                else:
                    a -= value[p] * x[j]
                    product[j] -= value[p] * u
            product[o] += a
            if plane:
                product[o + 1] += b
            if space:
                product[o + 2] += c

    return half


def shared_for(dim: int) -> Callable[..., None]:
    """Return the formula for a matrix that all blocks share, four entries at a time."""

    @formula
    def shared(table, x, product):
        start, column, value = table.start, table.column, table.value
        m = start.size - 1
        for first in range(0, product.size - m * LANES + 1, m * LANES):
            tile = x[first : first + m * LANES]
            for i in range(m):
                own = product[first + i * LANES : first + (i + 1) * LANES]
                for k in range(start[i], start[i + 1], 4):  # one store for four entries
                    a, b, d, e = value[k], value[k + 1], value[k + 2], value[k + 3]
                    p = tile[np.int64(column[k]) * LANES :]
                    q = tile[np.int64(column[k + 1]) * LANES :]
                    r = tile[np.int64(column[k + 2]) * LANES :]
                    s = tile[np.int64(column[k + 3]) * LANES :]
                    if k == start[i]:
                        for c in range(LANES):
                            own[c] = -((a * p[c] + b * q[c]) + (d * r[c] + e * s[c]))
                    else:
                        for c in range(LANES):
                            own[c] -= (a * p[c] + b * q[c]) + (d * r[c] + e * s[c])

    return shared
