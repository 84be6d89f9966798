"""Forces of contacts in one dimension: loops along the row, without frames and gathering."""

from collections.abc import Callable

import numpy as np

from jointwave.dem.contacts.chunks import LANES as L
from jointwave.dem.kernel.model import KernelFlags
from jointwave.dem.kernel.motion import AFTER, CHUNK, ELASTIC, FRACTURE, VISCOUS, WORK
from jointwave.joints.energy import elastic_energy, fracture_energy_spent
from jointwave.joints.formula import formula
from jointwave.joints.law import History, law_at, law_of, rows_of, traction_for


def row_forces_for(form: KernelFlags, record: Callable) -> Callable:
    """Return the kernel of contact forces along one axis; record : samples a chunk's contacts."""
    parts, has_ledger, stressed, drags = form.parts, form.ledger, form.stressed, form.drags
    fails, traction, shaken = form.points, traction_for(parts.shear, parts.path), form.shaken
    dashpots, softening, varied, used = (
        parts.dashpots, parts.softening, parts.varied, rows_of(form.parts)
    )  # fmt: skip
    AREA, START, LAW, JUMP, FORCE, RATE, DRAG = (
        form.table.area, form.table.start, form.buffer.law, form.buffer.jump, form.buffer.force,
        form.buffer.rate, form.buffer.drag,
    )  # fmt: skip
    LAST_RATE, LAST_DRAG, POINTS = form.history.rate, form.history.drag, form.history.size
    OPENING, WHOLE = POINTS + form.point.opening, POINTS + form.point.whole

    @formula
    def force_of(law, table, h, q, g, c, gap, now, dt):
        """Return the force on j in lane c of chunk g; gap : m, and now : its rate, m/s."""
        area, rate, opening = table[g, AREA + c], 0.0, 0.0
        if stressed:
            gap = gap + table[g, START + c]
        if dashpots:
            rate, h[g, LAST_RATE + c] = 1.5 * now - 0.5 * h[g, LAST_RATE + c], now
        if fails:
            if softening:
                opening = h[g, OPENING + c]
            found = traction(
                law, parts, (gap, 0.0, 0.0), (0.0, 0.0, 0.0), (rate, 0.0, 0.0), dt,
                History(opening, 0.0, 0.0, 0.0, 0.0),
            )  # fmt: skip
            stress, drag = found.n, found.drag_n
            if softening:
                h[g, OPENING + c] = found.history.opening
                whole = found.history.opening < law.critical_opening
                h[g, WHOLE + c] += 1.0 if whole else 0.0
        else:
            stress, drag = -law.normal_stiffness * gap, 0.0
            if dashpots:
                drag = -law.normal_viscosity * rate
                stress = stress + drag
        if drags:
            q[RATE + c], q[DRAG + c] = now, area * drag
        return area * stress

    @formula
    def account(law, table, h, ledger, g, c, gap):
        """Add the elastic energy and the spent fracture energy to the ledger."""
        opening = 0.0
        if stressed:
            gap = gap + table[g, START + c]
        if softening:
            opening = h[g, OPENING + c]
            ledger[FRACTURE + c] += table[g, AREA + c] * fracture_energy_spent(law, opening)
        if fails:
            stored = elastic_energy(law, parts, gap, opening, 0.0, 0.0)
        else:
            stored = 0.5 * law.normal_stiffness * gap * gap
        ledger[ELASTIC + c] += table[g, AREA + c] * stored

    @formula
    def row_forces(chunks, state, force, walls, samples, q, ledger, t, end, dt, n, s):
        """Add the forces of the tile's contacts up to chunk `end` to their blocks."""
        u, v, h, common = state.u, state.v, state.history, law_of(chunks.laws, 0)
        table, pair, laws, sampled = chunks.table, chunks.pair, chunks.laws, s >= 0
        for g in range(chunks.tiles[CHUNK, t], end):
            first, lanes = chunks.row_from[g], min(L, chunks.contacts - g * L)
            if varied:
                for f in used:
                    for c in range(lanes):
                        q[LAW + f * L + c] = laws[f, pair[g, 2 * L + c]]
            if first >= 0:
                i, before = np.uint64(first), 0.0  # unsigned: indices do not wrap around
                j = i + np.uint64(1)
                for c in range(lanes):
                    law, k = law_at(q, LAW + c, L) if varied else common, np.uint64(c)
                    gap, now = u[j + k] - u[i + k], v[j + k] - v[i + k]
                    q[FORCE + c] = f = force_of(law, table, h, q, g, c, gap, now, dt)
                    force[i + k] += before - f
                    before = f
                force[i + np.uint64(lanes)] += before
                if sampled:
                    for c in range(lanes):
                        q[JUMP + c] = u[j + np.uint64(c)] - u[i + np.uint64(c)]
            else:
                for c in range(lanes):
                    law = law_at(q, LAW + c, L) if varied else common
                    i, j = np.uint64(pair[g, c]), np.uint64(pair[g, L + c])
                    gap, now, w = u[j], v[j], pair[g, L + c] - force.size + 1
                    if shaken and w > 0:
                        gap, now = walls[n, 0, w], walls[n, 1, w]
                    gap, now = gap - u[i], now - v[i]
                    q[FORCE + c] = f = force_of(law, table, h, q, g, c, gap, now, dt)
                    q[JUMP + c] = gap
                    force[i] -= f
                    if w <= 0:
                        force[j] += f
                    elif shaken and has_ledger:
                        ledger[WORK + c] -= 0.5 * dt * f * walls[n, 1, w]
                        ledger[WORK + AFTER + c] -= 0.5 * dt * f * walls[n + 1, 1, w]
            if drags:  # a separate loop: one that stores to more arrays is not vectorised
                for c in range(lanes):
                    drag = q[DRAG + c]
                    ledger[VISCOUS + c] -= 0.5 * dt * q[RATE + c] * (h[g, LAST_DRAG + c] + drag)
                    h[g, LAST_DRAG + c] = drag
            if sampled:
                if has_ledger:
                    for c in range(lanes):
                        law = law_at(q, LAW + c, L) if varied else common
                        account(law, table, h, ledger, g, c, q[JUMP + c])
                record(chunks, samples, q, g, t, s)

    return row_forces
