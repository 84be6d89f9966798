"""Samples of a running chain: waveforms at receivers and the energy ledger."""

from typing import Any, NamedTuple

import numpy as np

from dem.ends import reaction
from dem.model import Model, State
from dem.step import joint_stress, load_at, march
from joints.jit import jitted
from joints.laws import law_of, spring_traction


class Samples(NamedTuple):
    """Room for what is recorded, [receiver, sample].

    energy : [kinetic, elastic, viscous, boundary, work], J; None when the ledger is not kept.
    v_before : each block's velocity before the sampled step; None likewise.
    """

    stress: np.ndarray
    velocity: np.ndarray
    displacement: np.ndarray
    energy: Any
    v_before: Any


def room(model: Model, state: State, samples: int) -> Samples:
    """Return empty samples."""
    sections, points = len(model.receivers.sections.left), len(model.receivers.points.left)
    keep = state.ledger is not None
    return Samples(
        stress=np.zeros((sections, samples)),
        velocity=np.zeros((points, samples)),
        displacement=np.zeros((points, samples)),
        energy=np.zeros((5, samples)) if keep else None,
        v_before=np.zeros_like(state.v) if keep else None,
    )


@jitted
def run(model, state, samples, stride, first, last):
    """Take samples first .. last - 1, `stride` steps apart, the steps after each included."""
    for s in range(first, last):
        n = s * stride
        sample_before(model, state, samples, s)
        march(model, state, n, n + 1)
        sample_after(model, state, samples, s, n)
        march(model, state, n + 1, n + stride)


@jitted
def sample_before(model, state, samples, s):
    """Read what the step is about to change: joint stresses, displacement, half the velocity."""
    u, v, gap_rate = state.u, state.v, state.gap_rate
    at = model.receivers.sections
    for i in range(at.left.size):
        left, right, w = at.left[i], at.right[i], at.weight[i]
        for contact, share in ((left, 1.0 - w), (right, w)):
            if 0 < contact < u.size:
                t = joint_stress(model.chain, u, v, gap_rate, contact - 1)
                samples.stress[i, s] += share * t
    at = model.receivers.points
    for i in range(at.left.size):
        samples.displacement[i, s] = between(u, at, i)
        samples.velocity[i, s] = 0.5 * between(v, at, i)
    energy_before(samples.energy, model.chain, u, v, samples.v_before, s)


@jitted
def sample_after(model, state, samples, s, n):
    """Add what only the step itself decides: end reactions, the other half of the velocity."""
    at, contacts, area = model.receivers.sections, state.u.size, model.chain.area
    start = (load_at(model.load, n) + reaction(state.start)) / area
    end = reaction(state.end) / area
    for i in range(at.left.size):
        if at.left[i] == 0:
            samples.stress[i, s] += (1.0 - at.weight[i]) * start
        if at.right[i] == contacts:
            samples.stress[i, s] += at.weight[i] * end
    at = model.receivers.points
    for i in range(at.left.size):
        samples.velocity[i, s] += 0.5 * between(state.v, at, i)
    energy_after(samples.energy, model.chain, state, samples.v_before, s)


@jitted
def between(values, at, i):
    """Return values interpolated to the i-th place."""
    return (1.0 - at.weight[i]) * values[at.left[i]] + at.weight[i] * values[at.right[i]]


@jitted
def energy_before(energy, chain, u, v, v_before, s):
    """Sample the elastic energy, and keep the velocities before the step."""
    if energy is not None:
        elastic = 0.0
        for j in range(u.size - 1):
            gap = u[j + 1] - u[j]
            elastic -= 0.5 * chain.area * spring_traction(law_of(chain.law, j), gap) * gap
        energy[1, s] = elastic
        v_before[:] = v


@jitted
def energy_after(energy, chain, state, v_before, s):
    """Sample the kinetic energy, in the form that leapfrog conserves, and the running sums."""
    if energy is not None:
        half_mass = 0.5 * chain.dt / chain.impulse_to_speed
        kinetic = 0.0
        for j in range(state.v.size):
            kinetic += half_mass * v_before[j] * state.v[j]
        energy[0, s] = kinetic
        energy[2:, s] = state.ledger.sums
