"""The joints' law at every quadrature point, and its forces on the freedoms, compiled.

With the jump operators B (freedoms to gap and slip), the weights W and the traction t (normal
compression positive, on the far side), the joints' force on the freedoms is B^T W t(B u).
"""

from continuum.space.sparse import row
from continuum.space.stencils import add_runs, multiply_runs
from joints.energy import friction_work
from joints.jit import inlined
from joints.laws import law_of, normal_traction, spring_traction
from joints.optional import either, given
from joints.shear import cohesion_left, shear_return, shear_strength, shear_traction
from joints.softening import update_opening


@inlined
def load_joints(interfaces, u, v, rate, memory, state, dt):
    """Set the traction (Pa) at every point of the joints, and what the points remember.

    Where there are dashpots it is the springs' part, and theirs is kept apart.
    """
    if interfaces is not None:
        jumps = state.jumps
        measure(interfaces.runs, u, v, rate, jumps)
        for q in range(interfaces.area.size):
            law = law_of(interfaces.law, q)
            gap = prestressed(interfaces.prestress, law, jumps.gap[q])
            gap_rate = at(jumps.gap_rate, q)
            opening = opened(memory.opening, gap, q)
            t_n = normal_traction(law, gap, gap_rate, opening)
            spring = spring_traction(law, gap, opening)
            keep_dashpot(state.tractions.drag_n, q, t_n - spring)
            state.tractions.normal[q] = given_or(state.tractions.drag_n, spring, t_n)
            load_shear(law.shear_stiffness, interfaces, law, state, dt, q, t_n, gap)


@inlined
def measure(runs, u, v, rate, jumps):
    """Set the jumps of all points that the law asks for."""
    opening, slip_x, slip_z = runs
    multiply_runs(opening, u, jumps.gap)
    measure_one(jumps.x, slip_x, u)
    measure_one(jumps.z, slip_z, u)
    measure_one(jumps.gap_rate, opening, rate)
    measure_one(jumps.rate_x, slip_x, rate)
    measure_one(jumps.rate_z, slip_z, rate)
    measure_one(jumps.way_x, slip_x, v)
    measure_one(jumps.way_z, slip_z, v)


@inlined
def measure_one(jump, runs, x):
    """Set one kind of jump, where anything asks for it."""
    if jump is not None:
        multiply_runs(runs, x, jump)


@inlined
def load_shear(stiffness, interfaces, law, state, dt, q, t_n, gap):
    """Set the shear traction of point q, where there is shear."""
    if stiffness is not None:
        memory, tractions, jumps = state.memory, state.tractions, state.jumps
        opening = given(memory.opening, at(memory.opening, q))
        cohesion = given(memory.cohesion, at(memory.cohesion, q))
        tau = shear_strength(law, t_n, gap, opening, cohesion)
        x = less_slide(memory.slide_x, at(jumps.x, q), q)
        z = less_slide(memory.slide_z, at(jumps.z, q), q)
        rates = at(jumps.rate_x, q), at(jumps.rate_z, q)
        turn = either(tau, stick, slide)
        t_x, t_z, ex, ez = turn(
            interfaces, law, state, dt, q, x, z, rates[0], rates[1], tau, cohesion
        )
        spring_x, spring_z = -law.shear_stiffness * ex, -law.shear_stiffness * ez
        keep_dashpot(tractions.drag_x, q, t_x - spring_x)
        keep_dashpot(tractions.drag_z, q, t_z - spring_z)
        keep_spring(tractions.x, tractions.drag_x, q, spring_x, t_x)
        keep_spring(tractions.z, tractions.drag_z, q, spring_z, t_z)


@inlined
def stick(interfaces, law, state, dt, q, x, z, rate_x, rate_z, tau, cohesion):
    """Return the shear traction where nothing limits it, and its elastic slip."""
    t_x, t_z = shear_traction(law, x, z, rate_x, rate_z)
    return t_x, t_z, x, z


@inlined
def slide(interfaces, law, state, dt, q, x, z, rate_x, rate_z, tau, cohesion):
    """Return the shear traction up to the strength and its elastic slip; remember what slid."""
    memory = state.memory
    dx, dz = dt * at(state.jumps.way_x, q), dt * at(state.jumps.way_z, q)
    old_x, old_z = x - dx, z - dz
    t_x, t_z, ex, ez, slipped = shear_return(law, x, z, old_x, old_z, rate_x, rate_z, tau, dt)
    if slipped:
        slid(memory.slide_x, q, x - ex)
        slid(memory.slide_z, q, z - ez)
        soften(memory.cohesion, q, law, cohesion)
        work = friction_work(law, old_x, old_z, ex, ez, dx, dz)
        keep_work(state.ledger, interfaces.area[q] * work)
    return t_x, t_z, ex, ez


@inlined
def push(interfaces, tractions, jumps, force, drag):
    """Add the joints' force (N) on every freedom, B^T W t; the dashpots' part to `drag`."""
    if interfaces is not None:
        opening, slip_x, slip_z = interfaces.runs
        area, prestress, pull = interfaces.area, interfaces.prestress, jumps.pull
        push_part(opening, tractions.normal, prestress, area, pull, force)
        push_part(slip_x, tractions.x, None, area, pull, force)
        push_part(slip_z, tractions.z, None, area, pull, force)
        push_part(opening, tractions.drag_n, None, area, pull, drag)
        push_part(slip_x, tractions.drag_x, None, area, pull, drag)
        push_part(slip_z, tractions.drag_z, None, area, pull, drag)


@inlined
def push_part(runs, traction, prestress, area, pull, force):
    """Add one component of the tractions less the prestress, where there is one."""
    if traction is not None:
        for q in range(area.size):
            pull[q] = area[q] * less_prestress(prestress, traction[q])
        add_runs(runs, pull, force)


@inlined
def gap_at(prestress, interfaces, law, u, q):
    """Return the gap (m) of point q: what its prestress has closed is counted."""
    return prestressed(prestress, law, row(interfaces.opening, u, q))


@inlined
def prestressed(prestress, law, gap):
    """Return the gap (m) less what prestress has closed."""
    if prestress is None:
        return gap
    return gap - prestress / law.normal_stiffness


@inlined
def less_prestress(prestress, normal):
    """Return what a traction differs from the prestress, which the rock carries on (Pa)."""
    if prestress is None:
        return normal
    return normal - prestress


@inlined
def elastic_slip(matrix, slide, u, q):
    """Return the elastic part (m) of the slip of point q; zero without such a direction."""
    if matrix is None:
        return 0.0
    return less_slide(slide, row(matrix, u, q), q)


@inlined
def less_slide(slide, slip, q):
    """Return a slip less what has slid."""
    if slide is None:
        return slip
    return slip - slide[q]


@inlined
def rate_at(rate, matrix, q):
    """Return the rate (m/s) of a jump at point q; zero where nothing asks for it."""
    if rate is None or matrix is None:
        return 0.0
    return row(matrix, rate, q)


@inlined
def opened(opening, gap, q):
    """Return the largest opening (m) of point q so far, and remember it; None without softening."""
    if opening is None:
        return None
    opening[q] = update_opening(opening[q], gap)
    return opening[q]


@inlined
def at(values, q):
    """Return the value of point q, zero where there are none."""
    if values is None:
        return 0.0
    return values[q]


@inlined
def given_or(flag, present, absent):
    """Return one number where the flag is anything but None, else the other."""
    if flag is None:
        return absent
    return present


@inlined
def keep_dashpot(drag, q, traction):
    """Keep the dashpot's part of a traction, where there is one."""
    if drag is not None:
        drag[q] = traction


@inlined
def keep_spring(traction, drag, q, spring, whole):
    """Keep the springs' part of a traction, the whole of it where there is no dashpot."""
    if traction is not None:
        traction[q] = given_or(drag, spring, whole)


@inlined
def slid(slide, q, more):
    """Add to what point q has slid, m."""
    if slide is not None:
        slide[q] += more


@inlined
def soften(cohesions, q, law, cohesion):
    """Keep the cohesion that slip leaves to point q."""
    if cohesions is not None:
        cohesions[q] = cohesion_left(law, cohesion, True)


@inlined
def keep_work(ledger, work):
    """Add the work (J) of sliding to the ledger."""
    if ledger is not None:
        ledger[1] += work
