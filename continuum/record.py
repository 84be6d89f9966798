"""Samples of a running bar: waveforms at receivers and the energy ledger, compiled."""

from continuum.sparse import row
from joints.jit import jitted
from joints.laws import law_of, spring_traction


@jitted
def book(ledger, half_step, load, loaded, quiet, reaction, drag, way):
    """Add the work of every force of this step over one half of it, moving at velocity `way`.

    The two halves of all steps make the trapezoid rule that leapfrog conserves exactly.
    """
    if ledger is not None:
        ledger[0] += half_step * viscous_power(drag, way)
        ledger[1] += half_step * boundary_power(quiet, reaction, way)
        ledger[2] += half_step * load * way[loaded]


@jitted
def viscous_power(drag, way):
    """Return the power (W) that dashpots in rock and joints take."""
    total = 0.0
    if drag is not None:
        for i in range(drag.size):
            total -= drag[i] * way[i]
    return total


@jitted
def boundary_power(quiet, reaction, way):
    """Return the power (W) that goes into what absorbs at the ends."""
    total = 0.0
    if reaction is not None:
        for k in range(reaction.size):
            total += reaction[k] * way[quiet.node[k]]
    return total


@jitted
def sample(rock, receivers, samples, s, u, v, v_before, rate, dt):
    """Record displacement and velocity of points, and stress of sections, at a whole step."""
    read(samples.displacement, s, receivers.point, u, 1.0)
    read(samples.velocity, s, receivers.point, v_before, 0.5)
    read(samples.velocity, s, receivers.point, v, 0.5)
    read(samples.stress, s, receivers.elastic, u, 1.0)
    read_damped(samples.stress, s, receivers.elastic, rate, rock.time_constant)
    read(samples.stress, s, receivers.inertia, v, 1.0 / dt)
    read(samples.stress, s, receivers.inertia, v_before, -1.0 / dt)


@jitted
def read(wave, s, matrix, x, scale):
    """Add scale times matrix times x to sample s of every receiver."""
    start, column, value = matrix
    for r in range(wave.shape[0]):
        wave[r, s] += scale * row(start, column, value, x, r)


@jitted
def read_damped(wave, s, matrix, rate, time_constant):
    """Add the viscous part of the rock's stress."""
    if time_constant is not None:
        read(wave, s, matrix, rate, time_constant)


@jitted
def sample_joints(stress, s, contact, traction, dashpot):
    """Record the stress of sections on a joint: its traction, spring and dashpot."""
    if contact is not None:
        read(stress, s, contact, traction, 1.0)
        if dashpot is not None:
            read(stress, s, contact, dashpot, 1.0)


@jitted
def sample_energy(energy, rock, interfaces, s, u, v, v_before, ledger):
    """Record kinetic, elastic, viscous, boundary and work (J): their balance is exact."""
    if energy is not None:
        start, column, value = rock.stiffness
        mass = rock.mass
        for i in range(u.size):
            energy[0, s] += 0.5 * mass[i] * v_before[i] * v[i]
            energy[1, s] += 0.5 * u[i] * row(start, column, value, u, i)
        energy[1, s] += joint_energy(interfaces, u)
        for k in range(3):
            energy[2 + k, s] = ledger[k]


@jitted
def joint_energy(interfaces, u):
    """Return the elastic energy (J) of the joints that are closed or carry tension."""
    total = 0.0
    if interfaces is not None:
        start, column, value = interfaces.jump
        law, area = interfaces.law, interfaces.area
        for q in range(area.size):
            gap = row(start, column, value, u, q)
            total -= 0.5 * area[q] * spring_traction(law_of(law, q), gap) * gap
    return total
