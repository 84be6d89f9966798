"""What the tests of blocks in the plane share: a periodic lattice, and scenes in few words."""

from pathlib import Path

import numpy as np
import pytest

from cases.material.contact_points import points_of
from cases.validate import validated
from dem.blocks.model import (
    Blocks,
    PlaneForm,
    PlaneModel,
    held_by,
)
from dem.blocks.tiles import contacts_of
from joints.law import Law, parts_of, table_of

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
    rule = np.array(points_of("gauss", points or 2))
    rule[0] -= 0.5
    beside = near @ turn.T + shifted, far @ turn.T + shifted
    second = None if points else rule[1] @ rule[0] ** 2
    contacts = contacts_of(pairs, *ends, normal @ turn.T, beside, len(at), second=second)
    mass = DENSITY * SIDE**2
    inertia = np.tile([mass, mass, mass * SIDE**2 / 6], (len(at), 1))
    omega = np.sqrt(4 * (K_N + K_S) * SIDE / mass)
    dt = form.pop("step", 0.25) * 2 / omega
    drag = 0.5 * dt * form.pop("mass_damping", 0.0)
    local, gravity = form.pop("local", 0.0), form.pop("gravity", (0.0, 0.0))
    blocks = Blocks(inertia, dt, (1 - drag) / (1 + drag), local, *gravity)
    held = form.pop("held", None)
    held = held and held_by(*held, inertia, dt)
    effects = drag > 0, local > 0, any(gravity), held is not None
    form = PlaneForm(parts_of(law), points, *effects, ledger)
    model = PlaneModel(
        form, blocks, contacts, table_of(law), rule[None], held,
        np.array(places, dtype=np.int64), np.zeros(0, dtype=np.int64),
    )  # fmt: skip
    return model, at, turn
