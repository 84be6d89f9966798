"""Lattices of blocks in periodic patches, in the plane and in space, against the closed form of
leapfrog's own plane waves.

A Bloch wave of the infinite lattice with frequency omega steps on at Omega, sin(Omega dt / 2) =
omega dt / 2, so that the kernel is held to round-off in all its branches.
"""

from itertools import product

import numpy as np
import pytest

from closed_forms.bloch import leapfrog, modes, periodic
from jointwave.cases.geometry.measure import frames_of
from jointwave.cases.partition.scene import blocks_of_domain
from jointwave.cases.schema.domain import Domain
from jointwave.dem.contacts.chunks import chunks_of
from jointwave.dem.contacts.faces import Contacts
from jointwave.dem.kernel.leapfrog import march
from jointwave.dem.kernel.model import (
    Blocks,
    KernelFlags,
    Model,
    held_by,
    samples_for,
    state_at_rest,
)
from jointwave.joints.law import law, parts_of, table_of

SIDE, DENSITY, NORMAL, SHEAR = 2.0, 2500.0, 3e9, 1.1e9
COUNT = {2: 12, 3: 6}
STEPS, TOLERANCE = 5000, 1e-10


def lattice(dim, points):
    """Return the model of a periodic lattice, with contact points or with whole faces."""
    count = COUNT[dim]
    numbers = np.arange(count**dim).reshape((count,) * dim)
    pairs = [
        np.stack([numbers.ravel(), np.roll(numbers, -1, axis=a).ravel()], 1) for a in range(dim)
    ]
    normals = np.repeat(np.eye(dim), count**dim, axis=0)
    area, second = SIDE ** (dim - 1), SIDE ** (dim + 1) / 12
    faces = Contacts(
        blocks=np.concatenate(pairs),
        area=np.full(len(normals), area),
        frame=frames_of(normals),
        arm=SIDE / 2 * np.stack([normals, -normals], axis=1),
    )
    gauss = SIDE / np.sqrt(12)
    places = np.array(list(product((gauss, -gauss), repeat=dim - 1)))
    rule = np.column_stack([places, np.full(len(places), area / len(places))])
    stiffness = np.full(len(normals), NORMAL)
    shear = np.full(len(normals), SHEAR)
    own = law(stiffness, None, np.ones(len(normals), dtype=bool), shear_stiffness=shear)
    # As blocks of scenes have them, whose kernel serves: some held, joints that differ, a ledger.
    parts, none = parts_of(own)._replace(planar=dim == 2, varied=True), np.zeros(0, dtype=int)
    form = KernelFlags(dim, True, parts, points, False, False, False, True, True)
    mass = DENSITY * SIDE**dim
    inertia = np.tile([mass] * dim + [mass * SIDE**2 / 6] * form.rotations, (count**dim, 1))
    moments = [second] if dim == 2 else [second, second, 0.0]
    dt = 0.3 / np.sqrt(16 * NORMAL * area / mass)
    chunks = chunks_of(
        faces,
        count**dim,
        form.freedoms,
        law=np.arange(len(normals)) % 2,
        points=np.tile(rule, (len(normals), 1, 1)) if points else None,
        second=None if points else np.tile(moments, (len(normals), 1)),
    )
    blocks = Blocks(inertia, dt, 1.0, 0.0, np.zeros(dim))
    one = np.diag(inertia[0])[None]
    held = held_by(0 * one, np.zeros(1, int), one, dt)
    return Model(form, blocks, chunks, table_of(own).repeat(2, axis=1), held, none, none)


@pytest.mark.parametrize("points", [False, True], ids=["faces", "points"])
@pytest.mark.parametrize("waves", [[1, 0], [2, 3], [1, 0, 0], [1, 2, 1]])
def test_bloch_waves_step_on_as_leapfrog_has_them(waves, points):
    """All branches of a lattice keep their form over 5,000 steps."""
    dim = len(waves)
    model, one = lattice(dim, points), blocks_of_domain(Domain(size=[SIDE] * dim), [])
    angles = 2 * np.pi * np.array(waves) / COUNT[dim]
    cell = periodic(one, DENSITY, np.array([[NORMAL, SHEAR]]), [], range(dim))
    frequencies, motions = modes(cell, angles / SIDE)
    places = np.stack(np.unravel_index(np.arange(COUNT[dim] ** dim), (COUNT[dim],) * dim), 1)
    dt = model.blocks.dt
    for omega, motion in zip(frequencies, motions.T, strict=True):
        stepped = leapfrog(omega, dt)
        shape = np.exp(1j * places @ angles)[:, None] * motion

        def at(time, shape=shape, stepped=stepped):
            return (shape * np.exp(-1j * stepped * time)).real

        state = state_at_rest(model)
        state.u[:], state.v[:] = at(0.0), (at(0.0) - at(-dt)) / dt
        march(model, state, samples_for(model, 0), 2 * STEPS, (1, 1 + STEPS))
        np.testing.assert_allclose(
            state.u, at(STEPS * dt), rtol=0, atol=TOLERANCE * np.abs(shape).max()
        )
