"""Flushing of denormals, numbers below 2e-308, to zero while kernels run.

Ahead of every wave the motion of discrete blocks, and its square in a ledger or a yield condition,
decays faster than exponentially. Processors handle denormals by slow exceptions.
"""

import platform

from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic

from jointwave.joints.formula import formula

MACHINE = platform.machine().lower()
X86 = MACHINE in ("x86_64", "amd64")
ARM = MACHINE in ("aarch64", "arm64")
FLUSH_X86 = 0x8040  # flush to zero, denormals are zero
FLUSH_ARM = 1 << 24  # flush to zero
CONTROL = ir.IntType(32) if X86 else ir.IntType(64)


def _call(builder, name, result, arguments):
    kind = ir.FunctionType(result, [a.type for a in arguments])
    return builder.call(cgutils.get_or_insert_function(builder.module, kind, name), arguments)


def _read(builder):
    if ARM:
        return _call(builder, "llvm.aarch64.get.fpcr", CONTROL, [])
    place = cgutils.alloca_once(builder, CONTROL)
    _call(
        builder, "llvm.x86.sse.stmxcsr", ir.VoidType(), [builder.bitcast(place, cgutils.voidptr_t)]
    )
    return builder.load(place)


def _write(builder, value):
    if ARM:
        _call(builder, "llvm.aarch64.set.fpcr", ir.VoidType(), [value])
        return
    place = cgutils.alloca_once_value(builder, value)
    _call(
        builder, "llvm.x86.sse.ldmxcsr", ir.VoidType(), [builder.bitcast(place, cgutils.voidptr_t)]
    )


@intrinsic
def _flush(typing):

    def generate(context, builder, signature, arguments):
        if not X86 and not ARM:
            return ir.Constant(ir.IntType(64), 0)
        old = _read(builder)
        _write(builder, builder.or_(old, ir.Constant(CONTROL, FLUSH_X86 if X86 else FLUSH_ARM)))
        return builder.zext(old, ir.IntType(64)) if X86 else old

    return types.int64(), generate


@intrinsic
def _restore(typing, old):

    def generate(context, builder, signature, arguments):
        if X86:
            _write(builder, builder.trunc(arguments[0], CONTROL))
        elif ARM:
            _write(builder, arguments[0])
        return context.get_dummy_value()

    return types.none(types.int64), generate


# The name of an intrinsic differs in every process: numba's cache would never find a kernel that
# closes over one. So kernels call these formulas.
@formula
def flush_denormals():
    """Flush denormals to zero in this thread from now on; return the previous setting."""
    return _flush()


@formula
def restore_denormals(old):
    """Restore this thread's setting from before `flush_denormals`."""
    _restore(old)
