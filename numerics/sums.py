"""Sums over blocks or degrees of freedom."""

from jointwave.joints.formula import formula


@formula
def total_of(x):
    """Return the sum of all x.

    Four partial sums avoid the latency of a single chain of additions.
    """
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
