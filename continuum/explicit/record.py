"""Samples of running rock: waveforms at receivers and the energy ledger, compiled."""

import numpy as np

from continuum.space.operator import multiply
from continuum.space.sparse import row
from continuum.tractions import at, elastic_slip, gap_at
from joints.energy import elastic_energy, fracture_energy_spent
from joints.jit import inlined
from joints.laws import law_of
from joints.optional import given
from joints.sums import total

#: The rows of a ledger, in the order of `book` and `record_energy`.
TERMS = ("kinetic", "elastic", "fracture", "gravity", "viscous", "friction", "boundary", "work")
STATES = 4  # of these are energies of the step; the others are sums over all steps so far


@inlined
def book(ledger, half_step, model, state, n, way):
    """Add the work of every force of this step over one half of it, moving at velocity `way`.

    The two halves of all steps make the trapezoid rule that leapfrog conserves exactly.
    """
    if ledger is not None:
        ledger[0] += half_step * viscous_power(state.drag, way)
        ledger[0] += half_step * mass_damping_power(model.rock.keep, model, state, way)
        ledger[2] += half_step * boundary_power(model.ends.quiet, state.reaction, way)
        ledger[3] += half_step * load_power(model.ends.loaded, n, way)
        ledger[3] += half_step * wall_power(model.ends.held, state.wall, way)


@inlined
def viscous_power(drag, way):
    """Return the power (W) that dashpots in rock and joints take."""
    if drag is None:
        return 0.0
    return -total(drag, way)


@inlined
def mass_damping_power(keep, model, state, way):
    """Return the power (W) that mass-proportional damping takes."""
    if keep is None:
        return 0.0
    mass = model.rock.mass
    twice = total(mass, state.v_before, way) + total(mass, state.v, way)
    return 0.5 * mass_damping(keep, model.dt) * twice


@inlined
def mass_damping(keep, dt):
    """Return the alpha (1/s) of mass-proportional damping."""
    return 2.0 * (1.0 - keep) / (1.0 + keep) / dt


@inlined
def boundary_power(quiet, reaction, way):
    """Return the power (W) that goes into what absorbs at the ends."""
    power = 0.0
    if reaction is not None:
        for k in range(reaction.size):
            power += reaction[k] * way[quiet.freedom[k]]
    return power


@inlined
def load_power(loaded, n, way):
    """Return the power (W) of the load."""
    power = 0.0
    if loaded is not None:
        for k in range(loaded.freedom.size):
            power += loaded.share[k] * loaded.pressure[n] * way[loaded.freedom[k]]
    return power


@inlined
def wall_power(held, wall, way):
    """Return the power (W) of a base that is shaken."""
    power = 0.0
    if wall is not None:
        for k in range(wall.size):
            power += wall[k] * way[held.freedom[k]]
    return power


@inlined
def record(model, state, samples, s):
    """Record motion of points, stress of sections and the ledger at a whole step."""
    receivers, dt = model.receivers, model.dt
    u, v, v_before = state.u, state.v, state.v_before
    read(samples.displacement, s, receivers.point, u, 1.0)
    read(samples.velocity, s, receivers.point, v_before, 0.5)
    read(samples.velocity, s, receivers.point, v, 0.5)
    read_turn(receivers.turn, samples.turn, s, u)
    read(samples.stress, s, receivers.elastic, u, 1.0)
    read_damped(receivers.viscous, samples.stress, s, state.rate)
    read(samples.stress, s, receivers.inertia, v, 1.0 / dt)
    read(samples.stress, s, receivers.inertia, v_before, -1.0 / dt)
    read_braked(model.rock.keep, receivers.inertia, samples.stress, s, v, 0.5, dt)
    read_braked(model.rock.keep, receivers.inertia, samples.stress, s, v_before, 0.5, dt)
    read_weight(receivers.weight, samples.stress, s)
    read_joints(receivers.contact, samples.stress, s, state.tractions)
    record_energy(samples.energy, model, state, s)


@inlined
def read(wave, s, matrix, x, scale):
    """Add scale times matrix times x to sample s of every receiver."""
    for r in range(wave.shape[0]):
        wave[r, s] += scale * row(matrix, x, r)


@inlined
def read_turn(matrix, turn, s, u):
    """Record the rotation of points, where there is any."""
    if matrix is not None:
        read(turn, s, matrix, u, 1.0)


@inlined
def read_damped(matrix, stress, s, rate):
    """Add the viscous part of the rock's stress."""
    if matrix is not None:
        read(stress, s, matrix, rate, 1.0)


@inlined
def read_braked(keep, inertia, stress, s, v, share, dt):
    """Add what mass-proportional damping takes of a share of velocities, where there is any."""
    if keep is not None:
        read(stress, s, inertia, v, share * mass_damping(keep, dt))


@inlined
def read_weight(weight, stress, s):
    """Add the weight of the rock up to the section, where there is any."""
    if weight is not None:
        for r in range(weight.size):
            stress[r, s] += weight[r]


@inlined
def read_joints(contact, stress, s, tractions):
    """Record the stress of sections on a joint: its tractions, springs and dashpots."""
    if contact is not None:
        read_parts(contact, stress, s, 0, tractions.normal, tractions.drag_n)
        read_parts(contact, stress, s, 1, tractions.x, tractions.drag_x)
        read_parts(contact, stress, s, 2, tractions.z, tractions.drag_z)


@inlined
def read_parts(contact, stress, s, direction, spring, dashpot):
    """Record one component of the traction, where there is one: rows of y first, then x, then z."""
    if spring is not None:
        sections = contact.start.size - 1
        for r in range(sections):
            stress[direction * sections + r, s] += row(contact, spring, r)
            stress[direction * sections + r, s] += part_of(contact, dashpot, r)


@inlined
def part_of(contact, dashpot, r):
    """Return the dashpots' part of a section's traction, zero without them."""
    if dashpot is None:
        return 0.0
    return row(contact, dashpot, r)


@inlined
def record_energy(energy, model, state, s):
    """Record every term (J), in the order of TERMS: their balance is exact."""
    if energy is not None:
        mass, u, v, v_before = model.rock.mass, state.u, state.v, state.v_before
        energy[0, s] = 0.5 * total(mass, v_before, v)
        energy[1, s] = rock_energy(model.rock.stiffness, u)
        record_joints(model.interfaces, state.memory, u, energy, s)
        energy[3, s] = -weight_energy(model.weight, u)
        for k in range(len(state.ledger)):
            energy[STATES + k, s] = state.ledger[k]


@inlined
def rock_energy(stiffness, u):
    """Return the elastic energy (J) of the rock."""
    force = np.zeros(u.size)
    multiply(stiffness, u, force)
    return 0.5 * total(u, force)


@inlined
def weight_energy(weight, u):
    """Return what gravity has done (J)."""
    if weight is None:
        return 0.0
    return total(weight, u)


@inlined
def record_joints(interfaces, memory, u, energy, s):
    """Add what the joints hold, and record what opening them has spent (J)."""
    if interfaces is not None:
        for q in range(interfaces.area.size):
            law, area = law_of(interfaces.law, q), interfaces.area[q]
            gap = gap_at(interfaces.prestress, interfaces, law, u, q)
            opening = given(memory.opening, at(memory.opening, q))
            energy[1, s] += area * held(law.shear_stiffness, interfaces, memory, law, gap, u, q)
            energy[1, s] += area * prestress_energy(interfaces.prestress, interfaces, u, q)
            energy[2, s] += area * spent(opening, law)


@inlined
def held(shear_stiffness, interfaces, memory, law, gap, u, q):
    """Return the energy (J/m2) in the springs of point q."""
    opening = given(memory.opening, at(memory.opening, q))
    if shear_stiffness is None:
        return elastic_energy(law, gap, opening)
    x = elastic_slip(interfaces.slip_x, memory.slide_x, u, q)
    z = elastic_slip(interfaces.slip_z, memory.slide_z, u, q)
    return elastic_energy(law, gap, opening, x, z)


@inlined
def prestress_energy(prestress, interfaces, u, q):
    """Return what prestressed rock on both sides of point q gives off as the joint opens (J/m2)."""
    if prestress is None:
        return 0.0
    return prestress * row(interfaces.opening, u, q)


@inlined
def spent(opening, law):
    """Return what opening has spent (J/m2); nothing without softening."""
    if opening is None:
        return 0.0
    return fracture_energy_spent(law, opening)
