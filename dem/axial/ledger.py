"""What a step books: the work of every force that no potential gives.

The work of a force from one whole step to the next is the mean of its two values times the way.
With the kinetic energy m v[n-1/2] v[n+1/2] / 2 the sum is then exact at a step of any length.
"""

from joints.laws import spring_traction
from numerics.jit import inlined


@inlined
def book_dashpot(ledger, j, area, t, law, gap, opening, half_way):
    """Add a dashpot's work over the last half steps."""
    if ledger is not None:
        _book_dashpot(ledger.dashpots, ledger.viscous, j, area, t, law, gap, opening, half_way)


@inlined
def _book_dashpot(dashpots, viscous, j, area, t, law, gap, opening, half_way):
    if dashpots is not None:
        f = area * (t - spring_traction(law, gap, opening))
        viscous[j] -= (dashpots[j] + f) * half_way
        dashpots[j] = f


@inlined
def book_damping(chain, ledger, j, v, v_new, force):
    """Add the work of what damps block j itself, by what is missing in its momentum.

    Such a force is known only once the block has moved, so its half step behind the whole step is
    booked apart and added by the next step.
    """
    if ledger is not None:
        _book_damping(ledger.behind, ledger.viscous, chain, j, v, v_new, force)


@inlined
def _book_damping(behind, viscous, chain, j, v, v_new, force):
    if behind is not None:
        half_impulse = 0.5 * (chain.mass * (v_new - v) - chain.dt * force)
        viscous[j] -= behind[j] + half_impulse * v
        behind[j] = half_impulse * v_new


@inlined
def book_ends(chain, ledger, reactions, load, v_start, v_end, before):
    """Add the work done on both ends, by the load, by a prestress and by a shaken base.

    v_start, v_end : the end blocks' velocities in the last half steps; before : the outward way
    of the base in the last step. What the base does beyond pushing the block is left in the end.
    """
    if ledger is not None:
        f, sums, half = ledger.forces, ledger.sums, 0.5 * chain.dt
        sums[0] += half * ((f[1] + reactions[1]) * v_end - (f[0] + reactions[0]) * v_start)
        sums[1] += half * (f[2] + load) * v_start
        _book_prestress(chain.steady, sums, chain.dt, v_start, v_end)
        _book_base(before, sums, f[0] + reactions[0])
        f[0], f[1], f[2] = reactions[0], reactions[1], load


@inlined
def _book_prestress(steady, sums, dt, v_start, v_end):
    if steady is not None:
        sums[1] += dt * (steady[0] * v_start - steady[1] * v_end)


@inlined
def _book_base(before, sums, twice_reaction):
    if before is not None:
        work = -0.5 * twice_reaction * before
        sums[0] += work
        sums[1] += work
