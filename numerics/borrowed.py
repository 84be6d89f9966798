"""Arrays that a kernel borrows from its caller: it counts no references to them.

numba counts references to every array, and to every view of one, by atomic operations, and finds
few of them to be needless where loops have branches. The caller of a kernel keeps its arguments.
"""

from typing import Any

from numba import types
from numba.extending import intrinsic, overload


def borrowed(values: Any) -> Any:
    """Return an argument of a kernel, an array or a tuple of some, as a kernel should take it."""
    return values


@intrinsic
def _borrowed(typing, values):
    within = isinstance(values, types.BaseTuple)
    kinds = enumerate(values.types if within else [values])
    places = [[k, 0] if within else [0] for k, kind in kinds if isinstance(kind, types.Array)]

    def generate(context, builder, signature, arguments):
        found = arguments[0]
        for place in places:  # of what counts an array's references
            nothing = builder.extract_value(found, place).type(None)
            found = builder.insert_value(found, nothing, place)
        return found

    return values(values), generate


@overload(borrowed)
def _overloaded(values):
    return lambda values: _borrowed(values)
