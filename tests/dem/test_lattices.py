"""Lattices of blocks in periodic patches, in one, two and three dimensions, against the closed form
of leapfrog's own plane waves.

A Bloch wave of the infinite lattice with frequency omega steps on at Omega, sin(Omega dt / 2) =
omega dt / 2, so that the kernel is held to round-off in all its branches.
"""

from itertools import product

import numpy as np
import pytest

from jointwave.dem.contacts.chunks import chunks_of
from jointwave.dem.contacts.faces import Contacts, frames_of
from jointwave.dem.kernel import composition
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
COUNT = {1: 150, 2: 12, 3: 6}
STEPS, TOLERANCE = 5000, 1e-10


def lattice(dim, points, turns=True):
    """Return the model of a periodic lattice and the faces of one block, one along each axis."""
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
    shear = None if dim == 1 else np.full(len(normals), SHEAR)
    own = law(stiffness, None, np.ones(len(normals), dtype=bool), shear_stiffness=shear)
    form = KernelFlags(
        dim, turns and dim > 1, parts_of(own)._replace(planar=dim == 2), len(rule) * points,
        False, False, False, False, False, in_row=dim == 1,
    )  # fmt: skip
    mass = DENSITY * SIDE**dim
    inertia = np.tile([mass] * dim + [mass * SIDE**2 / 6] * form.rotations, (count**dim, 1))
    moments = {1: [], 2: [second], 3: [second, second, 0.0]}[dim]
    dt = 0.3 / np.sqrt(16 * NORMAL * area / mass)
    chunks = chunks_of(
        faces,
        count**dim,
        form.freedoms,
        points=np.tile(rule, (len(normals), 1, 1)) if points else None,
        second=None if points or not form.turns else np.tile(moments, (len(normals), 1)),
    )
    none = np.zeros(0, dtype=int)
    blocks = Blocks(inertia, dt, 1.0, 0.0, np.zeros(dim))
    return Model(form, blocks, chunks, table_of(own), None, none, none), faces


def jump_of(form, frame, arm):
    """Return the matrix from the motion of a block to its own part of the jump at a face's centre,
    in the frame of the face, and of the rotation."""
    dim = form.dim
    found = np.zeros((form.freedoms, form.freedoms))
    found[:dim, :dim] = frame
    if dim == 2 and form.turns:
        found[:2, 2], found[2, 2] = frame @ [-arm[1], arm[0]], 1.0
    if dim == 3 and form.turns:
        found[:3, 3:] = frame @ -np.cross(arm, np.eye(3)).T  # theta x arm
        found[3:, 3:] = frame
    return found


def bloch(model, faces, angles):
    """Return frequencies, rad/s, and motions of the waves that advance by these angles a block."""
    form, dim = model.form, model.form.dim
    area, second = SIDE ** (dim - 1), SIDE ** (dim + 1) / 12
    springs = [NORMAL * area] + [SHEAR * area] * (dim - 1)
    if form.turns:
        springs += [[], [NORMAL * second], [2 * SHEAR * second, NORMAL * second, NORMAL * second]][
            dim - 1
        ]
    matrix = np.zeros((form.freedoms, form.freedoms), dtype=complex)
    for a, angle in enumerate(angles):
        k = a * len(model.blocks.inertia)
        of_i, of_j = (jump_of(form, faces.frame[k], arm) for arm in faces.arm[k])
        both = np.exp(1j * angle) * of_j - of_i
        matrix += both.conj().T @ np.diag(springs) @ both
    root = 1 / np.sqrt(model.blocks.inertia[0])
    squares, motions = np.linalg.eigh(root[:, None] * matrix * root)
    return np.sqrt(np.maximum(squares, 0)), (root[:, None] * motions).T


@pytest.mark.parametrize("points", [False, True], ids=["faces", "points"])
@pytest.mark.parametrize(
    ("dim", "waves"),
    [(1, [1]), (1, [70]), (2, [1, 0]), (2, [2, 3]), (3, [1, 0, 0]), (3, [1, 2, 1])],
)
def test_bloch_waves_step_on_as_leapfrog_has_them(dim, waves, points):
    """All branches of a lattice keep their form over 5,000 steps."""
    model, faces = lattice(dim, points)
    angles = 2 * np.pi * np.array(waves) / COUNT[dim]
    places = np.stack(np.unravel_index(np.arange(COUNT[dim] ** dim), (COUNT[dim],) * dim), 1)
    dt = model.blocks.dt
    for omega, motion in zip(*bloch(model, faces, angles), strict=True):
        stepped = 2 / dt * np.arcsin(omega * dt / 2)
        shape = np.exp(1j * places @ angles)[:, None] * motion

        def at(time, shape=shape, stepped=stepped):
            return (shape * np.exp(-1j * stepped * time)).real

        state = state_at_rest(model)
        state.u[:], state.v[:] = at(0.0), (at(0.0) - at(-dt)) / dt
        march(model, state, samples_for(model, 0), 2 * STEPS, (1, 1 + STEPS))
        np.testing.assert_allclose(
            state.u, at(STEPS * dt), rtol=0, atol=TOLERANCE * np.abs(shape).max()
        )


def composed(model, dt):
    """Return a model with a ledger whose steps of dt (s) are composed; one block may be pushed."""
    stages, f = composition.table(dt), model.form.freedoms
    form = model.form._replace(stages=len(stages), ledger=True, held=True)
    masses = model.blocks.inertia[:, :, None] * np.eye(f)
    pushed = np.array([7])
    return model._replace(
        form=form,
        blocks=model.blocks._replace(dt=dt, stages=stages),
        held=held_by(np.zeros((1, f, f)), pushed, masses, dt),
        places=pushed,
    )


def orders(errors):
    """Return the order from each step to its half."""
    return -np.diff(np.log2(errors), axis=0)


@pytest.mark.parametrize("points", [False, True], ids=["faces", "points"])
@pytest.mark.parametrize("waves", [[70], [2, 3], [1, 2, 1]])
def test_composed_steps_are_of_fourth_order(waves, points):
    """Standing waves of all branches at once against their frequencies; their energy swings by the
    same order."""
    dim, errors = len(waves), []
    model, faces = lattice(dim, points)
    angles = 2 * np.pi * np.array(waves) / COUNT[dim]
    places = np.stack(np.unravel_index(np.arange(COUNT[dim] ** dim), (COUNT[dim],) * dim), 1)
    frequencies, motions = bloch(model, faces, angles)
    shapes = (np.exp(1j * places @ angles)[:, None] * motions[:, None]).real
    dt, steps = 4 * model.blocks.dt, 40
    exact = np.tensordot(np.cos(frequencies * steps * dt), shapes, axes=1)
    for halved in (1, 2, 4):
        stepped = composed(model, dt / halved)
        state, samples = state_at_rest(stepped), samples_for(stepped, steps)
        state.u[:] = shapes.sum(axis=0)
        march(stepped, state, samples, halved, (0, steps * halved))
        energy = samples.energy[:2].sum(axis=0)
        errors.append([np.abs(state.u - exact).max(), np.ptp(energy)])
    assert orders(errors) == pytest.approx(4.0, abs=0.2)


@pytest.mark.parametrize("dim", [1, 2, 3])
def test_forces_and_their_work_in_composed_steps_are_of_fourth_order(dim):
    """A block that is pushed and turned for a while: its motion, and the ledger of all."""
    model, _ = lattice(dim, False)
    dt, steps, form, errors, last = 4 * model.blocks.dt, 40, model.form, [], []
    for halved in (1, 2, 4, 8):
        stepped = composed(model, dt / halved)
        state, samples = state_at_rest(stepped), samples_for(stepped, steps + 1)
        at = composition.instants(np.arange(steps * halved + 1)) / halved
        drive = 1e5 * np.sin(3 * at / steps)[:, None, None] * np.ones((1, form.freedoms))
        march(stepped, state, samples, halved, (0, steps * halved + 1), drive)
        energy, work = samples.energy[:-1].sum(axis=0), samples.energy[-1]
        errors.append(np.abs(energy - work).max() / work.max())
        last.append(np.append(samples.displacement[0, :, -1], samples.velocity[0, :, -1] / 1e3))
    assert errors[1] < 1e-4
    assert orders(errors[1:]) == pytest.approx(4.0, abs=0.2)
    moved = np.abs(np.diff(last, axis=0)).max(axis=1)
    assert orders(moved) == pytest.approx(4.0, abs=0.3)


def test_square_lattice_has_its_three_branches():
    """The assembled wave problem is the closed form of a square lattice."""
    model, faces = lattice(2, False)
    x, y = 0.7, 1.9
    k_n, k_s, k_b = NORMAL * SIDE, SHEAR * SIDE, NORMAL * SIDE**3 / 12
    matrix = np.zeros((3, 3), dtype=complex)
    matrix[0, 0] = 2 * k_n * (1 - np.cos(x)) + 2 * k_s * (1 - np.cos(y))
    matrix[1, 1] = 2 * k_s * (1 - np.cos(x)) + 2 * k_n * (1 - np.cos(y))
    matrix[0, 2], matrix[1, 2] = -1j * k_s * SIDE * np.sin(y), 1j * k_s * SIDE * np.sin(x)
    matrix[2, :2] = matrix[:2, 2].conj()
    matrix[2, 2] = k_s * SIDE**2 / 2 * (2 + np.cos(x) + np.cos(y))
    matrix[2, 2] += 2 * k_b * (2 - np.cos(x) - np.cos(y))
    root = 1 / np.sqrt(model.blocks.inertia[0])
    expected = np.sqrt(np.linalg.eigvalsh(root[:, None] * matrix * root))
    np.testing.assert_allclose(bloch(model, faces, [x, y])[0], expected, rtol=1e-12)


def test_cubic_lattice_has_its_six_branches_along_x():
    """The assembled wave problem is the closed form of a cubic lattice."""
    model, faces = lattice(3, False)
    mass, inertia = model.blocks.inertia[0][[0, 5]]
    area, second, X = SIDE**2, SIDE**4 / 12, 0.9
    k_n, k_s, k_b, k_t = NORMAL * area, SHEAR * area, NORMAL * second, 2 * SHEAR * second
    long = 2 * k_n * (1 - np.cos(X)) / mass
    twist = (2 * k_t * (1 - np.cos(X)) + 2 * k_s * SIDE**2) / inertia
    pair = np.array(
        [
            [2 * k_s * (1 - np.cos(X)) / mass, k_s * SIDE * np.sin(X) / np.sqrt(mass * inertia)],
            [0.0, (k_s * SIDE**2 / 2 * (3 + np.cos(X)) + 2 * k_b * (1 - np.cos(X))) / inertia],
        ]
    )
    bent = np.linalg.eigvalsh(pair, UPLO="U")
    expected = np.sqrt(np.sort([long, twist, *bent, *bent]))
    np.testing.assert_allclose(bloch(model, faces, [X, 0, 0])[0], expected, rtol=1e-12)
