"""Formulas that kernels share, made from the flags that decide them: numba then compiles them once
in a process, not once a kernel."""

from collections.abc import Callable
from functools import cache, wraps

from jointwave.dem.kernel.model import KernelFlags
from jointwave.joints.law import LawFlags

NO_LAW = LawFlags(*[False] * 13)
NOTHING = KernelFlags(1, False, NO_LAW, *[False] * 6)


def of_blocks(form: KernelFlags) -> KernelFlags:
    """Return the flags that decide how blocks move under given forces, all others off."""
    return form._replace(parts=NO_LAW, points=False, stressed=False, shaken=False, in_row=False)


def of_motion(form: KernelFlags) -> KernelFlags:
    """Return the flags that decide relative motion and its adjoint, all others off."""
    f = form
    return NOTHING._replace(
        dim=f.dim, turns=f.turns, shaken=f.shaken, in_row=f.in_row, finite=f.finite
    )


def of_contacts(form: KernelFlags) -> KernelFlags:
    """Return the flags that decide the forces of contacts, all others off."""
    f = form
    return NOTHING._replace(
        dim=f.dim, turns=f.turns, parts=f.parts, points=f.points, ledger=f.ledger,
        stressed=f.stressed, finite=f.finite,
    )  # fmt: skip


def shared(decisive: Callable[[KernelFlags], KernelFlags]) -> Callable:
    """Return a decorator of a factory of formulas: one result for all kernels whose decisive flags
    agree. The factory is given no others."""

    def decorate(factory: Callable) -> Callable:
        made = cache(factory)
        return wraps(factory)(lambda form: made(decisive(form)))

    return decorate
