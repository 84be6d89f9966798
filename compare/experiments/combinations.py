"""Combinations of the values of varied keys, for studies and sweeps."""

from collections.abc import Iterator, Mapping, Sequence
from itertools import product
from typing import Any


def combinations(values: Mapping[str, Sequence[Any]]) -> Iterator[dict[str, Any]]:
    """Yield every combination of the values of some keys, the last key first to change."""
    for one in product(*values.values()):
        yield dict(zip(values, one, strict=True))
