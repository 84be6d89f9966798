"""Forces of a chunk's contacts in their frames, in the plane and in space: point by point where
joints can fail, for the whole face where they always hold."""

from collections.abc import Callable

from jointwave.dem.contacts.chunks import LANES as L
from jointwave.dem.kernel.model import KernelFlags
from jointwave.dem.kernel.motion import ELASTIC, FRACTURE, FRICTION
from jointwave.dem.kernel.rotation import three
from jointwave.dem.kernel.sharing import of_contacts, shared
from jointwave.joints.formula import formula
from jointwave.joints.law import History, law_at, law_of, traction_for


@formula
def add(q, row, value):
    """Add a value to an entry of the buffer."""
    q[row] = q[row] + value


@shared(of_contacts)
def point_forces_for(form: KernelFlags) -> Callable:
    """Return the kernel of forces at contact points by the full joint law."""
    parts, dim, turns, stressed = form.parts, form.dim, form.turns, form.stressed
    dashpots, varied, has_ledger, finite = parts.dashpots, parts.varied, form.ledger, form.finite
    softening, residual, path_dependent = parts.softening, parts.residual, parts.path
    traction = traction_for(parts.shear, parts.path)
    rated, drags, past, rows = form.rated, form.drags, form.point, form.buffer
    LAW, JUMP, RATE, NOW, FORCE, DRAG = (
        rows.law, rows.jump, rows.rate, rows.now, rows.force, rows.drag
    )  # fmt: skip
    START, POINT, EXTENT = form.table.start, form.table.size, form.table.extent
    PAST, OPENING, WHOLE, COHESION, PATH, past_rows = (
        form.history.size, past.opening, past.whole, past.cohesion, past.path, past.size
    )  # fmt: skip
    END = rows.on_j

    @formula
    def at_point(q, row, c, e_1, e_2):
        """Return gap and slip, or their rates, at a point of the face from those at its centre."""
        gap, x, z = three(q, row + c, L)
        if dim == 2:
            return gap - e_1 * z, x, 0.0
        if finite:
            further, other = three(q, row + 3 * L + c, L), three(q, row + 6 * L + c, L)
            gap = gap + (e_1 * further[0] + e_2 * other[0])
            x = x + (e_1 * further[1] + e_2 * other[1])
            z = z + (e_1 * further[2] + e_2 * other[2])
        elif turns:
            p_n, p_1, p_2 = three(q, row + 3 * L + c, L)
            gap, x, z = gap + (p_1 * e_2 - p_2 * e_1), x - p_n * e_2, z + p_n * e_1
        return gap, x, z

    @formula
    def area_within(k, c, area, x, z, gap):
        """Return the area of a point, 0 if it lies beyond the face of j or behind block j."""
        behind, along, across = three(k, EXTENT + c, L)
        # One condition instead of three: branches would prevent vectorisation over lanes.
        return area if max(abs(x) - along, abs(z) - across, -behind - gap) <= 0.0 else 0.0

    @formula
    def history_at(h, before, c):
        """Return the history of a point; absent variables are 0."""
        opening, slide_x, slide_z, cohesion, path = 0.0, h[before + c], 0.0, 0.0, 0.0
        if dim > 2:
            slide_z = h[before + L + c]
        if softening:
            opening = h[before + OPENING + c]
        if residual:
            cohesion = h[before + COHESION + c]
        if path_dependent:
            path = h[before + PATH + c]
        return History(opening, slide_x, slide_z, cohesion, path)

    @formula
    def store_history(h, before, c, after):
        """Replace the history of a point."""
        h[before + c] = after.slide_x
        if dim > 2:
            h[before + L + c] = after.slide_z
        if softening:
            h[before + OPENING + c] = after.opening
        if residual:
            h[before + COHESION + c] = after.cohesion
        if path_dependent:
            h[before + PATH + c] = after.path

    @formula
    def add_force(q, row, c, e_1, e_2, f_n, f_x, f_z):
        """Add the force at a point and its first moments about the centre of the face."""
        add(q, row + c, f_n)
        add(q, row + L + c, f_x)
        if dim > 2:
            add(q, row + 2 * L + c, f_z)
        if turns:
            spread = row + dim * L + c
            add(q, spread, e_1 * f_n)
            add(q, spread + L, e_1 * f_x)
            if dim > 2:
                add(q, spread + 2 * L, e_1 * f_z)
                add(q, spread + 3 * L, e_2 * f_n)
                add(q, spread + 4 * L, e_2 * f_x)
                add(q, spread + 5 * L, e_2 * f_z)

    @formula
    def add_drag(q, c, e_1, e_2, f_n, f_x, f_z):
        """Add the dashpots' force at a point and its moment about the centre of the face."""
        add(q, DRAG + c, f_n)
        add(q, DRAG + L + c, f_x)
        if dim == 2:
            add(q, DRAG + 2 * L + c, -e_1 * f_n)
        if dim > 2:
            add(q, DRAG + 2 * L + c, f_z)
            if turns:
                add(q, DRAG + 3 * L + c, e_1 * f_z - e_2 * f_x)
                add(q, DRAG + 4 * L + c, e_2 * f_n)
                add(q, DRAG + 5 * L + c, -e_1 * f_n)

    @formula
    def point_forces(laws, k, h, q, ledger, dt, weighed):
        """Set the rows of the contacts' forces and first moments.

        laws : the table. k, h, q : table and history of the chunk, and its buffer. weighed : 1 to
        add elastic and fracture energy to the ledger, else 0.
        """
        common = law_of(laws, 0)
        for c in range(FORCE, END):
            q[c] = 0.0
        if drags:
            for c in range(DRAG, LAW):
                q[c] = 0.0
        for p in range((k.size - POINT) // (dim * L)):
            own, before = POINT + p * dim * L, PAST + p * past_rows
            for c in range(L):
                law = law_at(q, LAW + c, L) if varied else common
                e_1, e_2, area = k[own + c], 0.0, k[own + (dim - 1) * L + c]
                if dim > 2:
                    e_2 = k[own + L + c]
                gap, x, z = at_point(q, JUMP, c, e_1, e_2)
                if finite:
                    area = area_within(k, c, area, e_1 - x, e_2 - z, gap)
                if stressed:
                    gap, x = gap + k[START + c], x + k[START + L + c]
                    if dim > 2:
                        z = z + k[START + 2 * L + c]
                rate, moved = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
                if rated:
                    rate = at_point(q, RATE, c, e_1, e_2)
                    moved = dt * rate[0], dt * rate[1], dt * rate[2]
                if dashpots:
                    rate = at_point(q, NOW, c, e_1, e_2)
                found = traction(law, parts, (gap, x, z), moved, rate, dt, history_at(h, before, c))
                store_history(h, before, c, found.history)
                if softening:
                    whole = found.history.opening < law.critical_opening
                    h[before + WHOLE + c] += 1.0 if whole else 0.0
                add_force(q, FORCE, c, e_1, e_2, area * found.n, area * found.x, area * found.z)
                if drags:
                    f_n, f_x, f_z = found.drag_n, found.drag_x, found.drag_z
                    f_n, f_x, f_z = area * f_n, area * f_x, area * f_z
                    if finite:
                        add_force(q, DRAG, c, e_1, e_2, f_n, f_x, f_z)
                    else:
                        add_drag(q, c, e_1, e_2, f_n, f_x, f_z)
                if has_ledger:
                    ledger[FRICTION + c] += area * found.slid
                    ledger[ELASTIC + c] += weighed * area * found.stored
                    if softening:
                        ledger[FRACTURE + c] += weighed * area * found.spent

    return point_forces


@shared(of_contacts)
def face_forces_for(form: KernelFlags) -> Callable:
    """Return the kernel of joints that always hold: springs and dashpots spread over the face."""
    dim, turns, stressed, varied = form.dim, form.turns, form.stressed, form.parts.varied
    dashpots, has_ledger, drags, rows = form.parts.dashpots, form.ledger, form.drags, form.buffer
    LAW, JUMP, NOW, FORCE, SPREAD, DRAG = (
        rows.law, rows.jump, rows.now, rows.force, rows.spread, rows.drag
    )  # fmt: skip
    AREA, START, SECOND = form.table.area, form.table.start, form.table.second

    @formula
    def set_forces(laws, k, q, ledger, weighed):
        """Set the forces due to the jump at the centre."""
        common = law_of(laws, 0)
        for a in range(dim):
            for c in range(L):
                law, r = law_at(q, LAW + c, L) if varied else common, a * L + c
                stiffness = law.normal_stiffness if a == 0 else law.shear_stiffness
                moved, area = q[JUMP + r], k[AREA + c]
                if stressed:
                    moved = moved + k[START + r]
                f = -stiffness * area * moved
                if has_ledger and weighed > 0.0:
                    ledger[ELASTIC + c] -= 0.5 * f * moved
                if dashpots:
                    viscosity = law.normal_viscosity if a == 0 else law.shear_viscosity
                    d = -viscosity * area * q[NOW + r]
                    f = f + d
                    if drags:
                        q[DRAG + r] = d
                q[FORCE + r] = f

    @formula
    def set_moments(laws, k, q, ledger, weighed):
        """Set the first moments due to the relative rotation, by the face's second moments."""
        common = law_of(laws, 0)
        for c in range(L):
            law = law_at(q, LAW + c, L) if varied else common
            s_1, s_2, s_12, r = k[SECOND + c], 0.0, 0.0, JUMP + dim * L + c
            p_n, p_1, p_2, d_n, d_1, d_2 = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
            if dim == 2:
                p_2 = q[r]
            else:
                s_2, s_12 = k[SECOND + L + c], k[SECOND + 2 * L + c]
                p_n, p_1, p_2 = q[r], q[r + L], q[r + 2 * L]
            k_n, k_s = law.normal_stiffness, law.shear_stiffness
            if has_ledger and weighed > 0.0:
                bent = s_1 * p_2 * p_2 + s_2 * p_1 * p_1 - 2.0 * s_12 * p_1 * p_2
                turned = k_s * (s_1 + s_2) * p_n * p_n
                ledger[ELASTIC + c] += 0.5 * (k_n * bent + turned)
            p_n, p_1, p_2 = k_s * p_n, k_n * p_1, k_n * p_2
            if dashpots:
                k_n, k_s, r = law.normal_viscosity, law.shear_viscosity, NOW + dim * L + c
                if dim == 2:
                    d_2 = k_n * q[r]
                else:
                    d_n, d_1, d_2 = k_s * q[r], k_n * q[r + L], k_n * q[r + 2 * L]
                p_n, p_1, p_2 = p_n + d_n, p_1 + d_1, p_2 + d_2
            r = SPREAD + c
            q[r], q[r + L] = s_1 * p_2 - s_12 * p_1, s_12 * p_n
            if dim == 3:
                q[r + 2 * L], q[r + 3 * L] = -s_1 * p_n, s_12 * p_2 - s_2 * p_1
                q[r + 4 * L], q[r + 5 * L] = s_2 * p_n, -s_12 * p_n
            if drags:
                r = DRAG + dim * L + c
                if dim == 2:
                    q[r] = -s_1 * d_2
                else:
                    q[r], q[r + L] = -(s_1 + s_2) * d_n, s_12 * d_2 - s_2 * d_1
                    q[r + 2 * L] = s_12 * d_1 - s_1 * d_2

    @formula
    def face_forces(laws, k, h, q, ledger, dt, weighed):
        """Set the rows of the contacts' forces and first moments, as `point_forces` does."""
        set_forces(laws, k, q, ledger, weighed)
        if turns:
            set_moments(laws, k, q, ledger, weighed)

    return face_forces
