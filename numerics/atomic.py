"""Counters that threads tell each other their progress by, for use in kernels."""

from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic, register_jitable


def _place(context, builder, signature, arguments):
    array = context.make_array(signature.args[0])(context, builder, arguments[0])
    return cgutils.get_item_pointer(
        context, builder, signature.args[0], array, [arguments[1]], wraparound=False
    )


@intrinsic
def peek(typing, counters, i):
    """Return counters[i] (an int64 array), with all that was written before it was set."""

    def generate(context, builder, signature, arguments):
        place = _place(context, builder, signature, arguments)
        return builder.load_atomic(place, "acquire", 8)

    return types.int64(counters, types.intp), generate


@intrinsic
def post(typing, counters, i, value):
    """Set counters[i] to value, after all that was written before."""

    def generate(context, builder, signature, arguments):
        place = _place(context, builder, signature, arguments)
        builder.store_atomic(arguments[2], place, "release", 8)
        return context.get_dummy_value()

    return types.none(counters, types.intp, types.int64), generate


@intrinsic
def give_way(typing):
    """Let another thread have the core."""

    def generate(context, builder, signature, arguments):
        kind = ir.FunctionType(ir.IntType(32), [])
        function = cgutils.get_or_insert_function(builder.module, kind, "sched_yield")
        builder.call(function, [])
        return context.get_dummy_value()

    return types.none(), generate


@register_jitable
def wait_for_all(counters, own, met):
    """Wait until all threads, one a counter, have met once more than `met` times; return how often
    that is. What each wrote before is there for all."""
    post(counters, own, met + 1)
    for other in range(len(counters)):
        while peek(counters, other) <= met:
            give_way()
    return met + 1
