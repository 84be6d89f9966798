"""One leapfrog step of jointed rock after the other, as one compiled function.

Displacements u are at whole steps, velocities v half a step before or after. Dashpots in rock and
joints see the rate extrapolated to the whole step, 1.5 v[n-1/2] - 0.5 v[n-3/2], which keeps second
order without an equation to solve; quiet ends and mass-proportional damping are centred implicitly
on their freedom. The work of all forces over both halves of a step makes the trapezoid rule that
leapfrog conserves exactly.
"""

from functools import cache
from typing import Any

from jointwave.continuum.space.operator import multiply
from jointwave.continuum.space.stencils import add_transposed, multiply_stencils
from jointwave.continuum.space.tractions import joint_energy, loads_for
from jointwave.joints.formula import formula
from jointwave.numerics.arguments import unpacked
from jointwave.numerics.denormals import flush_denormals, restore_denormals
from jointwave.numerics.divergence import EVERY, SPEED
from jointwave.numerics.jit import jitted


@cache
def leapfrog_for(parts, directions, shared=False):
    """Return the kernel for joints of a law with these parts (`joints.law.LawFlags`) and jumps
    in so many directions, both None without joints; shared : by several processes.

    It is given what `continuum.explicit.march.arguments` packs: None for what a model lacks.
    """

    joint_loads: Any = None if parts is None else loads_for(parts, directions)
    send: Any = None
    receive: Any = None
    if shared:
        from jointwave.continuum.parallel.exchange import receive, send

    @formula
    def steps(
        first, last, stride, dt,
        u, v, v_before, force, rate, drag,
        tiles, pairs, k_start, k_column, k_value, c_start, c_column, c_value,
        step_over_mass, mass, decay, weight,
        relaxed, shares, springs, decays, gains, strained, elongation,
        b_first, b_start, b_column, b_value, along,
        table, area, prestress, jump, jump_rate, slip_rate, opening, slide, cohesion, path,
        loads, drags, jumps, jump_rates, slip_rates, load_vector, drag_vector,
        loaded, share, pressure, driven, drive,
        quiet, viscosity, beta, reaction, stiffness, closure_decay, gain, closure,
        dashpots, c_dashpot, b_dashpot, braking,
        fixed, direction, base_step, base_force,
        fields, r_start, r_column, r_value, constant, waves,
        ledger, energy, limit, found, link,
    ):  # fmt: skip
        """Take steps first .. last - 1 and a sample at every step that `stride` divides; return
        MPI's error code, 0 without."""
        setting, failed, elastic = flush_denormals(), 0, 0.0
        for n in range(first, last):
            # Forces from the displacements and rates of step n.
            if elongation is None:
                multiply(tiles, pairs, k_start, k_column, k_value, u, force, -1.0)
                if energy is not None and n % stride == 0:
                    elastic = 0.0
                    for i in range(u.size):
                        elastic -= 0.5 * u[i] * force[i]
            if rate is not None:
                for i in range(v.size):
                    rate[i] = 1.5 * v[i] - 0.5 * v_before[i]
                    drag[i] = 0.0
                if c_start is not None:
                    multiply(tiles, pairs, c_start, c_column, c_value, rate, drag, -1.0)
            if elongation is not None:
                # All of the rock's force counts as viscous; samples tell its energies apart.
                count, elastic = shares.size, 0.0
                for i in range(u.size):
                    strained[i] = relaxed * u[i]
                    force[i] = 0.0
                for k in range(count):
                    e = elongation[k]
                    for i in range(u.size):
                        strained[i] += shares[k] * e[i]
                skipped = 0 if energy is not None and n % stride == 0 else count + 1
                for k in range(skipped, count + 2):
                    e = elongation[k] if k < count else u if k == count else strained
                    multiply(tiles, pairs, k_start, k_column, k_value, e, drag, -1.0)
                    if k <= count:
                        spring = springs[k] if k < count else relaxed
                        for i in range(u.size):
                            elastic -= 0.5 * spring * e[i] * drag[i]
            if area is not None:
                multiply_stencils(b_first, b_start, b_column, b_value, u, jumps, 0)
                if jump_rate is not None:
                    multiply_stencils(b_first, b_start, b_column, b_value, rate, jump_rates, 0)
                if slip_rate is not None:
                    multiply_stencils(b_first, b_start, b_column, b_value, v, slip_rates, along)
                sliding = joint_loads(
                    table, area, prestress,
                    jump, jump_rate, slip_rate, opening, slide, cohesion, path, loads, drags, dt,
                )  # fmt: skip
                if ledger is not None:
                    ledger[1] += sliding
                add_transposed(b_first, b_start, b_column, b_value, load_vector, force)
                if drags is not None:
                    add_transposed(b_first, b_start, b_column, b_value, drag_vector, drag)
            if drag is not None:
                for i in range(force.size):
                    force[i] += drag[i]
            if weight is not None:
                for i in range(force.size):
                    force[i] += weight[i]
            if loaded is not None:
                for k in range(loaded.size):
                    force[loaded[k]] += share[k] * pressure[n]
            if driven is not None:
                for k in range(driven.size):
                    force[driven[k]] += drive[n % drive.shape[0], k]
            if closure is not None:
                for k in range(closure.size):
                    force[quiet[k]] -= stiffness[k] * closure[k]

            # Velocities half a step later; while shares of forces are on their way, of all
            # freedoms, and then again of those that other processes have too.
            if link is not None:
                failed = failed or send(link, force)
            for i in range(v.size):
                v_before[i] = v[i]
                if decay is None:
                    v[i] += step_over_mass[i] * force[i]
                else:
                    v[i] = decay * v[i] + step_over_mass[i] * force[i]
            if link is not None:
                failed = failed or receive(link, force)
                for i in link.freedom:
                    if decay is None:
                        v[i] = v_before[i] + step_over_mass[i] * force[i]
                    else:
                        v[i] = decay * v_before[i] + step_over_mass[i] * force[i]
            if quiet is not None:
                for k in range(quiet.size):
                    i = quiet[k]
                    v[i] = (v[i] - beta[k] * v_before[i]) / (1.0 + beta[k])
                    reaction[k] = 0.5 * viscosity[k] * (v_before[i] + v[i])
                    if closure is not None:
                        reaction[k] += stiffness[k] * closure[k]
            if dashpots is not None:
                for k in range(dashpots.shape[0]):
                    i, j = dashpots[k, 0], dashpots[k, 1]
                    xx, yy, xy = b_dashpot[k, 0], b_dashpot[k, 1], b_dashpot[k, 2]
                    x = v[i] - xx * v_before[i] - xy * v_before[j]
                    y = v[j] - xy * v_before[i] - yy * v_before[j]
                    scale = 1.0 / ((1.0 + xx) * (1.0 + yy) - xy * xy)
                    v[i] = scale * ((1.0 + yy) * x - xy * y)
                    v[j] = scale * ((1.0 + xx) * y - xy * x)
                    x, y = 0.5 * (v_before[i] + v[i]), 0.5 * (v_before[j] + v[j])
                    braking[k, 0] = c_dashpot[k, 0] * x + c_dashpot[k, 2] * y
                    braking[k, 1] = c_dashpot[k, 2] * x + c_dashpot[k, 1] * y
            if fixed is not None:
                for k in range(fixed.size):
                    i = fixed[k]
                    if base_step is None:
                        v[i] = 0.0
                    else:
                        moved = direction[k] * base_step[n] / dt
                        base_force[k] = mass[i] * (moved - v_before[i]) / dt - force[i]
                        if decay is not None:
                            alpha = 2.0 * (1.0 - decay) / (1.0 + decay) / dt
                            base_force[k] += alpha * mass[i] * 0.5 * (moved + v_before[i])
                        v[i] = moved

            # The work of the step's first half, a sample, the work of its second half.
            if ledger is not None:
                add_work(
                    ledger, 0.5 * dt, v_before, v_before, v, drag, mass, decay, dt,
                    quiet, reaction, loaded, share, pressure, n, fixed, base_force,
                    driven, drive, dashpots, braking,
                )  # fmt: skip
            if n % stride == 0:
                read(fields, r_start, r_column, r_value, constant, waves, n // stride)
                if energy is not None:
                    stored, spent = 0.0, 0.0
                    if area is not None:
                        stored, spent = joint_energy(
                            parts, directions, table, area, prestress, jump, opening, slide, path
                        )
                    s = n // stride
                    energy[1, s], energy[2, s] = elastic + stored, spent
                    add_energy(energy, s, mass, u, v_before, v, weight, ledger)
                    if elongation is not None:
                        energy[4, s] -= elastic
            if ledger is not None:
                add_work(
                    ledger, 0.5 * dt, v, v_before, v, drag, mass, decay, dt,
                    quiet, reaction, loaded, share, pressure, n, fixed, base_force,
                    driven, drive, dashpots, braking,
                )  # fmt: skip
            for i in range(u.size):
                u[i] += dt * v[i]
            if elongation is not None:
                for k in range(shares.size):
                    e = elongation[k]
                    for i in range(u.size):
                        e[i] = decays[k] * e[i] + gains[k] * v[i]
            if closure is not None:
                for k in range(closure.size):
                    closure[k] = closure_decay[k] * closure[k] + gain[k] * v[quiet[k]]

            # The divergence monitor; processes that share a run go on to where all look.
            if limit is not None and (n + 1) % EVERY == 0:
                lost = False
                for i in range(v.size):
                    lost |= not abs(v[i]) <= limit
                if lost:
                    if found[0] < 0:
                        found[0], found[1], found[2] = n + 1, SPEED, n - EVERY
                    if link is None:
                        break
        restore_denormals(setting)
        return failed

    @jitted
    def leapfrog(given, link, first, last, stride, dt):
        return steps(first, last, stride, dt, *unpacked(given), link)

    return leapfrog


@formula
def add_work(
    ledger, half, way, v_before, v, drag, mass, decay, dt,
    quiet, reaction, loaded, share, pressure, n, fixed, base_force,
    driven, drive, dashpots, braking,
):  # fmt: skip
    """Add to the ledger (J) the work of the forces of step n over half a step (s) at velocity
    `way`, m/s: viscous, boundary, load; that of friction is known already."""
    if drag is not None:
        # Four partial sums avoid the latency of a single chain of additions.
        a, b, c, d = 0.0, 0.0, 0.0, 0.0
        for i in range(0, way.size, 4):
            a += drag[i] * way[i]
            b += drag[i + 1] * way[i + 1]
            c += drag[i + 2] * way[i + 2]
            d += drag[i + 3] * way[i + 3]
        ledger[0] -= half * ((a + b) + (c + d))
    if decay is not None:
        braked, alpha = 0.0, 2.0 * (1.0 - decay) / (1.0 + decay) / dt
        for i in range(way.size):
            braked += mass[i] * (v_before[i] + v[i]) * way[i]
        ledger[0] += half * 0.5 * alpha * braked
    if quiet is not None:
        for k in range(quiet.size):
            ledger[2] += half * reaction[k] * way[quiet[k]]
    if dashpots is not None:
        for k in range(dashpots.shape[0]):
            ledger[2] += half * braking[k, 0] * way[dashpots[k, 0]]
            ledger[2] += half * braking[k, 1] * way[dashpots[k, 1]]
    if loaded is not None:
        for k in range(loaded.size):
            ledger[3] += half * pressure[n] * share[k] * way[loaded[k]]
    if driven is not None:
        for k in range(driven.size):
            ledger[3] += half * drive[n % drive.shape[0], k] * way[driven[k]]
    if base_force is not None:
        for k in range(fixed.size):
            ledger[3] += half * base_force[k] * way[fixed[k]]


@formula
def read(fields, start, column, value, constant, waves, s):
    """Set sample s of all receivers: matrix times fields, and a constant."""
    for r in range(waves.shape[0]):
        total = constant[r]
        for k in range(start[r], start[r + 1]):
            total += value[k] * fields[column[k]]
        waves[r, s] = total


@formula
def add_energy(energy, s, mass, u, v_before, v, weight, ledger):
    """Set the energies (J) of sample s, in the order of `continuum.model.TERMS`, that are not of
    springs."""
    kinetic, fallen = 0.0, 0.0
    for i in range(v.size):
        kinetic += 0.5 * mass[i] * v_before[i] * v[i]
    if weight is not None:
        for i in range(u.size):
            fallen += weight[i] * u[i]
    energy[0, s], energy[3, s] = kinetic, -fallen
    for k in range(ledger.size):
        energy[4 + k, s] = ledger[k]
