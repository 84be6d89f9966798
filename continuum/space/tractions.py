"""The joint law at the quadrature points: forces of the joints, their tangents, their energy.

All arrays of points are [directions, q]: the normal first, then along x and z. Arrays of effects
that the law does not have are None. With the jump operator B (displacements to jumps), the areas W
and the traction t (compression positive, on the far side) the force on the freedoms is B^T W t.
"""

from jointwave.joints.closure import closure_energy
from jointwave.joints.dilation import lift
from jointwave.joints.energy import fracture_energy_spent, friction_work, lift_work
from jointwave.joints.formula import formula
from jointwave.joints.law import History, law_of
from jointwave.joints.normal import gap_under, normal_traction, spring_traction
from jointwave.joints.shear import cohesion_left, shear_return, shear_strength, shear_traction
from jointwave.joints.slide import after_slide
from jointwave.joints.tangent import tangent

#: Rows of the tangents: t_n with the gap; t_x, t_z with it; t_x with x, either with the other, t_z
#: with z; and, where slip lifts the faces, t_n with x and with z.
NN, XN, ZN, XX, XZ, ZZ, NX, NZ = range(8)


@formula
def joint_loads(
    parts, directions, shears, table, area, prestress,
    jump, rate, slip_rate, opening, slide, cohesion, path, loads, drags, dt,
):  # fmt: skip
    """Set the forces W t (N) of all points, and what the points remember; return the work of
    sliding in this step, J.

    parts, directions : constants of the caller; shears : None without shear.
    table, area, prestress : as in `Interfaces`.
    jump, m; rate : of the jump, m/s; slip_rate : of the slip over the step, m/s.
    opening, slide, cohesion, path : history, replaced; a prestress along the joint is in `slide`
    from the start, and without any `slide` it changes nothing. loads : of the springs, prestress
    left out; drags : of the dashpots, None where loads have all.
    """
    sliding, law = 0.0, law_of(table, 0)
    for q in range(area.size):
        if parts.varied:
            law = law_of(table, q)
        gap, gap_rate = jump[0, q], 0.0
        if prestress is not None:
            gap += gap_under(law, parts, prestress[0, q])
        if rate is not None:
            gap_rate = rate[0, q]
        if path is not None:
            gap -= lift(law, path[q]) if parts.dilation else 0.0
        widest = gap
        if opening is not None:
            widest = max(opening[q], gap)
            opening[q] = widest
        t_n = normal_traction(law, parts, gap, gap_rate, widest)
        spring = t_n
        if drags is not None:
            spring = spring_traction(law, parts, gap, widest)
            drags[0, q] = area[q] * (t_n - spring)
        if prestress is None:
            loads[0, q] = area[q] * spring
        else:
            loads[0, q] = area[q] * (spring - prestress[0, q])
        if shears is not None:
            x, z = jump[1, q], jump[2, q] if directions == 3 else 0.0
            rate_x, rate_z = 0.0, 0.0
            if rate is not None:
                rate_x, rate_z = rate[1, q], rate[2, q] if directions == 3 else 0.0
            if slide is None:
                t_x, t_z = shear_traction(law, parts, x, z, rate_x, rate_z)
            else:
                x, z = x - slide[0, q], z - slide[1, q] if directions == 3 else 0.0
                dx, dz = dt * slip_rate[1, q], dt * slip_rate[2, q] if directions == 3 else 0.0
                left, slid, up = 0.0, 0.0, 0.0
                if cohesion is not None:
                    left = cohesion[q]
                if path is not None:
                    slid = path[q]
                tau = shear_strength(law, parts, t_n, gap, widest, left, slid)
                if path is not None:
                    t_n, tau, path[q] = after_slide(
                        law, parts, t_n, tau, gap, gap_rate, widest, left, slid,
                        x, z, rate_x, rate_z, dt,
                    )  # fmt: skip
                    if parts.dilation:
                        up = lift(law, path[q]) - lift(law, slid)
                        spring = spring_traction(law, parts, gap - up, widest)
                        loads[0, q] = area[q] * spring
                        if drags is not None:
                            drags[0, q] = area[q] * (t_n - spring)
                        if prestress is not None:
                            loads[0, q] -= area[q] * prestress[0, q]
                t_x, t_z, ex, ez, slipped = shear_return(
                    law, parts, x, z, x - dx, z - dz, rate_x, rate_z, tau, dt
                )
                if slipped:
                    slide[0, q] += x - ex
                    if directions == 3:
                        slide[1, q] += z - ez
                    if cohesion is not None:
                        cohesion[q] = cohesion_left(law, parts, left, True)
                    sliding += area[q] * friction_work(law, x - dx, z - dz, ex, ez, dx, dz)
                if parts.dilation:
                    old = gap - dt * slip_rate[0, q]
                    sliding -= area[q] * lift_work(law, parts, old, gap - up, widest, up)
                x, z = ex, ez
            if drags is not None:
                spring_x, spring_z = -law.shear_stiffness * x, -law.shear_stiffness * z
                drags[1, q] = area[q] * (t_x - spring_x)
                if directions == 3:
                    drags[2, q] = area[q] * (t_z - spring_z)
                t_x, t_z = spring_x, spring_z
            if prestress is not None and slide is not None:
                t_x -= prestress[1, q]
                if directions == 3:
                    t_z -= prestress[2, q]
            loads[1, q] = area[q] * t_x
            if directions == 3:
                loads[2, q] = area[q] * t_z
    return sliding


@formula
def joint_energy(parts, directions, table, area, prestress, jump, opening, slide, path, loads):
    """Return the elastic energy of the joints, half of their forces times elastic displacements
    where they are linear, less what prestressed rock gives off as they open, and what opening them
    has spent, J."""
    stored, spent = 0.0, 0.0
    for q in range(area.size):
        gap, push, law = jump[0, q], loads[0, q], law_of(table, q if parts.varied else 0)
        if prestress is not None:
            stored += area[q] * prestress[0, q] * gap
            gap += gap_under(law, parts, prestress[0, q])
            push += area[q] * prestress[0, q]
        if path is not None:
            gap -= lift(law, path[q]) if parts.dilation else 0.0
        if parts.closure and gap < 0.0:
            stored += area[q] * closure_energy(law, push / area[q])
        else:
            stored -= 0.5 * push * gap
        for d in range(1, directions):
            slip, push = jump[d, q], loads[d, q]
            if slide is not None:
                if prestress is not None:
                    stored += area[q] * prestress[d, q] * slip
                    push += area[q] * prestress[d, q]
                slip -= slide[d - 1, q]
            stored -= 0.5 * push * slip
        if opening is not None:
            spent += area[q] * fracture_energy_spent(law, opening[q])
    return stored, spent


@formula
def joint_tangents(
    parts, directions, shears, table, area, prestress,
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
        gap, gap_rate = jump[0, q], 0.0
        x, z, rate_x, rate_z, widest, left, slid = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
        if prestress is not None:
            gap += gap_under(law, parts, prestress[0, q])
        if opening is not None:
            widest = opening[q]
        if cohesion is not None:
            left = cohesion[q]
        if path is not None:
            slid = path[q]
        if rate is not None:
            gap_rate = rate[0, q]
        if shears is not None:
            x, z = jump[1, q], jump[2, q] if directions == 3 else 0.0
            if rate is not None:
                rate_x, rate_z = rate[1, q], rate[2, q] if directions == 3 else 0.0
            if slide is not None:
                x, z = x - slide[0, q], z - slide[1, q] if directions == 3 else 0.0
        # The whole elastic slip of the trial: what the step adds to the old one is in it.
        before = History(widest, x, z, left, slid)
        found = tangent(law, parts, gap, gap_rate, (0.0, 0.0), (rate_x, rate_z), dt, before, r)
        stiffness[NN, q] = -area[q] * found.nn
        if shears is not None:
            stiffness[XN, q], stiffness[ZN, q] = -area[q] * found.xn, -area[q] * found.zn
            stiffness[XX, q], stiffness[XZ, q] = -area[q] * found.xx, -area[q] * found.xz
            stiffness[ZZ, q] = -area[q] * found.zz
        if parts.dilation:
            stiffness[NX, q], stiffness[NZ, q] = -area[q] * found.nx, -area[q] * found.nz
