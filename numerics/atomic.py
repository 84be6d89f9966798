"""Atomic counters by which threads share their progress, for use in kernels."""

from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic


def _place(context, builder, signature, arguments):
    counters = cgutils.create_struct_proxy(signature.args[0])(context, builder, arguments[0])
    return builder.gep(counters.data, [arguments[1]], inbounds=True)


@intrinsic
def peek(typing, counters, i):
    """Return counters[i] (int64, contiguous) with acquire semantics: earlier writes are visible."""

    def generate(context, builder, signature, arguments):
        place = _place(context, builder, signature, arguments)
        return builder.load_atomic(place, "acquire", 8)

    return types.int64(counters, types.intp), generate


@intrinsic
def post(typing, counters, i, value):
    """Set counters[i] to value with release semantics, after all earlier writes."""

    def generate(context, builder, signature, arguments):
        place = _place(context, builder, signature, arguments)
        builder.store_atomic(arguments[2], place, "release", 8)
        return context.get_dummy_value()

    return types.none(counters, types.intp, types.int64), generate


@intrinsic
def give_way(typing):
    """Yield the core to another thread."""

    def generate(context, builder, signature, arguments):
        kind = ir.FunctionType(ir.IntType(32), [])
        function = cgutils.get_or_insert_function(builder.module, kind, "sched_yield")
        builder.call(function, [])
        return context.get_dummy_value()

    return types.none(), generate
