"""The joint law at the quadrature points: forces of the joints, their tangents, their energy.

All arrays of points are [directions, q]: the normal first, then along x and z. Arrays of effects
that the law does not have are None. With the jump operator B (displacements to jumps), the areas W
and the traction t (compression positive, on the far side) the force on the freedoms is B^T W t.
"""

from jointwave.joints.dilation import lift
from jointwave.joints.energy import elastic_energy, fracture_energy_spent
from jointwave.joints.formula import formula
from jointwave.joints.law import History, law_of, traction
from jointwave.joints.normal import gap_under
from jointwave.joints.tangent import tangent

#: Rows of the tangents: t_n with the gap; t_x, t_z with it; t_x with x, either with the other, t_z
#: with z; and, where slip lifts the faces, t_n with x and with z.
NN, XN, ZN, XX, XZ, ZZ, NX, NZ = range(8)


@formula
def at_point(directions, values, q):
    """Return the components (n, x, z) at a point, 0 for those that are absent."""
    n, x, z = 0.0, 0.0, 0.0
    if values is not None:
        n = values[0, q]
        if directions > 1:
            x = values[1, q]
        if directions > 2:
            z = values[2, q]
    return n, x, z


@formula
def history_at(directions, opening, slide, cohesion, path, q):
    """Return the `History` of a point."""
    widest, x, z, left, slid = 0.0, 0.0, 0.0, 0.0, 0.0
    if opening is not None:
        widest = opening[q]
    if slide is not None:
        x = slide[0, q]
        if directions > 2:
            z = slide[1, q]
    if cohesion is not None:
        left = cohesion[q]
    if path is not None:
        slid = path[q]
    return History(widest, x, z, left, slid)


@formula
def whole_jump(law, parts, directions, prestress, jump, q):
    """Return gap and slip of a point (m), with the gap that the prestress has made."""
    n, x, z = at_point(directions, jump, q)
    if prestress is not None:
        n += gap_under(law, parts, prestress[0, q])
    return n, x, z


def loads_for(parts, directions):
    """Return the formula of the forces of joints of a law with these parts.

    They are constants of the formula: where it has branches LLVM does not vectorise its loop.
    """

    @formula
    def joint_loads(
        table, area, prestress,
        jump, rate, slip_rate, opening, slide, cohesion, path, loads, drags, dt,
    ):  # fmt: skip
        """Set the forces W t (N) of all points, and what the points remember; return the work of
        sliding in this step, J.

        table, area, prestress : as in `Interfaces`.
        jump, m; rate : of the jump, m/s; slip_rate : of the jump over the step, m/s, whose first
        row is replaced by the work of sliding at every point, J.
        opening, slide, cohesion, path : history, replaced; a prestress along the joint is in
        `slide` from the start, and without any `slide` it changes nothing. loads : of the springs,
        prestress left out; drags : of the dashpots, None without.
        """
        sliding, law = 0.0, law_of(table, 0)
        for q in range(area.size):
            if parts.varied:
                law = law_of(table, q)
            d_n, d_x, d_z = at_point(directions, slip_rate, q)
            found = traction(
                law, parts, whole_jump(law, parts, directions, prestress, jump, q),
                (dt * d_n, dt * d_x, dt * d_z), at_point(directions, rate, q), dt,
                history_at(directions, opening, slide, cohesion, path, q),
            )  # fmt: skip
            if opening is not None:
                opening[q] = found.history.opening
            if slide is not None:
                slide[0, q] = found.history.slide_x
                if directions > 2:
                    slide[1, q] = found.history.slide_z
                slip_rate[0, q] = area[q] * found.slid
            if cohesion is not None:
                cohesion[q] = found.history.cohesion
            if path is not None:
                path[q] = found.history.path
            n, x, z = found.n, found.x, found.z
            if drags is not None:
                n, x, z = n - found.drag_n, x - found.drag_x, z - found.drag_z
                drags[0, q] = area[q] * found.drag_n
                if directions > 1:
                    drags[1, q] = area[q] * found.drag_x
                if directions > 2:
                    drags[2, q] = area[q] * found.drag_z
            if prestress is not None:
                p_n, p_x, p_z = at_point(directions, prestress, q)
                n -= p_n
                if slide is not None:
                    x, z = x - p_x, z - p_z
            loads[0, q] = area[q] * n
            if directions > 1:
                loads[1, q] = area[q] * x
            if directions > 2:
                loads[2, q] = area[q] * z
        # Apart, as LLVM does not vectorise a loop with a sum.
        if slide is not None:
            for q in range(area.size):
                sliding += slip_rate[0, q]
        return sliding

    return joint_loads


@formula
def joint_energy(parts, directions, table, area, prestress, jump, opening, slide, path):
    """Return the elastic energy of the joints, less what prestressed rock gives off as they open,
    and what opening them has spent, J."""
    stored, spent = 0.0, 0.0
    for q in range(area.size):
        law = law_of(table, q if parts.varied else 0)
        gap, x, z = whole_jump(law, parts, directions, prestress, jump, q)
        before = history_at(directions, opening, slide, None, path, q)
        if parts.dilation:
            gap -= lift(law, before.path)
        x, z = x - before.slide_x, z - before.slide_z
        stored += area[q] * elastic_energy(law, parts, gap, before.opening, x, z)
        if prestress is not None:
            n, x, z = at_point(directions, jump, q)
            p_n, p_x, p_z = at_point(directions, prestress, q)
            stored += area[q] * p_n * n
            if slide is not None:
                stored += area[q] * (p_x * x + p_z * z)
        if parts.softening:
            spent += area[q] * fracture_energy_spent(law, before.opening)
    return stored, spent


@formula
def joint_tangents(
    parts, directions, table, area, prestress,
    jump, rate, opening, slide, cohesion, path, dt, r, stiffness,
):  # fmt: skip
    """Set how the joints resist displacement, [6, q], or [8, q] where slip lifts the faces, N/m:
    the tangents at every point less than zero, times its area.

    opening, slide, cohesion, path : history before the step; r : rate factor, 1/s
    (`joints.tangent`); the rest is as for `joint_loads`.
    """
    law = law_of(table, 0)
    for q in range(area.size):
        if parts.varied:
            law = law_of(table, q)
        found = tangent(
            law, parts, whole_jump(law, parts, directions, prestress, jump, q),
            at_point(directions, rate, q), dt,
            history_at(directions, opening, slide, cohesion, path, q), r,
        )  # fmt: skip
        stiffness[NN, q] = -area[q] * found.nn
        if directions > 1:
            stiffness[XN, q], stiffness[XX, q] = -area[q] * found.xn, -area[q] * found.xx
            if parts.dilation:
                stiffness[NX, q] = -area[q] * found.nx
        if directions > 2:
            stiffness[ZN, q], stiffness[XZ, q] = -area[q] * found.zn, -area[q] * found.xz
            stiffness[ZZ, q] = -area[q] * found.zz
            if parts.dilation:
                stiffness[NZ, q] = -area[q] * found.nz
