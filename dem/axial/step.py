"""The compiled loop: leapfrog steps of a chain of rigid blocks.

One pass over the blocks does force and motion together: the force of joint j is computed from
blocks j and j + 1 before block j moves, so no array of forces is needed. Displacements live at
whole steps, velocities half a step before; dashpots see the gap rate extrapolated to the whole
step, which keeps second order.
"""

from dem.axial.ends import advance_end, reaction
from dem.axial.ledger import book_dashpot, book_ends
from dem.axial.motion import advanced, steady_at, weighed
from joints.laws import law_of, normal_traction, update_opening
from joints.softening import is_broken
from numerics.jit import inlined, jitted


@jitted
def march(model, state, first, last):
    """Take steps first .. last - 1, each from u[n], v[n - 1/2] to u[n + 1], v[n + 1/2]."""
    chain, load, base = model.chain, model.load, model.base
    # Unpacked once: a tuple of arrays read in every step would count its references in every step.
    u, v, gap_rate, opening, broke, start, end, ledger = state
    for n in range(first, last):
        p, before, after = load_at(load, n), way_at(base, n), way_at(base, n + 1)
        step(chain, u, v, gap_rate, opening, broke, start, end, ledger, n, p, before, after)


@inlined
def step(chain, u, v, gap_rate, opening, broke, start, end, ledger, n, load, before, after):
    """Advance every block by step n under its joints, its weight, the load and the ends."""
    dt, weight, tail = chain.dt, chain.weight, u.size - 1
    v_start, v_end = v[0], v[tail]

    push = joint_force(chain, u, v, gap_rate, opening, broke, ledger, n, 0)
    outward = push - weighed(weight, load + steady_at(chain.steady, 0))
    v[0] = -advance_end(chain, ledger, chain.start, start, 0, -v[0], outward, before, after)
    u[0] += dt * v[0]
    for j in range(1, tail):
        f = joint_force(chain, u, v, gap_rate, opening, broke, ledger, n, j)
        v[j] = advanced(chain, ledger, j, v[j], weighed(weight, push - f))
        u[j] += dt * v[j]
        push = f
    outward = weighed(weight, push - steady_at(chain.steady, 1))
    v[tail] = advance_end(chain, ledger, chain.end, end, tail, v[tail], outward, None, None)
    u[tail] += dt * v[tail]

    book_ends(chain, ledger, (reaction(start), reaction(end)), load, v_start, v_end, before)


@inlined
def load_at(load, n):
    """Return the load (N) of step n; it is zero after the last that acts."""
    return load[n] if n < load.size else 0.0


@inlined
def way_at(base, n):
    """Return the way (m) of a shaken base in step n - 1; None where no base is shaken."""
    if base is None:
        return None
    return base[n] if n < base.size else 0.0


@jitted
def joint_force(chain, u, v, gap_rate, opening, broke, ledger, n, j):
    """Return the force (N, compression positive) of joint j at step n, and let it remember."""
    law, gap, rate = law_of(chain.law, j), u[j + 1] - u[j], v[j + 1] - v[j]
    k = opened(opening, j, gap)
    t = normal_traction(law, gap, centred(gap_rate, j, rate), k)
    remember(gap_rate, j, rate)
    remember(opening, j, k)
    note_break(broke, law, k, n, j)
    book_dashpot(ledger, j, chain.area, t, law, gap, k, 0.5 * chain.dt * rate)
    return chain.area * t


@inlined
def joint_stress(chain, u, v, gap_rate, opening, j):
    """Return the traction (Pa) of joint j at the present step, and change nothing."""
    gap, rate = u[j + 1] - u[j], centred(gap_rate, j, v[j + 1] - v[j])
    return normal_traction(law_of(chain.law, j), gap, rate, opened(opening, j, gap))


@inlined
def opened(opening, j, gap):
    """Return the largest gap (m) of joint j so far, this one included; None without softening."""
    if opening is None:
        return None
    return update_opening(opening[j], gap)


@inlined
def centred(previous, j, rate):
    """Return the gap rate at the whole step from those half a step and one and a half before."""
    if previous is None:
        return rate
    return 1.5 * rate - 0.5 * previous[j]


@inlined
def remember(values, j, value):
    """Keep a joint's value for the next step, where there is a place for it."""
    if values is not None:
        values[j] = value


@inlined
def note_break(broke, law, opening, n, j):
    """Keep the step at which joint j has lost its tensile strength."""
    if broke is not None and broke[j] < 0 and is_broken(law, opening):
        broke[j] = n
