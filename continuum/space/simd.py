"""A sparse matrix times values that lie side by side in vector registers: those of some blocks, or
of the two components of a node.

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
            cgutils.create_struct_proxy(kind)(context, builder, array).data
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


@intrinsic
def multiply_pair(typing, column, value, x, y, factor, at, row, first, last, begin):
    """Return the sums of K x of a pair of rows, by columns x and then y of its blocks of 2 x 2, and
    add factor K x of the transposes of all but the first one, the diagonal, to y.

    column (uint32), value : of blocks first .. last - 1; the values of block k are at begin + 4 (k
    - begin). at : the first value of x and y; row : that of the pair. No index is checked.
    """
    given = (column, value, x, y, types.float64, *5 * [types.uint64])

    def generate(context, builder, signature, arguments):
        *arrays, factor, at, row, first, last, begin = arguments
        column, value, x, y = (
            cgutils.create_struct_proxy(kind)(context, builder, array).data
            for kind, array in zip(signature.args, arrays, strict=False)
        )
        two, four = (ir.VectorType(DOUBLE, n) for n in (2, 4))

        def at_place(array, place, kind):
            return builder.bitcast(builder.gep(array, [place]), kind.as_pointer())

        def lanes(one, *which):
            mask = ir.Constant(ir.VectorType(INDEX, len(which)), list(which))
            return builder.shuffle_vector(one, ir.Constant(one.type, ir.Undefined), mask)

        def block_of(k):
            place = builder.add(begin, builder.shl(builder.sub(k, begin), LONG(2)))
            return builder.load(at_place(value, place, four), align=8)

        here = builder.load(at_place(x, row, two), align=8)
        own = lanes(here, 0, 1, 0, 1)
        factors = ir.Constant(two, ir.Undefined)
        for lane in (0, 1):
            factors = builder.insert_element(factors, factor, INDEX(lane))
        diagonal = builder.fmul(block_of(first), lanes(here, 0, 0, 1, 1))
        sums = cgutils.alloca_once_value(builder, diagonal)
        right = builder.add(first, LONG(1))
        with cgutils.for_range_slice(builder, right, last, LONG(1), LONG) as (k, _):
            place = builder.add(at, builder.zext(builder.load(builder.gep(column, [k])), LONG))
            block = block_of(k)
            moved = builder.load(at_place(x, place, two), align=8)
            product = builder.fmul(block, lanes(moved, 0, 0, 1, 1))
            builder.store(builder.fadd(builder.load(sums), product), sums)
            turned = builder.fmul(block, own)
            turned = builder.fadd(lanes(turned, 0, 2), lanes(turned, 1, 3))
            target = at_place(y, place, two)
            total = builder.fadd(builder.load(target, align=8), builder.fmul(factors, turned))
            builder.store(total, target, align=8)
        found = [builder.extract_element(builder.load(sums), INDEX(n)) for n in range(4)]
        return context.make_tuple(builder, signature.return_type, found)

    return types.UniTuple(types.float64, 4)(*given), generate
