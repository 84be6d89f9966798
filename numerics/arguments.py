"""The arguments of a kernel, packed into one.

numba unpacks an array with some sixty instructions: of a kernel with thirty arrays that is more
than its loop. Packed, an argument is a few words in memory: the address and
lengths of an array, a number. What is absent is None and takes no word.
"""

import struct
from collections.abc import Iterator
from functools import cache
from itertools import count
from numbers import Integral
from typing import Any

import numpy as np
from llvmlite.ir import DoubleType, IntType
from numba import types
from numba.core import cgutils
from numba.core.typing.templates import AbstractTemplate, infer_global, signature
from numba.extending import NativeValue, lower_builtin, models, register_model, unbox
from numba.np.numpy_support import from_dtype

from jointwave.numerics.pointers import Pointer

INT = IntType(64)


class PackedType(types.Type):
    """The type of packed arguments: those of its members."""

    def __init__(self, members: tuple):
        self.members = members
        super().__init__(f"packed{members}")

    @property
    def mangling_args(self):
        """A short name for the symbols of compiled code, which have a number of their own."""
        return "packed", ()


@register_model(PackedType)
class PackedModel(models.StructModel):
    """Where the words begin."""

    def __init__(self, manager, kind):
        super().__init__(manager, kind, [("words", types.CPointer(types.intp))])


class Packed:
    """Arguments of a kernel, which takes them out by `unpacked`: None, numbers, contiguous arrays
    and NamedTuples of such. Raises TypeError for anything else.

    distinct : whether no two of the arrays overlap.
    """

    def __init__(self, *values: Any, distinct: bool = False):
        count = _arrays(values)
        scopes = ((k, count) for k in range(count)) if distinct else None
        members, words = _packed(values, scopes)
        self._numba_type_ = packed_type(members)
        self.values, self._words = values, np.array(words, dtype=np.int64)  # alive as long as this
        self.address = self._words.ctypes.data


packed_type = cache(PackedType)  # types take numba longer to make than all else here


@cache
def pointer_to(dtype: str, ndim: int, scope: tuple[int, int] | None) -> Pointer:
    """Return the type of a pointer to such an array."""
    return Pointer(from_dtype(np.dtype(dtype)), ndim, scope)


@cache
def tuple_of(members: tuple, kind: type) -> types.BaseTuple:
    """Return the type of a tuple or NamedTuple."""
    return types.BaseTuple.from_types(members, None if kind is tuple else kind)


def _arrays(values: tuple) -> int:
    """Return how many arrays there are among values, those in tuples included."""
    return sum(
        _arrays(value) if isinstance(value, tuple) else isinstance(value, np.ndarray)
        for value in values
    )


def _packed(values: tuple, scopes: Iterator | None) -> tuple[tuple, list[int]]:
    """Return the types of values and their words; arrays take their scopes in turn."""
    members: list[types.Type] = []
    words: list[int] = []
    for value in values:
        if value is None:
            members.append(types.none)
        elif isinstance(value, np.ndarray):
            if not value.flags.c_contiguous:
                raise TypeError("kernels require contiguous arrays")
            members.append(
                pointer_to(value.dtype.char, value.ndim, next(scopes) if scopes else None)
            )
            words += value.ctypes.data, *value.shape
        elif isinstance(value, tuple):
            within, more = _packed(value, scopes)
            members.append(tuple_of(within, type(value)))
            words += more
        elif isinstance(value, float):
            members.append(types.float64)
            words += struct.unpack("q", struct.pack("d", value))
        elif isinstance(value, bool | np.bool_):
            members.append(types.boolean)
            words.append(int(value))
        elif isinstance(value, Integral):
            members.append(types.int64)
            words.append(int(value))
        else:
            raise TypeError(f"{type(value).__name__} is no argument of kernels")
    return tuple(members), words


@unbox(PackedType)
def _unbox(kind, packed, c):
    address = c.pyapi.object_getattr_string(packed, "address")
    found = cgutils.create_struct_proxy(kind)(c.context, c.builder)
    found.words = c.builder.bitcast(c.pyapi.long_as_voidptr(address), found.words.type)
    c.pyapi.decref(address)
    return NativeValue(found._getvalue())


def unpacked(given: Packed) -> tuple:
    """Return a tuple with the packed arguments; in a kernel, arrays as pointers to them, valid as
    long as those are, and for indices within bounds."""
    return given.values


@infer_global(unpacked)
class Unpacked(AbstractTemplate):
    """The typing of it."""

    def generic(self, args, kws):
        """Return its signature."""
        (packed,) = args
        return signature(types.Tuple(packed.members), packed)


@lower_builtin(unpacked, PackedType)
def unpack(context, builder, sig, args):
    """Return the values of the members."""
    words = cgutils.create_struct_proxy(sig.args[0])(context, builder, args[0]).words
    return _value(context, builder, sig.return_type, _loaded(builder, words))


def _loaded(builder, words) -> Iterator[Any]:
    """Yield one word after the other."""
    for k in count():
        yield builder.load(builder.gep(words, [INT(k)], inbounds=True))


def _value(context, builder, kind, words) -> Any:
    """Return a value of a type from its words."""
    if isinstance(kind, types.BaseTuple):
        parts = [_value(context, builder, one, words) for one in kind]
        return context.make_tuple(builder, kind, parts)
    if isinstance(kind, Pointer):
        return _pointer(context, builder, kind, words)
    if kind == types.none:
        return context.get_dummy_value()
    if kind == types.float64:
        return builder.bitcast(next(words), DoubleType())
    return context.cast(builder, next(words), types.int64, kind)


def _pointer(context, builder, kind, words):
    pointer = cgutils.create_struct_proxy(kind)(context, builder)
    pointer.data = builder.inttoptr(next(words), pointer.data.type)
    for k in range(kind.ndim):
        setattr(pointer, f"length{k}", next(words))
    return pointer._getvalue()
