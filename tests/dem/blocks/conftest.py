"""What the tests of blocks in the plane share: a periodic square lattice."""

import numpy as np
import pytest

from cases.material.contact_points import points_of
from dem.blocks.model import (
    Blocks,
    PlaneForm,
    PlaneModel,
    adjacency_of,
    contacts_of,
    held_by,
)
from joints.law import Law, parts_of, table_of

SIDE, DENSITY, K_N, K_S = 0.5, 2600.0, 9e9, 4e9
NUMBER = np.array([6, 5])  # blocks along x and y


@pytest.fixture
def lattice():
    """Return a function that gives a periodic patch of square blocks with all joints alike, the
    place of each block [N, 2] in sides, and the rotation [2, 2] by which the patch is turned."""
    return _lattice


def _lattice(law=None, points=0, ledger=False, turned=0.0, shifted=(0.0, 0.0), places=(), **form):
    law = law or Law(normal_stiffness=K_N, shear_stiffness=K_S)
    c, s = np.cos(turned), np.sin(turned)
    turn = np.array([[c, -s], [s, c]])
    at = np.stack(np.meshgrid(*map(np.arange, NUMBER), indexing="ij"), axis=-1).reshape(-1, 2)
    number = np.arange(len(at)).reshape(NUMBER)
    pairs, centre, normal, far = [], [], [], []
    for axis in (0, 1):
        step = np.eye(2, dtype=int)[axis]
        beyond = at + step
        other = number[tuple((beyond % NUMBER).T)]
        pairs.append(np.stack([number.ravel(), other], axis=1))
        centre.append(SIDE * (at + step / 2))
        far.append(SIDE * beyond)
        normal.append(np.broadcast_to(step, at.shape))
    pairs, centre, normal, far = map(np.concatenate, (pairs, centre, normal, far))
    along = SIDE / 2 * np.stack([-normal[:, 1], normal[:, 0]], axis=1)
    near = SIDE * np.concatenate([at, at])
    ends = [(centre + sign * along) @ turn.T + shifted for sign in (-1, 1)]
    contacts = contacts_of(
        pairs, *ends, normal @ turn.T, (near @ turn.T + shifted, far @ turn.T + shifted)
    )
    mass = DENSITY * SIDE**2
    inertia = np.tile([mass, mass * SIDE**2 / 6], (len(at), 1))
    omega = np.sqrt(4 * (K_N + K_S) * SIDE / mass)
    dt = form.pop("step", 0.25) * 2 / omega
    drag = 0.5 * dt * form.pop("mass_damping", 0.0)
    local, gravity = form.pop("local", 0.0), form.pop("gravity", (0.0, 0.0))
    blocks = Blocks(inertia, dt, (1 - drag) / (1 + drag), local, *gravity)
    held = form.pop("held", None)
    held = held and held_by(*held, inertia, dt)
    effects = drag > 0, local > 0, any(gravity), held is not None
    form = PlaneForm(parts_of(law), points, *effects, ledger)
    rule = np.array(points_of("gauss", points) if points else np.zeros((2, 0)))
    rule[0] -= 0.5
    model = PlaneModel(
        form, blocks, contacts, adjacency_of(contacts.blocks, len(at)), table_of(law),
        rule, held, np.array(places, dtype=np.int64),
    )  # fmt: skip
    return model, at, turn
