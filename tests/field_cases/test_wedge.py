"""A wedge on two planes, under its weight, at the limit of Hoek & Bray.

It slides along the line s in which the planes meet. Its weight less the part along s is borne by
both planes, N_A n_A + N_B n_B, and friction along s by their sum: it stands as long as

    N_A tan(phi) + N_B tan(phi) >= W s

(Hoek & Bray, Rock Slope Engineering, 1981, chapter 8, without cohesion and water). That no shear
acts across s is their assumption. Springs in shear a tenth as stiff as those across the planes
leave little of it; equal ones lock some in, and the wedge then stands 2 % beyond.
"""

from pathlib import Path

import numpy as np
import pytest

from jointwave.cases.errors import SceneError
from jointwave.cases.validate import validated
from jointwave.dem import simulate

PLUNGE = np.radians(20.0)  # of s, to the south
LINE = np.array([0.0, -np.cos(PLUNGE), -np.sin(PLUNGE)])
RISES = np.radians([45.0, 60.0])  # of the planes, to the east and to the west
DOWN = np.array([0.0, 0.0, -1.0])
THROUGH = [5.0, 5.0, 3.5]


def normals():
    """Return the upward normals of both planes [2, 3]."""
    along = np.stack([[1, -1] * np.cos(RISES), np.zeros(2), np.sin(RISES)], axis=1)
    found = np.cross(LINE, along)
    return found * (np.sign(found[:, 2]) / np.linalg.norm(found, axis=1))[:, None]


def least_friction():
    """Return the tangent of the friction angle at which the wedge just stands."""
    borne = np.linalg.lstsq(normals().T, (DOWN @ LINE) * LINE - DOWN, rcond=None)[0]
    assert (borne > 0.2).all()
    return DOWN @ LINE / borne.sum()


def wedge(friction):
    """Return a box whose planes part a wedge, two blocks at its sides and one below, all but the
    wedge fixed at sides; friction : a tangent."""
    law = {"normal_stiffness": 1e10, "shear_stiffness": 1e9, "tension": False}
    law |= {"friction_angle": np.degrees(np.arctan(friction)).item()}
    sets = [
        {"name": name, "through": THROUGH, "dip": np.degrees(np.arccos(n[2])).item()}
        | {"dip_direction": np.degrees(np.arctan2(n[0], n[1])).item() % 360}
        | law
        for name, n in zip("AB", normals(), strict=True)
    ]
    tables = {
        "title": "wedge",
        "domain": {"size": [10.0, 10.0, 6.0]},
        "rock": {"density": 2600.0, "intact_modulus": 5e10, "intact_poisson": 0.2},
        "joint_sets": sets,
        "gravity": {},
        "boundaries": dict.fromkeys(("left", "right", "bottom"), "fixed"),
        "time": {"duration": 0.01},
        "record": {"points": [[5.0, 5.0, 5.0]], "interval": 1e-3},
    }
    return validated(tables, Path("wedge.toml"), frozenset())


def test_it_stands_above_the_limit_and_slides_below():
    """By 1 %; what moves is the wedge, and the line says so."""
    limit = least_friction()
    found = simulate(wedge(1.01 * limit))
    assert found.attrs["blocks"] == 4 and abs(found.velocity).max() < 1e-6
    with pytest.raises(SceneError, match=r"no static state: the block at \[.*, 4\..*\] moves on"):
        simulate(wedge(0.99 * limit))
