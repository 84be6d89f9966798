"""Arrays that a kernel borrows from its caller, without counting references.

numba counts references to every array, view, and array in a tuple, wherever a name is set or ends:
half of the code to compile, with atomic operations. The caller keeps its arguments alive.
"""

from typing import Any

from numba import types
from numba.extending import intrinsic, models, register_model

from jointwave.joints.formula import formula


class Borrowed(types.Array):
    """The numba type of an array, and of its views, without counted references."""

    def copy(self, *changed: Any, **named: Any) -> "Borrowed":
        """Return the type of a view, as numba's own arrays do."""
        return lent(super().copy(*changed, **named))


@register_model(Borrowed)
class BorrowedModel(models.ArrayModel):
    """An array as numba stores it, in which it finds nothing to count."""

    def traverse(self, builder: Any) -> list:
        """Return the parts with references: none."""
        return []


def lent(kind: Any) -> Any:
    """Return the type of a value, of whose arrays no references are counted."""
    if isinstance(kind, types.Array):
        layout = kind.dtype, kind.ndim, kind.layout
        return Borrowed(*layout, readonly=not kind.mutable, aligned=kind.aligned)
    if isinstance(kind, types.BaseTuple):
        of = getattr(kind, "instance_class", None)
        return types.BaseTuple.from_types(tuple(map(lent, kind.types)), of)
    return kind


@intrinsic
def _borrowed(typing, values):

    def generate(context, builder, signature, arguments):
        return arguments[0]  # is stored alike

    return lent(values)(values), generate


@formula  # the name of an intrinsic differs in every process, see `denormals`
def borrowed(values):
    """Return an array, or a nested tuple of arrays, without counted references."""
    return _borrowed(values)
