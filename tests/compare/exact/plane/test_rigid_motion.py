"""Rigid blocks exactly in time: waves of the square lattice, matrix exponentials, free flight."""

import numpy as np
import pytest

from closed_forms.block_lattice import Lattice, modes
from jointwave.cases.histories import Ricker
from jointwave.cases.material.contact_points import contact_points
from jointwave.cases.material.rock_mass import Stiffness
from jointwave.cases.partition.periodic import periodic_contacts
from jointwave.cases.schema.domain import Domain
from jointwave.cases.schema.joint_set import JointSet
from jointwave.compare.exact.linear import twins
from jointwave.compare.exact.plane.rigid_motion import (
    RigidSystem,
    forces_of,
    motion,
    points_on,
    stiffness_of,
    viscosity_of,
)
from tests.cases.partition.polygons import cut

K_N, K_S, DENSITY = 9e9, 4e9, 2500.0
SIDES = {"left": (4.0, 0.0), "bottom": (0.0, 3.0)}


LAW = {"normal_stiffness": K_N, "shear_stiffness": K_S, "point_rule": "gauss"}
SETS = [JointSet(name=str(dip), dip=dip, spacing=1.0, **LAW) for dip in (0.0, 90.0)]


def squares():
    """Return a partition of 4 by 3 squares of 1 m."""
    return cut(Domain(size=[4.0, 3.0]), SETS)


def inner_stiffness(partition, contacts, shift=(0.0, 0.0)):
    stiffness = Stiffness(np.full(len(contacts), K_N), np.full(len(contacts), K_S))
    points = contact_points(partition, contacts, SETS, shift)
    return stiffness_of(partition.count, contacts, points, stiffness)


def masses_of(partition):
    m, inertia = DENSITY * partition.area, DENSITY * partition.polar_moment
    return np.stack([m, m, inertia], axis=1).ravel()


def test_waves_of_the_square_lattice_are_its_modes():
    """All three branches of each wave that fits a periodic patch, to round-off."""
    partition = squares()
    K = inner_stiffness(partition, partition.contacts)
    for side, shift in SIDES.items():
        contacts = periodic_contacts(partition, side)
        K = K + inner_stiffness(partition, contacts, shift)
    masses = masses_of(partition)
    lattice = Lattice(1.0, DENSITY, DENSITY / 6, K_N, K_S, K_N / 12)
    for a, b in ((1, 0), (0, 1), (1, 1), (2, 1)):
        wave = 2 * np.pi * np.array([a / 4, b / 3])
        phase = np.exp(1j * partition.centroid @ wave)
        omega, shapes = modes(lattice, wave)
        for w, shape in zip(omega, shapes.T, strict=True):
            q = (phase[:, None] * shape).ravel()
            inertial = w**2 * masses * q
            assert np.abs(K @ q - inertial).max() < 1e-12 * np.abs(inertial).max()


def driven(samples):
    """Return the squares with dashpots below, a Ricker pull of (1, 2) Pa there in so many samples
    over 0.02 s, and the system."""
    partition, edges = squares(), squares().boundary
    low = edges.side == partition.sides.index("bottom")
    below = points_on(
        partition.centroid, edges.block[low], edges.start[low], edges.end[low], edges.normal[low]
    )
    impedance = np.tile([5e6, 3e6], (len(below.block), 1))
    system = RigidSystem(
        masses_of(partition),
        inner_stiffness(partition, partition.contacts),
        viscosity_of(below, impedance, partition.count),
    )
    pulse, times = Ricker(1.0, 0.004), np.linspace(0, 0.02, samples)
    pull = pulse.value(times)[:, None, None] * np.ones((len(below.block), 1)) * [1.0, 2.0]
    return system, forces_of(below, pull, partition.count), pulse


def test_matrix_exponentials_agree():
    """x' = A x + b f(t) of 72 states, where f is taken as it is: cubics between samples are off by
    the fourth power of their distance."""
    system, forces, pulse = driven(401)
    scale, n = 1e4, len(system.masses)
    A, b = np.zeros((2 * n, 2 * n)), np.zeros(2 * n)
    A[:n, n:] = scale * np.eye(n)
    A[n:, :n] = -system.stiffness.toarray() / system.masses[:, None] / scale
    A[n:, n:] = -system.viscosity.toarray() / system.masses[:, None]
    peak = int(np.abs(forces).sum(axis=1).argmax())
    b[n:] = forces[peak] / pulse.value(np.linspace(0, 0.02, 401))[peak] / system.masses
    output = np.diag(np.concatenate([np.full(n, 1 / scale), np.ones(n)]))
    expected = twins(A, b, output, pulse, np.linspace(0, 0.02, 101))[0]
    off = []
    for samples in (401, 801):
        found = np.concatenate(
            motion(*driven(samples)[:2], 0.02 / (samples - 1), samples // 100), axis=1
        )
        error = (found - expected).reshape(101, 2, n)
        off.append(
            np.abs(error).max(axis=(0, 2)) / np.abs(expected.reshape(101, 2, n)).max(axis=(0, 2))
        )
    assert (off[1] < 1e-8).all() and off[0] / off[1] == pytest.approx(16, rel=0.3)


def test_free_blocks_fall():
    """A constant force: u = F t^2 / 2 m, to round-off, for any step."""
    partition = squares()
    masses = masses_of(partition)
    still = inner_stiffness(partition, partition.contacts)
    fall = np.tile([0.0, -9.81, 0.0], partition.count) * masses
    u, v = motion(RigidSystem(masses, still, 0 * still), np.tile(fall, (5, 1)), 0.01, 2)
    t = np.array([0.0, 0.02, 0.04])
    assert u[:, 1::3] == pytest.approx(np.outer(-9.81 * t**2 / 2, np.ones(12)), rel=1e-9)
    assert v[:, 1::3] == pytest.approx(np.outer(-9.81 * t, np.ones(12)), rel=1e-9)
    assert np.abs(u[:, ::3]).max() < 1e-15
