"""Samples of a running chain: waveforms at receivers and the energy ledger."""

from typing import Any, NamedTuple

import numpy as np

from dem.axial.ends import reaction
from dem.axial.model import Model
from dem.axial.motion import steady_at
from dem.axial.state import INNER, State
from dem.axial.step import joint_stress, load_at, march, opened
from joints.energy import elastic_energy, fracture_energy_spent
from joints.laws import law_of
from numerics.aligned import zeros
from numerics.borrowed import borrowed
from numerics.denormals import flush_tiny, restore_tiny
from numerics.divergence import is_lost, next_look
from numerics.jit import inlined, jitted
from numerics.sums import total


class Samples(NamedTuple):
    """Room for what is recorded, [receiver, sample].

    energy : [term, sample], J, the terms those of `terms`; None when the ledger is not kept.
    v_before : each block's velocity before the sampled step, and before that the energies of all
        joints; None likewise.
    """

    stress: np.ndarray
    velocity: np.ndarray
    displacement: np.ndarray
    energy: Any
    v_before: Any


def terms(model: Model) -> tuple[str, ...]:
    """Return the terms of the energy ledger, the rows of its samples."""
    fracture = () if model.chain.law.tensile_strength is None else ("fracture",)
    gravity = () if model.chain.weight is None else ("gravity",)
    return ("kinetic", "elastic", "viscous", *fracture, "boundary", *gravity, "work")


def room(model: Model, state: State, samples: int) -> Samples:
    """Return empty samples."""
    sections, points = len(model.receivers.sections.left), len(model.receivers.points.left)
    keep = state.ledger is not None
    return Samples(
        stress=np.zeros((sections, samples)),
        velocity=np.zeros((points, samples)),
        displacement=np.zeros((points, samples)),
        energy=np.zeros((len(terms(model)), samples)) if keep else None,
        v_before=zeros(state.v.size, INNER) if keep else None,
    )


@jitted
def run(model, state, samples, stride, first, last, guard=None):
    """Take samples first .. last - 1, `stride` steps apart, the steps after each included.

    guard : `numerics.divergence.Guard` that ends it where it runs out of bounds; None without.
    """
    tiny = flush_tiny()
    model, state, samples = borrowed((model, state, samples))
    s, n, end = first, first * stride, last * stride
    due = next_look(guard, n, end)
    while n < end:
        if n == s * stride:
            sample_before(model, state, samples, s)
            march(model, state, n, n + 1)
            sample_after(model, state, samples, s, n)
            n, s = n + 1, s + 1
        stop = min(s * stride, due)
        march(model, state, n, stop)
        n = stop
        if n == due:
            if is_lost(guard, state.v, n, samples.energy, s - 1, stride):
                break
            due = next_look(guard, n, end)
    restore_tiny(tiny)


@inlined
def sample_before(model, state, samples, s):
    """Read what the step is about to change: joint stresses, displacement, half the velocity."""
    u, v, gap_rate, opening = state.u, state.v, state.gap_rate, state.opening
    at = model.receivers.sections
    for i in range(at.left.size):
        left, right, w = at.left[i], at.right[i], at.weight[i]
        for contact, share in ((left, 1.0 - w), (right, w)):
            if 0 < contact < u.size:
                t = joint_stress(model.chain, u, v, gap_rate, opening, contact - 1)
                samples.stress[i, s] += share * t
    at = model.receivers.points
    for i in range(at.left.size):
        samples.displacement[i, s] = between(u, at, i)
        samples.velocity[i, s] = 0.5 * between(v, at, i)
    energy_before(samples.energy, model.chain, u, v, opening, samples.v_before, s)


@inlined
def sample_after(model, state, samples, s, n):
    """Add what only the step itself decides: end reactions, the other half of the velocity."""
    at, contacts, chain = model.receivers.sections, state.u.size, model.chain
    pushed = load_at(model.load, n) + steady_at(chain.steady, 0)
    start = (pushed + reaction(state.start)) / chain.area
    end = (reaction(state.end) + steady_at(chain.steady, 1)) / chain.area
    for i in range(at.left.size):
        if at.left[i] == 0:
            samples.stress[i, s] += (1.0 - at.weight[i]) * start
        if at.right[i] == contacts:
            samples.stress[i, s] += at.weight[i] * end
    at = model.receivers.points
    for i in range(at.left.size):
        samples.velocity[i, s] += 0.5 * between(state.v, at, i)
    energy_after(samples.energy, chain, state, samples.v_before, s)


@inlined
def between(values, at, i):
    """Return values interpolated to the i-th place."""
    return (1.0 - at.weight[i]) * values[at.left[i]] + at.weight[i] * values[at.right[i]]


@inlined
def energy_before(energy, chain, u, v, opening, v_before, s):
    """Sample what depends on where the blocks are, and keep the velocities before the step."""
    if energy is not None:
        joints = v_before[: u.size - 1]
        for j in range(joints.size):
            gap = u[j + 1] - u[j]
            joints[j] = elastic_energy(law_of(chain.law, j), gap, opened(opening, j, gap))
        energy[1, s] = chain.area * total(joints)
        sample_fracture(energy, joints, chain, u, opening, s)
        sample_weight(energy, chain.weight, u, s)
        v_before[:] = v


@inlined
def sample_fracture(energy, joints, chain, u, opening, s):
    """Sample what opening has spent of the joints' fracture energy."""
    if opening is not None:
        for j in range(joints.size):
            k = opened(opening, j, u[j + 1] - u[j])
            joints[j] = fracture_energy_spent(law_of(chain.law, j), k)
        energy[3, s] = chain.area * total(joints)


@inlined
def sample_weight(energy, weight, u, s):
    """Sample the potential energy in gravity, zero in the unloaded pillar."""
    if weight is not None:
        energy[-2, s] = -weight * total(u)


@inlined
def energy_after(energy, chain, state, v_before, s):
    """Sample the kinetic energy, in the form that leapfrog conserves, and the running sums."""
    if energy is not None:
        energy[0, s] = 0.5 * chain.mass * total(v_before, state.v)
        energy[2, s] = spent(state.ledger.viscous)
        sums = state.ledger.sums
        energy[boundary_row(state.opening), s], energy[-1, s] = sums[0], sums[1]


@inlined
def spent(viscous):
    """Return the work against all damping, J."""
    if viscous is None:
        return 0.0
    return total(viscous)


@inlined
def boundary_row(opening):
    """Return the row of the boundary's work: behind that of fracture, where there is one."""
    if opening is None:
        return 3
    return 4
