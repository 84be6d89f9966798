"""Values of some blocks side by side in registers: the accumulator of the block operator.

A loop over lanes that the compiler vectorises by itself loads and stores the sum for every few
products, and checks each time that arrays do not overlap. A value of type `Lanes(n)` is n
registers of `WIDTH` numbers; what is done to it is the same, lane by lane, on every machine.
"""

from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic, models, register_model

WIDTH = 8  # numbers in the widest register there is, 512 bits; narrower ones take several

REGISTER = ir.VectorType(ir.DoubleType(), WIDTH)
INDEX = ir.IntType(32)


class Lanes(types.Type):
    """n registers of numbers."""

    def __init__(self, n: int):
        self.n = n
        super().__init__(name=f"Lanes({n})")


@register_model(Lanes)
class _Model(models.PrimitiveModel):
    def __init__(self, manager, kind):
        super().__init__(manager, kind, ir.ArrayType(REGISTER, kind.n))


def _broadcast(builder, number):
    none = ir.Constant(REGISTER, ir.Undefined)
    first = builder.insert_element(none, number, ir.Constant(INDEX, 0))
    return builder.shuffle_vector(
        first, none, ir.Constant(ir.VectorType(INDEX, WIDTH), [0] * WIDTH)
    )


def _registers(context, builder, kind, array, index, n):
    """Return pointers to n registers' worth of an array from an index on."""
    data = cgutils.create_struct_proxy(kind)(context, builder, value=array).data
    first = builder.bitcast(builder.gep(data, [index]), REGISTER.as_pointer())
    return [builder.gep(first, [ir.Constant(INDEX, r)]) for r in range(n)]


def _gathered(builder, kind, registers):
    whole = ir.Constant(ir.ArrayType(REGISTER, kind.n), ir.Undefined)
    for r, register in enumerate(registers):
        whole = builder.insert_value(whole, register, r)
    return whole


@intrinsic(prefer_literal=True)
def zero(typing, n):
    """Return n registers of zeros; n is a number that the compiler knows."""
    kind = Lanes(n.literal_value)

    def generate(context, builder, signature, arguments):
        return ir.Constant(ir.ArrayType(REGISTER, kind.n), None)

    return kind(n), generate


@intrinsic
def load(typing, like, x, i):
    """Return x[i], x[i + 1] ... in as many registers as `like` has; i is not checked."""

    def generate(context, builder, signature, arguments):
        _, array, index = arguments
        places = _registers(context, builder, x, array, index, like.n)
        return _gathered(builder, like, [builder.load(p, align=8) for p in places])

    return like(like, x, types.int64), generate


@intrinsic
def store(typing, x, i, lanes):
    """Set x[i], x[i + 1] ... to the lanes; i is not checked."""

    def generate(context, builder, signature, arguments):
        array, index, values = arguments
        for r, place in enumerate(_registers(context, builder, x, array, index, lanes.n)):
            builder.store(builder.extract_value(values, r), place, align=8)
        return context.get_dummy_value()

    return types.none(x, types.int64, lanes), generate


@intrinsic
def add_scaled(typing, lanes, factor, other):
    """Return lanes + factor other; product and sum are rounded, as numbers' are."""

    def generate(context, builder, signature, arguments):
        total, number, increment = arguments
        factors = _broadcast(builder, number)
        parts = []
        for r in range(lanes.n):
            product = builder.fmul(factors, builder.extract_value(increment, r))
            parts.append(builder.fadd(builder.extract_value(total, r), product))
        return _gathered(builder, lanes, parts)

    return lanes(lanes, types.float64, lanes), generate
