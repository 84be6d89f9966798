"""Arrays that a kernel uses without counting its references, which its caller holds all the time.

Every row that is taken out of a counted array costs two atomic operations, more than the work on a
short row.
"""

from numba import types
from numba.core import cgutils
from numba.extending import intrinsic


def _uncounted(context, builder, kind, value):
    if isinstance(kind, types.Array):
        array = context.make_array(kind)(context, builder, value)
        array.meminfo = cgutils.get_null_value(array.meminfo.type)
        array.parent = cgutils.get_null_value(array.parent.type)
        return array._getvalue()
    if isinstance(kind, types.BaseTuple):
        for k, part in enumerate(kind.types):
            found = _uncounted(context, builder, part, builder.extract_value(value, k))
            value = builder.insert_value(value, found, k)
    return value


@intrinsic
def borrowed(typing, value):
    """Return an array, or a tuple with all its arrays, uncounted: only for use while the kernel
    that was given it runs."""

    def generate(context, builder, signature, arguments):
        return _uncounted(context, builder, signature.args[0], arguments[0])

    return value(value), generate
