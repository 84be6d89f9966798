"""The energy ledger of a tile: rows of lanes for each term, summed at samples.

The work of a force from one whole step to the next is the mean of its two values times the
displacement. So a force at step n acts over the half step before it and over the one after it,
which are accounted for apart: at a sample only the first half has been done.
"""

from collections.abc import Callable

from dem.spatial.ends import BASE, MEAN, REACTION, STEADY, VELOCITY
from dem.spatial.finite import angular_velocity
from dem.spatial.joints import area_in_contact, at_point, law_at
from dem.spatial.layout import (
    ABOUT_X,
    ABOUT_Z,
    BEFORE,
    DRAG,
    FORCE,
    LEFT,
    MOMENTA,
    NET,
    RELATIVE,
    SLID,
    Form,
    X,
    Y,
    Z,
)
from dem.spatial.layout import LANES as L
from dem.spatial.layout import STRIDE as R
from dem.spatial.motion import FACE, INERTIA, WEIGHT
from joints.dilation import lift
from joints.energy import elastic_energy, fracture_energy_spent
from joints.formula import formula

# Running sums up to the step; AFTER further on what the step adds behind it.
VISCOUS, BOUNDARY, WORK, FRICTION = 0, R, 2 * R, 3 * R
AFTER = 4 * R
# States, filled at samples only.
KINETIC, ROTATION, ELASTIC, FRACTURE, GRAVITY = 7 * R, 8 * R, 9 * R, 10 * R, 11 * R
LEDGER = 12 * R

PLACES = {
    "kinetic": KINETIC,
    "rotation": ROTATION,
    "elastic": ELASTIC,
    "viscous": VISCOUS,
    "friction": FRICTION,
    "fracture": FRACTURE,
    "boundary": BOUNDARY,
    "gravity": GRAVITY,
    "work": WORK,
}


@formula
def close_ledger(ledger, sums, energy, places, sampled, sample):
    """Add the ledger of a step to the running sums, and empty it.

    ledger : float array [LEDGER]. sums : the running sums, [AFTER]. energy : float array
    [term, sample], J, filled where the step is `sampled`. places : of each term.
    """
    for i in range(AFTER):
        sums[i] += ledger[i]
    if sampled:
        for k in range(places.size):
            at, total = places[k], 0.0
            for i in range(at, at + L):  # always in the same order
                total += ledger[i] if at >= KINETIC else sums[i]
            energy[k, sample] = total
    for i in range(FRICTION):
        sums[i] += ledger[AFTER + i]
    ledger[:] = 0.0


def stored_for(form: Form) -> Callable:
    """Return the formula that adds the energy stored in a tile to its ledger."""
    parts, turns, finite, gravity = form.parts, form.turns, form.finite, form.gravity
    by_points, varied, softening = form.points, parts.varied, parts.softening
    first_point, point_rows = form.rate_rows * L, form.point_rows * L
    dilation, paths = parts.dilation, (2 + softening + parts.residual) * L

    @formula
    def add_stored(b, law, table, points, m, h, q, ledger, n, joints):
        """Add what n blocks and their joints store, and what softening has spent.

        q : with the relative motion of the joints at this step.
        """
        if not by_points:
            for k in range(b.freedoms):
                share, g = 0.5 * b.rows[FACE, k], q[RELATIVE + k * R :]
                for i in range(min(joints, L)):
                    if varied:
                        law = law_at(table, i)
                    stiffness = law.normal_stiffness if k % 2 else law.shear_stiffness
                    ledger[ELASTIC + i] += share * stiffness * g[i] * g[i]
        else:
            for p in range(points.shape[1]):
                x, z, whole = points[0, p], points[1, p], points[2, p]
                own = h[first_point + p * point_rows :]
                for i in range(min(joints, L)):
                    if varied:
                        law = law_at(table, i)
                    gap, slip_x, slip_z = at_point(q, RELATIVE + i, x, z, turns, finite)
                    area, opening = whole, 0.0
                    if finite:
                        area = area_in_contact(b, whole, x, z, gap, slip_x, slip_z)
                    if dilation:
                        gap = gap - lift(law, own[paths + i])
                    if softening:
                        opening = own[2 * L + i]
                        ledger[FRACTURE + i] += area * fracture_energy_spent(law, opening)
                    ex, ez = slip_x - own[i], slip_z - own[L + i]
                    ledger[ELASTIC + i] += area * elastic_energy(law, parts, gap, opening, ex, ez)
        if gravity:
            x, y, z = b.rows[WEIGHT, 0], b.rows[WEIGHT, 1], b.rows[WEIGHT, 2]
            for i in range(min(n, L)):
                ledger[GRAVITY + i] -= x * m[X + i] + y * m[Y + i] + z * m[Z + i]

    return add_stored


def work_for(form: Form) -> tuple[Callable, Callable]:
    """Return the formulas that add to the ledger of a tile the work of a step on its blocks, with
    their kinetic energy at a sample, and the work on an end."""
    turns, finite, by_points = form.turns, form.finite, form.points
    dashpots, velocity = form.parts.dashpots, form.freedoms * R
    damped = form.mass_damping or form.local_damping

    @formula
    def net_impulse(b, q, at, n):
        """Leave the impulse of the forces in the rows from `at` on, and their moments about the
        centroids, on n blocks in the step."""
        for k in range(b.freedoms):
            force, impulse = q[at + k * R :], q[NET + k * R :]
            for i in range(min(n, L)):
                impulse[i] = b.dt * (force[i] - force[i + 1])
        force, impulse = q[at:], q[NET:]
        if finite:
            for k in range(3):
                for i in range(k * R, k * R + min(n, L)):
                    impulse[ABOUT_X + i] = b.dt * (force[ABOUT_X + i] + force[LEFT + i + 1])
        elif turns:
            for i in range(min(n, L)):
                x, z = force[X + i] + force[X + i + 1], force[Z + i] + force[Z + i + 1]
                impulse[ABOUT_X + i] -= b.dt * b.arm * z
                impulse[ABOUT_Z + i] += b.dt * b.arm * x

    @formula
    def add_impulse(b, m, q, ledger, n, damping):
        """Add the work of an impulse against the velocities before and after the step.

        damping : of what damps a block itself, which is what its momentum's gain has less than the
        net impulse of everything else; else the net impulse, that of the dashpots.
        """
        for k in range(b.freedoms):
            inertia, weight = b.rows[INERTIA, k], b.dt * b.rows[WEIGHT, k]
            moved, own = m[velocity + k * R :], q[k * R :]
            for i in range(min(n, L)):
                old, new, impulse = own[BEFORE + i], moved[i], own[NET + i]
                if finite and k > 2:
                    new = angular_velocity(b, m, i)[k - 3]
                if damping:
                    gain = inertia * (new - old)
                    if finite and k > 2:
                        gain = moved[i] - own[MOMENTA - ABOUT_X + i]
                    impulse = gain - (impulse + weight)
                ledger[VISCOUS + i] -= 0.5 * impulse * old
                ledger[VISCOUS + AFTER + i] -= 0.5 * impulse * new

    @formula
    def add_work(b, m, q, ledger, n, sampled):
        """Add the work of friction and damping on n blocks, and their kinetic energy."""
        if by_points:
            for i in range(min(n, L)):
                ledger[FRICTION + i] += q[SLID + i]
        if dashpots:
            net_impulse(b, q, DRAG, n)
            add_impulse(b, m, q, ledger, n, False)
        if damped:
            net_impulse(b, q, FORCE, n)
            add_impulse(b, m, q, ledger, n, True)
        if sampled:  # m v[n-1/2] v[n+1/2] / 2, the form that leapfrog conserves
            for k in range(b.freedoms):
                inertia = 0.5 if finite and k > 2 else 0.5 * b.rows[INERTIA, k]
                energy = ledger[KINETIC if k < 3 else ROTATION :]
                old, new = q[BEFORE + k * R :], m[velocity + k * R :]
                for i in range(min(n, L)):
                    energy[i] += inertia * (old[i] * new[i])

    @formula
    def add_end_work(b, end, state, ledger, factor, load, moved, moving):
        """Add the work of a step on an end, of what acts there all the time, and of factor times
        the load at the same face, whose base moves by `moved` and `moving` (m) in the half steps.

        state : with the face's velocities before and after the step. What the wall of a base takes
        is less by its work.
        """
        for k in range(b.freedoms):
            given = 0.5 * b.dt * (factor * load[k] + end[STEADY, k])
            taken = 0.5 * b.dt * state[REACTION, k]
            base = 0.5 * state[REACTION, k] * end[BASE, k]
            before, after = state[VELOCITY, k], state[MEAN, k]
            ledger[WORK] += given * before + base * moved
            ledger[WORK + AFTER] += given * after + base * moving
            ledger[BOUNDARY] += base * moved - taken * before
            ledger[BOUNDARY + AFTER] += base * moving - taken * after

    return add_work, add_end_work
