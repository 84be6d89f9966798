"""A sparse matrix times the values of some blocks side by side in vector registers.

A loop over lanes that the compiler vectorises by itself loads and stores the sum for every few
products, and checks each time that arrays do not overlap. Here the sums of a row stay in registers
until it is complete; what is done is the same, lane by lane, on every machine.
"""

from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic

WIDTH = 8  # numbers in the widest register there is, 512 bits; narrower ones take several
REGISTERS = 5  # at most, side by side: with the products as many as a machine has

DOUBLE, INDEX = ir.DoubleType(), ir.IntType(32)
LONG = ir.IntType(64)


@intrinsic
def multiply_tile(typing, start, column, value, x, y, factor, at, width, first, size):
    """Set y = factor K x for the blocks of a tile; no index is checked.

    start, column (uint32), value : CSR, of which K is rows first .. first + size - 1.
    x, y : value i of the tile's blocks is at + i width on. width : 1, or whole registers.
    """
    given = (start, column, value, x, y, types.float64, *4 * [types.int64])

    def generate(context, builder, signature, arguments):
        *arrays, factor, at, width, first, size = arguments
        data = [
            context.make_array(kind)(context, builder, array).data
            for kind, array in zip(signature.args, arrays, strict=False)
        ]
        for lanes in (1, *(WIDTH * n for n in range(1, 1 + REGISTERS))):
            with builder.if_then(builder.icmp_signed("==", width, LONG(lanes))):
                _rows(builder, lanes, data, factor, at, first, size)
        return context.get_dummy_value()

    return types.none(*given), generate


def _rows(builder, lanes, data, factor, at, first, size):
    """Emit the product of every row with so many lanes: sums of products, each rounded."""
    start, column, value, x, y = data
    register = DOUBLE if lanes == 1 else ir.VectorType(DOUBLE, WIDTH)
    sums = [cgutils.alloca_once(builder, register) for _ in range(max(1, lanes // WIDTH))]
    factors = _in_all_lanes(builder, factor, register)

    def pointers(array, row):
        place = builder.add(at, builder.mul(row, LONG(lanes)))
        begin = builder.bitcast(builder.gep(array, [place]), register.as_pointer())
        return [builder.gep(begin, [LONG(r)]) for r in range(len(sums))]

    def entry(array, k):
        return builder.zext(builder.load(builder.gep(array, [k])), LONG)

    with cgutils.for_range(builder, size) as row:
        i = builder.add(first, row.index)
        for total in sums:
            builder.store(ir.Constant(register, None), total)
        begin, end = entry(start, i), entry(start, builder.add(i, LONG(1)))
        with cgutils.for_range_slice(builder, begin, end, LONG(1), LONG) as (k, _):
            number = _in_all_lanes(builder, builder.load(builder.gep(value, [k])), register)
            for total, place in zip(sums, pointers(x, entry(column, k)), strict=True):
                product = builder.fmul(number, builder.load(place, align=8))
                builder.store(builder.fadd(builder.load(total), product), total)
        for total, place in zip(sums, pointers(y, row.index), strict=True):
            builder.store(builder.fmul(factors, builder.load(total)), place, align=8)


def _in_all_lanes(builder, number, register):
    if register is DOUBLE:
        return number
    none = ir.Constant(register, ir.Undefined)
    first = builder.insert_element(none, number, INDEX(0))
    return builder.shuffle_vector(
        first, none, ir.Constant(ir.VectorType(INDEX, WIDTH), WIDTH * [0])
    )
