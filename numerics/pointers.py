"""Pointers to arrays, which compile fastest in kernels: an address and the lengths.

An item of an array takes numba some thirty instructions, which count its references, allow for
negative indices and read its shape; each is typed, lowered, parsed and optimised away again. An
item of a pointer takes two.
"""

import operator
from typing import Any

from llvmlite.ir import ArrayType
from numba import types
from numba.core import cgutils
from numba.core.imputils import lower_getattr
from numba.core.typing.templates import (
    AbstractTemplate,
    AttributeTemplate,
    infer_getattr,
    infer_global,
    signature,
)
from numba.extending import lower_builtin, models, register_model


class Pointer(types.Type):
    """The type of a pointer to a contiguous array of so many dimensions.

    scope : its number among arrays that do not overlap, and their count; None where it may overlap
    any other. Loops over arrays that do not overlap are vectorised without a check of it.
    """

    def __init__(self, dtype: Any, ndim: int, scope: tuple[int, int] | None):
        self.dtype, self.ndim, self.scope = dtype, ndim, scope
        super().__init__(f"pointer({dtype}, {ndim}, {scope})")


@register_model(Pointer)
class PointerModel(models.StructModel):
    """The address of an array, and the lengths of its dimensions."""

    def __init__(self, manager, kind):
        lengths = [(f"length{k}", types.intp) for k in range(kind.ndim)]
        super().__init__(manager, kind, [("data", types.CPointer(kind.dtype)), *lengths])


@infer_getattr
class PointerAttribute(AttributeTemplate):
    """The number of items and the lengths of all dimensions."""

    key = Pointer

    def resolve_size(self, kind):
        """Return its type."""
        return types.intp

    def resolve_shape(self, kind):
        """Return its type."""
        return types.UniTuple(types.intp, kind.ndim)


@lower_getattr(Pointer, "shape")
def shape(context, builder, kind, pointer):
    """Return the lengths of all dimensions."""
    found = types.UniTuple(types.intp, kind.ndim)
    return context.make_tuple(builder, found, _lengths(builder, kind, pointer))


@lower_getattr(Pointer, "size")
def size(context, builder, kind, pointer):
    """Return the number of items."""
    first, *others = _lengths(builder, kind, pointer)
    for one in others:
        first = builder.mul(first, one, flags=["nsw"])
    return first


def _lengths(builder, kind, pointer):
    return [builder.extract_value(pointer, 1 + k) for k in range(kind.ndim)]


def _index_types(kind: Pointer, index: Any) -> Any:
    """Return the types of an index and of the item."""
    if isinstance(index, types.Integer):
        rest = kind.ndim - 1
        return types.intp, Pointer(kind.dtype, rest, kind.scope) if rest else kind.dtype
    if isinstance(index, types.BaseTuple) and len(index) == kind.ndim:
        return types.UniTuple(types.intp, kind.ndim), kind.dtype
    return None, None


@infer_global(operator.getitem)
class PointerItem(AbstractTemplate):
    """An item is a number, or a pointer to a row."""

    def generic(self, args, kws):
        """Return its signature."""
        if isinstance(args[0], Pointer):
            index, item = _index_types(*args)
            return None if index is None else signature(item, args[0], index)
        return None


@infer_global(operator.setitem)
class PointerSetItem(AbstractTemplate):
    """The typing of an assignment to an item."""

    def generic(self, args, kws):
        """Return its signature."""
        if isinstance(args[0], Pointer):
            index, item = _index_types(*args[:2])
            if item == args[0].dtype:
                return signature(types.none, args[0], index, item)
        return None


def _place(builder, kind, pointer, index):
    """Return the address of an item, for one index or all of them."""
    at = index[0]
    for k in range(1, kind.ndim):
        at = builder.mul(at, builder.extract_value(pointer, 1 + k), flags=["nsw"])
        if k < len(index):
            at = builder.add(at, index[k], flags=["nsw"])
    return builder.gep(builder.extract_value(pointer, 0), [at], inbounds=True)


def _indices(builder, index):
    """Return one index or those of a tuple."""
    return cgutils.unpack_tuple(builder, index) if isinstance(index.type, ArrayType) else [index]


@lower_builtin(operator.getitem, Pointer, types.Any)
def get_item(context, builder, sig, args):
    """Return a number, or a pointer to a row."""
    pointer, index = args
    place = _place(builder, sig.args[0], pointer, _indices(builder, index))
    if not isinstance(sig.return_type, Pointer):
        return _in_scope(builder, sig.args[0], builder.load(place))
    row = cgutils.create_struct_proxy(sig.return_type)(context, builder)
    row.data = place
    for k, length in enumerate(_lengths(builder, sig.args[0], pointer)[1:]):
        setattr(row, f"length{k}", length)
    return row._getvalue()


@lower_builtin(operator.setitem, Pointer, types.Any, types.Any)
def set_item(context, builder, sig, args):
    """Set a number."""
    pointer, index, value = args
    place = _place(builder, sig.args[0], pointer, _indices(builder, index))
    _in_scope(builder, sig.args[0], builder.store(value, place))


def _in_scope(builder, kind, access):
    """Return a load or store that LLVM knows to touch no other array of the same scopes."""
    if kind.scope is not None:
        own, count = kind.scope
        domain = builder.module.add_metadata(["packed arrays"])
        scopes = [builder.module.add_metadata([str(k), domain]) for k in range(count)]
        others = scopes[:own] + scopes[own + 1 :]
        access.set_metadata("alias.scope", builder.module.add_metadata([scopes[own]]))
        access.set_metadata("noalias", builder.module.add_metadata(others))
    return access
