"""Memory variables of rock with a constant quality factor (`cases.material.constant_q`).

Each relaxation mechanism is a spring in series with a dashpot. The elongation e_l of the spring, a
vector of freedoms, follows e_l' = v - omega_l e_l; after a step of constant velocity it is exactly
decay e_l + gain v. The force of the rock is K (relaxed u + sum_l share_l e_l), with K from the
unrelaxed moduli. In slow motion all e_l are zero.
"""

from typing import NamedTuple

import numpy as np
from scipy.sparse import csr_matrix

from jointwave.cases.material.constant_q import Mechanisms
from jointwave.joints.formula import formula


class Memory(NamedTuple):
    """Mechanisms for a given time step; none without a quality factor.

    relaxed : share of K without relaxation. share : of each mechanism. spring : share in the stored
    energy, chosen so that the dissipation in a step, omega_l dt share_l times the energy of the
    mean elongation, is never negative. decay, gain (s) : of elongations in a step.
    """

    relaxed: float
    share: np.ndarray
    spring: np.ndarray
    decay: np.ndarray
    gain: np.ndarray

    def tangent(self, dt: float) -> float:
        """Return the share of K that resists a displacement within a step dt (s)."""
        return self.relaxed + float(self.share @ self.gain) / dt

    def strained(self, u: np.ndarray, elongation: np.ndarray) -> np.ndarray:
        """Return the displacement at which elastic rock would have the same stress, m."""
        return self.relaxed * u + self.share @ elongation

    def energy(self, stiffness: csr_matrix, u: np.ndarray, elongation: np.ndarray) -> float:
        """Return the energy of all springs, J; stiffness : K, N/m."""
        of_mechanisms = np.einsum("ln,ln->l", elongation, (stiffness @ elongation.T).T)
        return float(self.relaxed * (u @ (stiffness @ u)) + self.spring @ of_mechanisms) / 2


def memory_of(mechanisms: Mechanisms | None, dt: float) -> Memory:
    """Return mechanisms for steps dt (s).

    The work of a spring's force over a step, share_l dt / gain_l (e' - decay_l e) K (e + e') / 2,
    is a loss plus a change of energy, with spring_l = share_l x / 2 coth(x / 2), x = omega_l dt.
    """
    if mechanisms is None:
        return Memory(1.0, *np.zeros((4, 0)))
    x = mechanisms.frequency * dt
    spring = mechanisms.share * x / 2 / np.tanh(x / 2)
    gain = -np.expm1(-x) / mechanisms.frequency
    return Memory(mechanisms.relaxed, mechanisms.share, spring, np.exp(-x), gain)


@formula
def strain(memory, u, elongation, strained):
    """Set the displacement at which elastic rock would have the same stress."""
    for i in range(u.size):
        strained[i] = memory.relaxed * u[i]
    for k in range(memory.share.size):
        for i in range(u.size):
            strained[i] += memory.share[k] * elongation[k, i]


@formula
def relax(memory, v, elongation):
    """Advance the elongations by a step at velocities v."""
    for k in range(memory.share.size):
        for i in range(v.size):
            elongation[k, i] = memory.decay[k] * elongation[k, i] + memory.gain[k] * v[i]
