"""Leapfrog steps of a jointed elastic body, compiled.

Displacements u are at whole steps, velocities v half a step before or after. Dashpots of rock and
joints see the rate extrapolated to the whole step, 1.5 v[n-1/2] - 0.5 v[n-3/2]; quiet sides and
mass-proportional damping see the mean velocity of the step, solved node by node. The kinetic energy
of a whole step is v[n-1/2] M v[n+1/2] / 2: with the springs' it equals
(v M v + u[n] K u[n+1]) / 2, which leapfrog conserves exactly, and forces work half a step before
and half a step after. All work of rock with a quality factor is summed up as viscous; samples take
what its springs store out of it.
"""

from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np

from jointwave.continuum.stepping.arrays import BOUNDARY, FRICTION, VISCOUS, WORK, StepFlags
from jointwave.continuum.stepping.memory import relax, strain
from jointwave.continuum.stepping.product import product_for, stride_of
from jointwave.continuum.stepping.tractions import components, tractions_for
from jointwave.joints.formula import formula
from jointwave.numerics.borrowed import borrowed
from jointwave.numerics.denormals import flush_denormals, restore_denormals
from jointwave.numerics.jit import jitted


@formula
def read(matrix, x, constant, out, s, share):
    """Add a share of the product of a matrix and a vector, and a constant, to sample s."""
    for i in range(matrix.start.size - 1):
        a = 0.0 if constant is None else constant[i]
        for k in range(matrix.start[i], matrix.start[i + 1]):
            a += share * matrix.value[k] * x[matrix.column[k]]
        out[i, s] += a


@formula
def press(quiet, closure, force):
    """Subtract the forces of the springs in front of dashpots."""
    for k in range(closure.shape[0]):
        for a in range(closure.shape[1]):
            force[quiet.freedom[k, a]] -= quiet.stiffness[k, a] * closure[k, a]


@formula
def close(quiet, v, closure):
    """Advance the closure of springs in front of dashpots by a step."""
    for k in range(closure.shape[0]):
        for a in range(closure.shape[1]):
            moved = quiet.gain[k, a] * v[quiet.freedom[k, a]]
            closure[k, a] = quiet.decay[k, a] * closure[k, a] + moved


@formula
def dot(x, y):
    """Return the product of two vectors, as far as the first goes, summed in four parts."""
    a, b, c, d, n = 0.0, 0.0, 0.0, 0.0, x.size // 4 * 4
    for i in range(0, n, 4):
        a += x[i] * y[i]
        b += x[i + 1] * y[i + 1]
        c += x[i + 2] * y[i + 2]
        d += x[i + 3] * y[i + 3]
    for i in range(n, x.size):
        a += x[i] * y[i]
    return (a + b) + (c + d)


@cache
def leapfrog_for(flags: StepFlags) -> Callable:
    """Return the kernel of steps of a body with these effects; absent ones are not compiled."""
    dim, law, damped, ledger = flags.dim, flags.law, flags.damped, flags.ledger
    relaxing = flags.relaxing
    multiply, stride = product_for(flags.product, dim), stride_of(flags.product)
    ONE, TWO = np.uint64(stride), np.uint64(2 * stride)
    sprung, jointed = flags.sprung, law is not None
    dashpots, rated = (False, False) if law is None else (law.dashpots, law.limited)
    viscous = damped or dashpots
    tractions: Any = None
    if law is not None:
        tractions = tractions_for(law, dim, flags.stressed)

    @formula
    def times(jumps, x, product):
        """Set the jumps of a vector."""
        for q in range(jumps.first.shape[0]):
            i, j, e = np.uint64(jumps.first[q, 0]), np.uint64(jumps.first[q, 1]), jumps.frame
            u, v, w = x[j] - x[i], 0.0, 0.0  # read once: what is set might be part of x
            if dim > 1:
                v = x[j + ONE] - x[i + ONE]
            if dim > 2:
                w = x[j + TWO] - x[i + TWO]
            for a in range(dim):
                found = e[q, a, 0] * u
                if dim > 1:
                    found += e[q, a, 1] * v
                if dim > 2:
                    found += e[q, a, 2] * w
                product[dim * q + a] = found

    @formula
    def add_transposed(jumps, x, force):
        """Add forces that do as much work as x does with the jumps."""
        for q in range(jumps.first.shape[0]):
            i, j, e = np.uint64(jumps.first[q, 0]), np.uint64(jumps.first[q, 1]), jumps.frame
            u, v, w = components(dim, x, q)
            for c in range(dim):
                found, o = e[q, 0, c] * u, np.uint64(c * stride)
                if dim > 1:
                    found += e[q, 1, c] * v
                if dim > 2:
                    found += e[q, 2, c] * w
                force[i + o] -= found
                force[j + o] += found

    @formula
    def relaxing_rock(c, s, w, sampled):
        """Set the force of rock with a quality factor; return the energy of its springs, J, where
        sampled."""
        m, found = c.memory, 0.0
        if ledger and sampled:
            multiply(c.stiffness, s.u, w.force)
            found -= 0.5 * m.relaxed * dot(w.force[: c.mass.size], s.u)
            for k in range(m.share.size):
                multiply(c.stiffness, s.elongation[k], w.force)
                found -= 0.5 * m.spring[k] * dot(w.force[: c.mass.size], s.elongation[k])
        strain(m, s.u, s.elongation, w.strained)
        multiply(c.stiffness, w.strained, w.rock)
        for i in range(w.force.size):
            w.force[i] = w.rock[i]
        return found

    @formula
    def forces(c, s, w, sampled):
        """Set the forces of rock and joints at a whole step, and drags apart; return the energies
        of springs, opening, and springs whose work is summed up as viscous, J, those of rock where
        sampled. Friction's work enters the ledger."""
        elastic, spent = 0.0, 0.0
        if relaxing:
            elastic = relaxing_rock(c, s, w, sampled)
        else:
            multiply(c.stiffness, s.u, w.force)
            if ledger and sampled:
                elastic = -0.5 * dot(w.force[: c.mass.size], s.u)
        kept = elastic if relaxing else 0.0
        if viscous:
            for i in range(s.u.size):
                w.rate[i], w.drag[i] = 1.5 * s.v[i] - 0.5 * s.v_before[i], 0.0
            if damped:
                multiply(c.damping, w.rate, w.drag)
        if jointed:
            times(c.jumps, s.u, w.jump)
            if rated:
                times(c.jumps, s.v, w.moved)
                for k in range(w.moved.size):
                    w.moved[k] *= c.dt
            if dashpots:
                times(c.jumps, w.rate, w.jump_rate)
            slid, stored, spent = tractions(
                c.points, c.dt, w.jump, w.moved, w.jump_rate, s.history, s.history, w.loads, w.drags
            )
            add_transposed(c.jumps, w.loads, w.force)
            if dashpots:
                add_transposed(c.jumps, w.drags, w.drag)
            elastic += stored
            s.sums[FRICTION] += slid
        if viscous:
            for i in range(s.u.size):
                w.force[i] += w.drag[i]
        return elastic, spent, kept

    @formula
    def move(c, s, w, moved):
        """Advance the velocities by a step; moved : of fixed freedoms in it, m."""
        for i in range(c.mass.size):
            s.v_before[i] = s.v[i]
            s.v[i] = c.keep * s.v[i] + c.inverse[i] * w.force[i]
        q, known = c.quiet, w.braking
        for k in range(q.freedom.shape[0]):
            for a in range(dim):
                known[k, a] = s.v[q.freedom[k, a]]
                for b in range(dim):
                    known[k, a] -= q.beta[k, a, b] * s.v_before[q.freedom[k, b]]
            for a in range(dim):
                found = 0.0
                for b in range(dim):
                    found += q.solve[k, a, b] * known[k, b]
                s.v[q.freedom[k, a]] = found
            for a in range(dim):
                braked = 0.0
                for b in range(dim):
                    j = q.freedom[k, b]
                    braked += q.viscosity[k, a, b] * 0.5 * (s.v_before[j] + s.v[j])
                if sprung:
                    braked += q.stiffness[k, a] * s.closure[k, a]
                w.braking[k, a] = braked
        for k in range(c.fixed.size):
            s.v[c.fixed[k]] = c.direction[k] * moved / c.dt

    @formula
    def work(c, s, w, way, drive):
        """Enter the work of the forces over half a step of the velocities `way`."""
        half = 0.5 * c.dt
        if viscous:
            s.sums[VISCOUS] -= half * dot(w.drag[: c.mass.size], way)
        if relaxing:
            s.sums[VISCOUS] -= half * dot(w.rock[: c.mass.size], way)
        if c.alpha > 0.0:
            braked = 0.0
            for i in range(c.mass.size):
                braked += c.mass[i] * (s.v_before[i] + s.v[i]) * way[i]
            s.sums[VISCOUS] += half * 0.5 * c.alpha * braked
        absorbed, done = 0.0, 0.0
        for k in range(c.quiet.freedom.shape[0]):
            for a in range(dim):
                absorbed += w.braking[k, a] * way[c.quiet.freedom[k, a]]
        for k in range(c.driven.size):
            done += drive[k] * way[c.driven[k]]
        for k in range(c.fixed.size):
            i = c.fixed[k]
            gained = (s.v[i] - s.v_before[i]) / c.dt + 0.5 * c.alpha * (s.v[i] + s.v_before[i])
            done += (c.mass[i] * gained - w.force[i]) * way[i]
        s.sums[BOUNDARY] += half * absorbed
        s.sums[WORK] += half * done

    @formula
    def record(c, s, w, out, n):
        """Take sample n of all receivers."""
        r = c.receivers
        read(r.motion, s.v, None, out.velocity, n, 0.5)
        read(r.motion, s.v_before, None, out.velocity, n, 0.5)
        read(r.motion, s.u, None, out.displacement, n, 1.0)
        read(r.stress, w.strained if relaxing else s.u, r.constant, out.stress, n, 1.0)
        if damped:
            read(r.viscous, w.rate, None, out.stress, n, 1.0)
        read(r.inertia, s.v, None, out.stress, n, 1.0 / c.dt + 0.5 * c.alpha)
        read(r.inertia, s.v_before, None, out.stress, n, -1.0 / c.dt + 0.5 * c.alpha)
        if jointed:
            read(r.traction, w.loads, r.carried, out.traction, n, 1.0)
            if dashpots:
                read(r.traction, w.drags, None, out.traction, n, 1.0)
            read(r.jump, w.jump, None, out.jump, n, 1.0)

    def steps(c, s, w, out, drive, moves, span):
        """Take the steps first .. last - 1, with a sample at each that `stride` divides.

        drive : float array [steps, k], N, forces on driven freedoms. moves : float array [steps],
        m, motion of fixed freedoms in each step. span : first, last, stride.
        """
        setting = flush_denormals()
        c, s, w, out, drive = borrowed((c, s, w, out, drive))
        first, last, stride = span
        for n in range(first, last):
            elastic, spent, kept = forces(c, s, w, n % stride == 0)
            for i in range(c.steady.size):
                w.force[i] += c.steady[i]
            for k in range(c.driven.size):
                w.force[c.driven[k]] += drive[n - first, k]
            if sprung:
                press(c.quiet, s.closure, w.force)
            move(c, s, w, moves[n - first])
            if ledger:
                work(c, s, w, s.v_before, drive[n - first])
            if n % stride == 0:
                record(c, s, w, out, n // stride)
                if ledger:
                    kinetic = 0.0
                    for i in range(c.mass.size):
                        kinetic += 0.5 * c.mass[i] * s.v_before[i] * s.v[i]
                    fallen = dot(c.steady, s.u)
                    found = (
                        kinetic, elastic, s.sums[VISCOUS] - kept, s.sums[FRICTION], spent,
                        s.sums[BOUNDARY], -fallen, s.sums[WORK],
                    )  # fmt: skip
                    for term in range(len(found)):
                        out.energy[term, n // stride] = found[term]
            if ledger:
                work(c, s, w, s.v, drive[n - first])
            for i in range(c.mass.size):
                s.u[i] += c.dt * s.v[i]
            if sprung:
                close(c.quiet, s.v, s.closure)
            if relaxing:
                relax(c.memory, s.v[: c.mass.size], s.elongation)
        restore_denormals(setting)

    return jitted(steps, flags)
