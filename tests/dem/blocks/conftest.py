"""What the tests of blocks in the plane share: a periodic lattice, and scenes in few words."""

from pathlib import Path

import numpy as np
import pytest

from jointwave.cases.material.contact_points import points_of
from jointwave.cases.validate import validated
from jointwave.dem.blocks.model import (
    Blocks,
    KernelFlags,
    PlaneModel,
    held_by,
)
from jointwave.dem.blocks.tiles import contacts_of
from jointwave.joints.law import Law, parts_of, table_of

SIDE, DENSITY, K_N, K_S = 0.5, 2600.0, 9e9, 4e9
NUMBER = np.array([6, 5])  # blocks along x and y


JOINT = {
    "name": "joint",
    "dip": 30.0,
    "through": [6.0, 5.0],
    "normal_stiffness": 1e10,
    "shear_stiffness": 4e9,
}
TABLES = {
    "title": "blocks",
    "domain": {"size": [12.0, 10.0]},
    "rock": {"density": 2600.0, "intact_modulus": 5e10},
    "joint_sets": [JOINT],
    "boundaries": dict.fromkeys(("left", "right", "bottom", "top"), "quiet"),
    "numerics": {"dem": {"block": 1.0}},
    "time": {"duration": 0.01},
    "record": {"points": [[4.3, 2.1], [8.2, 7.7]], "joints": [[6.1, 5.0]], "interval": 1e-4},
}
WAVE = {
    "kind": "P",
    "direction": [0.0, 1.0],
    "shape": "ricker",
    "amplitude": 1e6,
    "period": 0.004,
}


@pytest.fixture(scope="session")
def joint():
    """Return a joint of 1e10 and 4e9 Pa/m at 30 degrees with keys changed."""
    return lambda **keys: {k: v for k, v in (JOINT | keys).items() if v is not None}


@pytest.fixture(scope="session")
def wave():
    """Return a P wave upwards, a Ricker pulse of 1 MPa and 250 Hz, with keys changed."""
    return lambda **keys: WAVE | keys


@pytest.fixture(scope="session")
def rock_mass():
    """Return one joint in blocks of 1 m, 12 m by 10 m, quiet all around, with tables changed: keys
    of tables are added, None takes one out."""

    def scene(**changes):
        tables = dict(TABLES)
        for key, value in changes.items():
            both = value
            if isinstance(TABLES.get(key), dict) and isinstance(value, dict):
                both = {k: v for k, v in (TABLES[key] | value).items() if v is not None}
            tables[key] = both
        given = {key: value for key, value in tables.items() if value is not None}
        return validated(given, Path("scene.toml"), frozenset())

    return scene


@pytest.fixture
def lattice():
    """Return a function that gives a periodic patch of square blocks, or of bricks of a length, a
    height and an offset, with all joints alike, and the cell of each block [N, 2]."""
    return _lattice


def _lattice(law=None, points=0, ledger=False, brick=None, **form):
    law = law or Law(normal_stiffness=K_N, shear_stiffness=K_S)
    length, height, offset = brick or (SIDE, SIDE, 0.0)
    vectors = np.array([[length, 0.0], [offset * length, height]])
    at = np.stack(np.meshgrid(*map(np.arange, NUMBER), indexing="ij"), axis=-1).reshape(-1, 2)
    number = np.arange(len(at)).reshape(NUMBER)
    # Beside, above to the right, above to the left: cells between, normal, ends in sides.
    faces = [
        ((1, 0), (1, 0), (0.5, -0.5), (0.5, 0.5)),
        ((0, 1), (0, 1), (0.5, 0.5), (offset - 0.5, 0.5)),
        ((-1, 1), (0, 1), (offset - 0.5, 0.5), (-0.5, 0.5)),
    ]
    pairs, normal, near, far, ends = [], [], [], [], ([], [])
    for step, outward, *corners in faces[: 3 if offset else 2]:
        beyond = at + step
        pairs.append(np.stack([number.ravel(), number[tuple((beyond % NUMBER).T)]], axis=1))
        normal.append(np.broadcast_to(outward, at.shape))
        near.append(at @ vectors)
        far.append(beyond @ vectors)
        for end, corner in zip(ends, corners, strict=True):
            end.append(at @ vectors + np.array(corner) * (length, height))
    pairs, normal, near, far = map(np.concatenate, (pairs, normal, near, far))
    ends = [np.concatenate(end) for end in ends]
    rule = np.array(points_of("gauss", points or 2))
    rule[0] -= 0.5
    second = None if points else rule[1] @ rule[0] ** 2
    contacts = contacts_of(pairs, *ends, normal, (near, far), len(at), second=second)
    mass = DENSITY * length * height
    inertia = np.tile([mass, mass, mass * (length**2 + height**2) / 12], (len(at), 1))
    omega = np.sqrt(4 * (K_N + K_S) * max(length, height) / mass)
    dt = form.pop("step", 0.25) * 2 / omega
    drag = 0.5 * dt * form.pop("mass_damping", 0.0)
    local, gravity = form.pop("local", 0.0), form.pop("gravity", (0.0, 0.0))
    blocks = Blocks(inertia, dt, (1 - drag) / (1 + drag), local, *gravity)
    held = form.pop("held", None)
    held = held and held_by(*held, inertia, dt)
    effects = drag > 0, local > 0, any(gravity), held is not None
    form = KernelFlags(parts_of(law), points, *effects, ledger)
    none = np.zeros(0, dtype=np.int64)
    model = PlaneModel(form, blocks, contacts, table_of(law), rule[None], held, none, none)
    return model, at
