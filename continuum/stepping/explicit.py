"""Leapfrog steps of a jointed elastic body, compiled.

Displacements u are at whole steps, velocities v half a step before or after. Dashpots of rock and
joints use rates extrapolated to the whole step, 1.5 v[n-1/2] - 0.5 v[n-3/2]; quiet sides and
mass-proportional damping use the mean velocity of the step, solved node by node. The kinetic energy
of a whole step is v[n-1/2] M v[n+1/2] / 2. With the elastic energy it equals
(v M v + u[n] K u[n+1]) / 2, which leapfrog conserves exactly. Forces work over half a step before
and half a step after. All work of rock with a quality factor is summed as viscous; samples subtract
the energy stored in its springs.
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
    """Add `share` times the product of a matrix and a vector, plus a constant, to sample s."""
    for i in range(matrix.start.size - 1):
        a = 0.0 if constant is None else constant[i]
        for k in range(matrix.start[i], matrix.start[i + 1]):
            a += share * matrix.value[k] * x[matrix.column[k]]
        out[i, s] += a


@formula
def dot(x, y):
    """Return the scalar product of two vectors over the length of x, in four partial sums."""
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
            u, v, w = x[j] - x[i], 0.0, 0.0  # read first: product and x might share memory
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
        """Add B^T x, the nodal forces of point forces x."""
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

    def steps(c, s, w, out, drive, moves, span):
        """Take the steps first .. last - 1, with a sample at each multiple of `stride`.

        drive : forces on driven freedoms [steps, k], N. moves : motion of fixed freedoms in each
        step [steps, motions], m. span : first, last, stride.
        """
        setting = flush_denormals()
        c, s, w, out, drive = borrowed((c, s, w, out, drive))
        first, last, stride = span
        dt, mass, inverse, keep, alpha = c.dt, c.mass, c.inverse, c.keep, c.alpha
        stiffness, jumps, points, m, q, r = (
            c.stiffness, c.jumps, c.points, c.memory, c.quiet, c.receivers
        )  # fmt: skip
        steady, driven, fixed, direction = c.steady, c.driven, c.fixed, c.direction
        u, v, v_before, history, sums = s.u, s.v, s.v_before, s.history, s.sums
        elongation, closure, braking = s.elongation, s.closure, w.braking
        force, rate, drag, strained, rock = w.force, w.rate, w.drag, w.strained, w.rock
        jump, moved, jump_rate, loads, drags = w.jump, w.moved, w.jump_rate, w.loads, w.drags
        freedom, spring, own, half = q.freedom, q.stiffness, mass.size, 0.5 * dt
        for n in range(first, last):
            sampled, given = n % stride == 0, drive[n - first]
            elastic, spent, kept = 0.0, 0.0, 0.0

            # Forces of rock and joints, drags separately, and stored energies where sampled.
            if relaxing:
                if ledger and sampled:
                    multiply(stiffness, u, force)
                    elastic -= 0.5 * m.relaxed * dot(force[:own], u)
                    for k in range(m.share.size):
                        multiply(stiffness, elongation[k], force)
                        elastic -= 0.5 * m.spring[k] * dot(force[:own], elongation[k])
                    kept = elastic
                strain(m, u, elongation, strained)
                multiply(stiffness, strained, rock)
                for i in range(force.size):
                    force[i] = rock[i]
            else:
                multiply(stiffness, u, force)
                if ledger and sampled:
                    elastic = -0.5 * dot(force[:own], u)
            if viscous:
                for i in range(u.size):
                    rate[i], drag[i] = 1.5 * v[i] - 0.5 * v_before[i], 0.0
                if damped:
                    multiply(c.damping, rate, drag)
            if jointed:
                times(jumps, u, jump)
                if rated:
                    times(jumps, v, moved)
                    for k in range(moved.size):
                        moved[k] *= dt
                if dashpots:
                    times(jumps, rate, jump_rate)
                slid, stored, spent = tractions(
                    points, dt, jump, moved, jump_rate, history, history, loads, drags
                )
                add_transposed(jumps, loads, force)
                if dashpots:
                    add_transposed(jumps, drags, drag)
                elastic += stored
                sums[FRICTION] += slid
            if viscous:
                for i in range(u.size):
                    force[i] += drag[i]
            for i in range(steady.size):
                force[i] += steady[i]
            for k in range(driven.size):
                force[driven[k]] += given[k]
            if sprung:
                for k in range(closure.shape[0]):
                    for a in range(dim):
                        force[freedom[k, a]] -= spring[k, a] * closure[k, a]

            # Velocities half a step later: of all nodes, of dashpots' nodes, prescribed ones.
            for i in range(own):
                v_before[i] = v[i]
                v[i] = keep * v[i] + inverse[i] * force[i]
            for k in range(freedom.shape[0]):
                for a in range(dim):
                    braking[k, a] = v[freedom[k, a]]
                    for b in range(dim):
                        braking[k, a] -= q.beta[k, a, b] * v_before[freedom[k, b]]
                for a in range(dim):
                    found = 0.0
                    for b in range(dim):
                        found += q.solve[k, a, b] * braking[k, b]
                    v[freedom[k, a]] = found
                for a in range(dim):
                    braked = 0.0
                    for b in range(dim):
                        j = freedom[k, b]
                        braked += q.viscosity[k, a, b] * 0.5 * (v_before[j] + v[j])
                    if sprung:
                        braked += spring[k, a] * closure[k, a]
                    braking[k, a] = braked
            for k in range(fixed.size):
                found = 0.0
                for b in range(moves.shape[1]):
                    found += direction[k, b] * moves[n - first, b]
                v[fixed[k]] = found / dt

            for later in range(2):  # half a step before, and after
                way = v if later else v_before
                if ledger:
                    if viscous:
                        sums[VISCOUS] -= half * dot(drag[:own], way)
                    if relaxing:
                        sums[VISCOUS] -= half * dot(rock[:own], way)
                    if alpha > 0.0:
                        braked = 0.0
                        for i in range(own):
                            braked += mass[i] * (v_before[i] + v[i]) * way[i]
                        sums[VISCOUS] += half * 0.5 * alpha * braked
                    absorbed, done = 0.0, 0.0
                    for k in range(freedom.shape[0]):
                        for a in range(dim):
                            absorbed += braking[k, a] * way[freedom[k, a]]
                    for k in range(driven.size):
                        done += given[k] * way[driven[k]]
                    for k in range(fixed.size):
                        i = fixed[k]
                        gained = (v[i] - v_before[i]) / dt + 0.5 * alpha * (v[i] + v_before[i])
                        done += (mass[i] * gained - force[i]) * way[i]
                    sums[BOUNDARY] += half * absorbed
                    sums[WORK] += half * done
                if later or not sampled:
                    continue
                at = n // stride
                read(r.motion, v, None, out.velocity, at, 0.5)
                read(r.motion, v_before, None, out.velocity, at, 0.5)
                read(r.motion, u, None, out.displacement, at, 1.0)
                read(r.stress, strained if relaxing else u, r.constant, out.stress, at, 1.0)
                if damped:
                    read(r.viscous, rate, None, out.stress, at, 1.0)
                read(r.inertia, v, None, out.stress, at, 1.0 / dt + 0.5 * alpha)
                read(r.inertia, v_before, None, out.stress, at, -1.0 / dt + 0.5 * alpha)
                if jointed:
                    read(r.traction, loads, r.carried, out.traction, at, 1.0)
                    if dashpots:
                        read(r.traction, drags, None, out.traction, at, 1.0)
                    read(r.jump, jump, None, out.jump, at, 1.0)
                if ledger:
                    kinetic = 0.0
                    for i in range(own):
                        kinetic += 0.5 * mass[i] * v_before[i] * v[i]
                    terms = (
                        kinetic, elastic, sums[VISCOUS] - kept, sums[FRICTION], spent,
                        sums[BOUNDARY], -dot(steady, u), sums[WORK],
                    )  # fmt: skip
                    for term in range(len(terms)):
                        out.energy[term, at] = terms[term]

            for i in range(own):
                u[i] += dt * v[i]
            if sprung:
                for k in range(closure.shape[0]):
                    for a in range(dim):
                        gained = q.gain[k, a] * v[freedom[k, a]]
                        closure[k, a] = q.decay[k, a] * closure[k, a] + gained
            if relaxing:
                relax(m, v[:own], elongation)
        restore_denormals(setting)

    return jitted(steps, flags)
