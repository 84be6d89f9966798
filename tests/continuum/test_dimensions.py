"""One, two and three dimensions are one model: with Poisson's ratio 0 they move alike.

Rock that does not widen, under a load that is uniform over the face, has no motion across; one
hexahedron across then has the bar's nodes, masses and springs, each shared out over the corners of
its section. So the discrete systems are the same, and only round-off tells their runs apart.
"""

import numpy as np
import pytest

from cases.sampling import Clock

ROCK = {"rock__intact_poisson": 0.0}
MASS = {
    "rock__p_speed": None,
    "rock__s_speed": None,
    "rock__equivalent_modulus": 4.4e9,
    "rock__equivalent_poisson": 0.0,
}
LAYER = [{"y": 1.0, "spacing_stiffness": 4.4e8, "damping_ratio": 0.1}]
BREAK = {"tensile_strength": 3e4, "fracture_energy": 0.3}
SHAKEN = {"shape": "sine", "amplitude": 0.1, "period": 1e-3, "quantity": "velocity"}
#: The load ends in tension, so that joints let go.
SINE = {"shape": "sine", "amplitude": 1e5, "period": 1e-3}
JOINTS = {
    "elastic": {},
    "dashpots": {"joints__damping_ratio": 0.05, "ends": {"start": "quiet", "end": "matched"}},
    "soft layer, fixed end": {"soft_layers": LAYER, "ends__end": "fixed"},
    "no tension": {"joints": {"tension": False}},
    "no tension, dashpots": {"joints": {"tension": False, "damping_ratio": 0.05}},
    "softening": {"joints": BREAK},
    "prestress": {"joints": {"tension": False}, "prestress": {"normal": 3e4}},
    "weight, mass damping": {
        "gravity": {"direction": [0, 1, 0], "static": False},
        "damping__mass_proportional": 50.0,
        "ends__end": "fixed",
    },
    "shaken base": {"load": SHAKEN, "ends": {"start": "fixed", "end": "quiet"}},
}
CLOCK = Clock(4e-6, 2, 400)


def axial(run, dim: int) -> dict[str, np.ndarray]:
    """Return the waves along the axis [place, time], and the ledger."""
    waves = run.to_the_end().waves
    found = {"stress": waves["stress"], "energy": run.samples.energy}
    for name in ("velocity", "displacement"):
        found[name] = waves[name] if dim == 1 else waves[name][..., 1]
    return found


def across(run) -> np.ndarray:
    """Return everything that has moved across or been sheared, as numbers."""
    waves = run.waves
    motion = [waves[name][..., [0, 2]].ravel() for name in ("velocity", "displacement")]
    return np.concatenate([*motion, waves["shear"].ravel(), waves["rotation"].ravel()])


def compare(ready, scene, model):
    """Run a scene in all dimensions and compare, relative to the largest of each kind."""
    one = axial(ready(scene, model, 1, clock=CLOCK), 1)
    for dim in (2, 3):
        run = ready(scene, model, dim, clock=CLOCK)
        other = axial(run, dim)
        for name, waves in one.items():
            peak = np.abs(waves).max()
            assert peak > 0 or name == "stress"
            assert np.abs(other[name] - waves).max() < 1e-11 * peak, (dim, name)
        assert np.abs(across(run)).max() < 1e-11 * np.abs(one["stress"]).max()


@pytest.mark.parametrize("joints", JOINTS.values(), ids=JOINTS)
def test_jointed_rock_moves_alike_in_all_dimensions(joints, short, ready):
    scene = short(**{"load": SINE, **ROCK, **joints})
    compare(ready, scene, "jointed")


@pytest.mark.parametrize("order", [1, 3, 4])
def test_so_it_does_at_every_order(order, short, ready):
    scene = short(load=SINE, numerics__continuum__order=order, **ROCK)
    compare(ready, scene, "jointed")


@pytest.mark.parametrize("order", [1, 2, 3, 4])
def test_homogenised_rock_moves_alike_in_all_dimensions(order, short, ready):
    scene = short(load=SINE, numerics__continuum__order=order, soft_layers=LAYER, **MASS)
    compare(ready, scene, "equivalent")
