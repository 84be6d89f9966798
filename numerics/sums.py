"""Sums over blocks or degrees of freedom."""

from joints.formula import formula


@formula
def total(x, y=None, z=None):
    """Return the sum of all x y z; factors that are None are omitted.

    Four partial sums avoid the latency of a single chain of additions.
    """
    a, b, c, d = 0.0, 0.0, 0.0, 0.0
    whole = x.size - x.size % 4
    for i in range(0, whole, 4):
        a += x[i] * factor(y, i) * factor(z, i)
        b += x[i + 1] * factor(y, i + 1) * factor(z, i + 1)
        c += x[i + 2] * factor(y, i + 2) * factor(z, i + 2)
        d += x[i + 3] * factor(y, i + 3) * factor(z, i + 3)
    for i in range(whole, x.size):
        a += x[i] * factor(y, i) * factor(z, i)
    return (a + b) + (c + d)


@formula
def total_of(x):
    """Return the sum of all x, as `total` does."""
    a, b, c, d = 0.0, 0.0, 0.0, 0.0
    whole = x.size - x.size % 4
    for i in range(0, whole, 4):
        a += x[i]
        b += x[i + 1]
        c += x[i + 2]
        d += x[i + 3]
    for i in range(whole, x.size):
        a += x[i]
    return (a + b) + (c + d)


@formula
def factor(values, i):
    """Return values[i], or 1 if values is None."""
    if values is None:
        return 1.0
    return values[i]
