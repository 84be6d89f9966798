"""One, two and three dimensions are one model: with Poisson's ratio 0 they move alike.

Rock that does not widen, under a load that is uniform over the face, has no motion across; one
hexahedron across then has the bar's nodes, masses and springs, each shared out over the corners of
its section. So the discrete systems are the same, and only round-off tells their runs apart.
"""

import numpy as np
import pytest

from jointwave.cases.sampling import Clock

ROUND_OFF = 1e-11

ROCK = {"rock__intact_poisson": 0.0}
MASS = {
    "rock__p_speed": None,
    "rock__s_speed": None,
    "rock__equivalent_modulus": 4.4e9,
    "rock__equivalent_poisson": 0.0,
}
LAYER = [{"y": 1.0, "spacing_stiffness": 4.4e8, "damping_ratio": 0.1}]
DURATION = 3e-3  # s; a wave in the rock passes the pillar nine times
#: The load ends in tension, so that joints let go.
SINE = {"shape": "sine", "amplitude": 1e5, "period": 1e-3}
JOINTS = {
    "no tension, dashpots, fixed end": {
        "joints": {"tension": False, "damping_ratio": 0.05},
        "ends": {"start": "quiet", "end": "fixed"},
    },
    "softening, prestress": {
        "joints": {"tensile_strength": 3e4, "fracture_energy": 0.3},
        "prestress": {"normal": 1e4},
    },
    "soft layer, shaken base, matched end, weight, mass damping": {
        "soft_layers": LAYER,
        "load": {"shape": "sine", "amplitude": 0.1, "period": 1e-3, "quantity": "velocity"},
        "ends": {"start": "fixed", "end": "matched"},
        "gravity": {"direction": [0, 1, 0], "static": False},
        "damping__mass_proportional": 50.0,
    },
}


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
    clock = common_clock(ready, scene, model)
    one = axial(ready(scene, model, 1, clock=clock), 1)
    for dim in (2, 3):
        run = ready(scene, model, dim, clock=clock)
        alike(axial(run, dim), one)
        assert np.abs(across(run)).max() < ROUND_OFF * np.abs(one["stress"]).max()


def common_clock(ready, scene, model) -> Clock:
    """Return half the critical step of three dimensions, the least, and a sample at each."""
    dt = ready(scene, model, 3, fraction=0.5, samples=1).time.dt
    return Clock(dt, 1, int(DURATION / dt))


def alike(found, expected):
    """Assert that waves differ by round-off alone, relative to the largest of each kind."""
    for name, waves in expected.items():
        peak = np.abs(waves).max()
        assert peak > 0, name
        assert np.abs(found[name] - waves).max() < ROUND_OFF * peak, name


@pytest.mark.parametrize(
    "joints",
    [
        pytest.param(j, marks=() if "prestress" in name else pytest.mark.slow, id=name)
        for name, j in JOINTS.items()
    ],
)
def test_jointed_rock_moves_alike_in_all_dimensions(joints, short, ready):
    compare(ready, short(**{"load": SINE, **ROCK, **joints}), "jointed")


@pytest.mark.parametrize("order", [1, 2, 3, 4])
def test_so_it_does_at_every_order(order, short, ready):
    compare(ready, short(load=SINE, numerics__continuum__order=order, **ROCK), "jointed")


@pytest.mark.parametrize("order", [1, 2, 3, 4])
def test_homogenised_rock_moves_alike_in_all_dimensions(order, short, ready):
    layer = [{"y": 1.0, "spacing_stiffness": 4.4e8}]
    scene = short(load=SINE, numerics__continuum__order=order, soft_layers=layer, **MASS)
    compare(ready, scene, "equivalent")


SLIDING = {"friction_angle": 30.0, "cohesion": 1e4, "damping_ratio": 0.02}


@pytest.mark.parametrize(
    ("dim", "way"),
    [pytest.param(2, [0.6, 0.8, 0.0], marks=pytest.mark.slow), (3, [0.48, 0.8, 0.36])],
)
def test_plane_sections_that_slide_move_as_the_bar_across(dim, way, short, ready):
    """Sections that move as one, motion.rotation = "none", are the bar with E along and G across,
    at any Poisson's ratio. Joints slide and open by the same law."""
    scene = short(
        load={**SINE, "direction": way},
        motion__rotation="none",
        joints={**SLIDING, "tension": False},
        ends__end="matched",
    )
    clock = common_clock(ready, scene, "jointed")
    one, other = (ready(scene, "jointed", d, clock=clock).to_the_end() for d in (1, dim))
    names = ("stress", "shear", "velocity", "displacement")
    alike({name: other.waves[name] for name in names}, {name: one.waves[name] for name in names})
    alike({"energy": other.samples.energy}, {"energy": one.samples.energy})
    friction, work = one.samples.energy[[5, 7], -1]
    assert friction > 0.01 * work
