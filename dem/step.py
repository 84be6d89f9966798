"""The compiled loop: leapfrog steps of a chain of rigid blocks.

One pass over the blocks does force and motion together: the force of joint j is computed from
blocks j and j + 1 before block j moves, so no array of forces is needed. Displacements live at
whole steps, velocities half a step before; dashpots see the gap rate extrapolated to the whole
step, which keeps second order.
"""

from dem.ends import advance_end, reaction
from joints.jit import jitted
from joints.laws import law_of, normal_traction, spring_traction


@jitted
def march(model, state, first, last):
    """Take steps first .. last - 1, each from u[n], v[n - 1/2] to u[n + 1], v[n + 1/2]."""
    chain, load = model.chain, model.load
    # Unpacked once: a tuple of arrays read in every step would count its references in every step.
    u, v, gap_rate, start, end, ledger = state
    for n in range(first, last):
        step(chain, u, v, gap_rate, start, end, ledger, load_at(load, n))


@jitted
def step(chain, u, v, gap_rate, start, end, ledger, load):
    """Advance every block by one step under its two joints, the load and the ends."""
    x, dt, tail = chain.impulse_to_speed, chain.dt, u.size - 1
    v_start, v_end = v[0], v[tail]

    push = joint_force(chain, u, v, gap_rate, ledger, 0)
    v[0] = -advance_end(chain.start, start, x, -v[0], push - load)
    u[0] += dt * v[0]
    for j in range(1, tail):
        f = joint_force(chain, u, v, gap_rate, ledger, j)
        v[j] += x * (push - f)
        u[j] += dt * v[j]
        push = f
    v[tail] = advance_end(chain.end, end, x, v[tail], push)
    u[tail] += dt * v[tail]

    book_ends(ledger, start, end, 0.5 * dt, load, v_start, v_end)


@jitted
def load_at(load, n):
    """Return the load (N) of step n; it is zero after the last that acts."""
    return load[n] if n < load.size else 0.0


@jitted
def joint_force(chain, u, v, gap_rate, ledger, j):
    """Return the force (N, compression positive) of joint j and remember its gap rate."""
    law, gap, rate = law_of(chain.law, j), u[j + 1] - u[j], v[j + 1] - v[j]
    t = normal_traction(law, gap, centred(gap_rate, j, rate))
    remember(gap_rate, j, rate)
    book_dashpot(ledger, j, chain.area, t, law, gap, 0.5 * chain.dt * rate)
    return chain.area * t


@jitted
def joint_stress(chain, u, v, gap_rate, j):
    """Return the traction (Pa) of joint j at the present step, and change nothing."""
    rate = centred(gap_rate, j, v[j + 1] - v[j])
    return normal_traction(law_of(chain.law, j), u[j + 1] - u[j], rate)


@jitted
def centred(previous, j, rate):
    """Return the gap rate at the whole step from those half a step and one and a half before."""
    if previous is None:
        return rate
    return 1.5 * rate - 0.5 * previous[j]


@jitted
def remember(previous, j, rate):
    """Keep a gap rate for the next step."""
    if previous is not None:
        previous[j] = rate


@jitted
def book_dashpot(ledger, j, area, t, law, gap, half_way):
    """Add a dashpot's work over the last half steps: the mean of its forces times the way."""
    if ledger is not None:
        _book_dashpot(ledger.dashpots, ledger.sums, j, area * t, area, law, gap, half_way)


@jitted
def _book_dashpot(dashpots, sums, j, force, area, law, gap, half_way):
    if dashpots is not None:
        f = force - area * spring_traction(law, gap)
        sums[0] -= (dashpots[j] + f) * half_way
        dashpots[j] = f


@jitted
def book_ends(ledger, start, end, half_step, load, v_start, v_end):
    """Add the work done on both ends and by the load, as `book_dashpot` does."""
    if ledger is not None:
        f = ledger.forces
        f_start, f_end = reaction(start), reaction(end)
        ledger.sums[1] += half_step * ((f[1] + f_end) * v_end - (f[0] + f_start) * v_start)
        ledger.sums[2] += half_step * (f[2] + load) * v_start
        f[0], f[1], f[2] = f_start, f_end, load
