"""Arrays that a kernel borrows from its caller, without counting references.

numba counts references to every array and view with atomic operations, and removes few of them in
loops with branches. The caller of a kernel keeps its arguments alive.
"""

from typing import Any

from numba import types
from numba.extending import intrinsic


def places_of(kind: Any) -> list[list[int]]:
    """Return the place of the reference counter of each array in a value of this numba type."""
    if isinstance(kind, types.Array):
        return [[0]]
    parts = kind.types if isinstance(kind, types.BaseTuple) else ()
    return [[k, *place] for k, part in enumerate(parts) for place in places_of(part)]


@intrinsic
def borrowed(typing, values):
    """Return an array, or a nested tuple of arrays, without its reference counters."""
    places = places_of(values)

    def generate(context, builder, signature, arguments):
        found = arguments[0]
        for place in places:
            nothing = builder.extract_value(found, place).type(None)
            found = builder.insert_value(found, nothing, place)
        return found

    return values(values), generate
