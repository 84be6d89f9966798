"""Forces of contacts in one dimension that join block after block: loops along the row, for all
chunks of a tile at once, that no frame or gathered motion interrupts."""

from collections.abc import Callable

import numpy as np

from jointwave.dem.chunks import LANES as L
from jointwave.dem.model import KernelFlags
from jointwave.dem.motion import CHUNK, ELASTIC, FRACTURE, VISCOUS
from jointwave.joints.formula import formula
from jointwave.joints.law import History, law_at, law_of, rows_of, traction


def row_forces_for(form: KernelFlags, record: Callable) -> Callable:
    """Return the formula of the forces of a tile's contacts along the row.

    record : the formula that samples a chunk's.
    """
    parts, has_ledger, stressed, drags = form.parts, form.ledger, form.stressed, form.drags
    fails = form.points > 0
    dashpots, softening, varied, used = (
        parts.dashpots, parts.softening, parts.varied, rows_of(form.parts)
    )  # fmt: skip
    AREA, START, LAW, JUMP, FORCE = (
        form.table.area, form.table.start, form.buffer.law, form.buffer.jump, form.buffer.force
    )  # fmt: skip
    RATE, DRAG, POINT = form.history.rate, form.history.drag, form.history.point
    OPENING, WHOLE = POINT + form.history.opening, POINT + form.history.whole

    @formula
    def row_forces(chunks, state, force, samples, q, ledger, t, end, dt, s):
        """Add the forces of the tile's contacts up to chunk `end` to their blocks."""
        u, v, h, common = state.u, state.v, state.history, law_of(chunks.laws, 0)
        table, pair, laws, sampled = chunks.table, chunks.pair, chunks.laws, s >= 0
        for g in range(chunks.tiles[CHUNK, t], end):
            first, lanes = chunks.row_from[g], min(L, chunks.contacts - g * L)
            if first < 0:
                continue
            i = np.uint64(first)  # unsigned: indices do not wrap around
            j = i + np.uint64(1)
            if varied:
                for f in used:
                    for c in range(lanes):
                        q[LAW + f * L + c] = laws[f, pair[g, 2 * L + c]]
            before = 0.0
            for c in range(lanes):
                law, k = law_at(q, LAW + c, L) if varied else common, np.uint64(c)
                area, gap, rate, opening = table[g, AREA + c], u[j + k] - u[i + k], 0.0, 0.0
                if stressed:
                    gap = gap + table[g, START + c]
                if dashpots:
                    now = v[j + k] - v[i + k]
                    rate, h[g, RATE + c] = 1.5 * now - 0.5 * h[g, RATE + c], now
                if fails:
                    if softening:
                        opening = h[g, OPENING + c]
                    found = traction(
                        law, parts, (gap, 0.0, 0.0), (0.0, 0.0, 0.0), (rate, 0.0, 0.0), dt,
                        History(opening, 0.0, 0.0, 0.0, 0.0),
                    )  # fmt: skip
                    stress, drag, stored, spent = found.n, found.drag_n, found.stored, found.spent
                    if softening:
                        h[g, OPENING + c] = found.history.opening
                        whole = found.history.opening < law.critical_opening
                        h[g, WHOLE + c] += 1.0 if whole else 0.0
                else:
                    spring, drag, spent = -law.normal_stiffness * gap, 0.0, 0.0
                    if dashpots:
                        drag = -law.normal_viscosity * rate
                    stress, stored = spring + drag, -0.5 * spring * gap
                f = area * stress
                force[i + k] += before - f
                before = f
                if drags:
                    drag = area * drag
                    ledger[VISCOUS + c] -= 0.5 * dt * now * (h[g, DRAG + c] + drag)
                    h[g, DRAG + c] = drag
                if sampled:
                    q[FORCE + c] = f
                    q[JUMP + c] = u[j + k] - u[i + k]
                    if has_ledger:
                        ledger[ELASTIC + c] += area * stored
                        if softening:
                            ledger[FRACTURE + c] += area * spent
            force[i + np.uint64(lanes)] += before
            if sampled:
                record(chunks, samples, q, g, t, s)

    return row_forces
