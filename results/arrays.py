"""Nested tuples and lists of arrays, with None for absent parts: models, states and samples."""

from collections.abc import Iterator
from typing import Any

import numpy as np

NESTED = tuple, list  # a constant: implicit runs test for these types in every iteration


def arrays(parts: Any) -> Iterator[np.ndarray]:
    """Yield all arrays of nested tuples and lists, in order; skip other entries."""
    for part in parts if isinstance(parts, NESTED) else (parts,):
        if isinstance(part, np.ndarray):
            yield part
        elif isinstance(part, NESTED):
            yield from arrays(part)


def copied(parts: Any) -> Any:
    """Return nested tuples with copies of all arrays."""
    if isinstance(parts, tuple):
        found = map(copied, parts)
        return type(parts)(*found) if hasattr(parts, "_fields") else tuple(found)
    return np.copy(parts) if isinstance(parts, np.ndarray) else parts


def fill(parts: Any, values: Any) -> None:
    """Copy the arrays of `values` into those of `parts`, of the same number and shapes."""
    for own, given in zip(arrays(parts), arrays(values), strict=True):
        own[...] = given


def size_of(*parts: Any) -> int:
    """Return the bytes of all arrays in nested tuples and lists."""
    return sum(array.nbytes for array in arrays(parts))
