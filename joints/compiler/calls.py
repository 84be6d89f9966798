"""Calls of formulas: what numba needs for any function, and a formula that becomes part of its
caller does not.

numba takes tuples of numbers apart where a function is called, and puts them together inside it;
after each call it looks for an exception. Both were more than a fifth of what LLVM read of a row.
"""

from collections.abc import Callable
from functools import cache
from typing import Any, NamedTuple

from llvmlite import ir
from numba.core import cgutils, types
from numba.core.callconv import RETCODE_OK, CPUCallConv
from numba.core.datamodel.packer import ArgPacker
from numba.core.imputils import fix_returning_optional
from numba.core.types.containers import BaseTuple


class Whole(NamedTuple):
    """The model of an argument that is passed as one value."""

    model: Any

    def get_argument_type(self):
        """Return the type of the value."""
        return self.model.get_value_type()

    def as_argument(self, builder, value):
        """Return what is passed."""
        return value

    def from_argument(self, builder, value):
        """Return what has been passed."""
        return value


class Models(NamedTuple):
    """numba's models of arguments, and tuples of numbers as they are. Others are taken apart, since
    only addresses that are arguments of their own can be known not to overlap."""

    models: Any

    def lookup(self, kind):
        """Return the model of an argument of this type."""
        model = self.models[kind]
        members = kind.types if isinstance(kind, BaseTuple) else ()
        numbers = members and all(isinstance(one, types.Number) for one in members)
        return Whole(model) if numbers else model


@cache
def _packer(models: Any, kinds: tuple) -> ArgPacker:
    return ArgPacker(Models(models), kinds)


class FormulaCall(CPUCallConv):
    """How formulas are called."""

    def _get_arg_packer(self, argtypes):
        return _packer(self.context.data_model_manager, tuple(argtypes))

    def declared(self, module: Any, described: Any) -> Any:
        """Return a formula as a function of an LLVM module."""
        name, kinds = described.mangled_name, described.argtypes
        if name not in module.globals:
            function = ir.Function(module, self.get_function_type(described.restype, kinds), name)
            self.decorate_function(function, described.args, kinds, noalias=described.noalias)
            function.attributes.add("alwaysinline" if described.inline else "noinline")
        return module.globals[name]


def alloca(builder: Any, kind: Any, name: str = "") -> Any:
    """Return a place of this type for a value that is written before it is read."""
    with builder.goto_entry_block():
        return builder.alloca(kind, name=name)


def calling(described: Any, library: Any, raising: bool) -> Callable:
    """Return numba's implementation of a call: the code of the formula that is described so."""
    kinds = tuple(described.argtypes)

    def call(context, builder, signature, arguments):
        convention = FormulaCall(context)
        function, kind = convention.declared(builder.module, described), described.restype
        if raising:
            status, value = convention.call_function(builder, function, kind, kinds, arguments)
            with cgutils.if_unlikely(builder, status.is_error):
                convention.return_status_propagate(builder, status)
            return fix_returning_optional(context, builder, signature, status, value)
        place, nowhere, *_ = function.function_type.args
        result = alloca(builder, place.pointee)
        passed = _packer(context.data_model_manager, kinds).as_arguments(builder, arguments)
        builder.call(function, [result, nowhere(None), *passed])
        return context.get_returned_value(builder, kind, builder.load(result))

    call.libs = (library,)  # type: ignore[attr-defined]
    return call


def raises(function: Any) -> bool:
    """Return whether an LLVM function may return anything but success."""
    ends = (block.terminator for block in function.blocks)
    return any(isinstance(end, ir.Ret) and end.return_value != RETCODE_OK for end in ends)
