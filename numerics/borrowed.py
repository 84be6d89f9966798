"""Arrays that a kernel borrows from its caller: it counts no references to them.

numba counts references to every array, and to every view of one, by atomic operations, and finds
few of them to be needless where loops have branches. The caller of a kernel keeps its arguments.
"""

from typing import Any

from numba import types
from numba.extending import intrinsic


def places_of(kind: Any) -> list[list[int]]:
    """Return where a value of numba's type keeps what counts references, for each of its arrays."""
    if isinstance(kind, types.Array):
        return [[0]]
    parts = kind.types if isinstance(kind, types.BaseTuple) else ()
    return [[k, *place] for k, part in enumerate(parts) for place in places_of(part)]


@intrinsic
def borrowed(typing, values):
    """Return an argument of a kernel, an array or a tuple of such, as a kernel should take it."""
    places = places_of(values)

    def generate(context, builder, signature, arguments):
        found = arguments[0]
        for place in places:
            nothing = builder.extract_value(found, place).type(None)
            found = builder.insert_value(found, nothing, place)
        return found

    return values(values), generate
