"""Slopes and excavations at rest (Yade answers 4102, 4142; cb-geo mpm 703; MOOSE 18233): what damps
motion has no part in a state without any, and nothing moves in it until something acts.
"""

from functools import cache
from math import cos, radians, sin

import numpy as np
import pytest

import jointwave as jw

ENGINES = ("dem", "continuum-jointed")
DENSITY, HEIGHT, G = 2400.0, 1.0, 9.81
#: m/s, 1e-10 of what a wave of 1 MPa moves in rock of 4 MPa s/m.
STILL = 1e-10 * 1e6 / 4e6
DAMPED = (
    {"damping_ratio": 0.2},
    {"rayleigh": {"frequencies": [100.0, 1000.0], "ratios": [0.05, 0.1]}},
)
SLIPS = {"friction_angle": 22.0, "tension": False}
LOSES = SLIPS | {"friction_angle": 21.0, "cohesion": 2e3, "residual_cohesion": 2e2}


def slope(angle, scheme="implicit", size=(2.0, 2 * HEIGHT), **joints):
    """Return rock with joints across it on a slope of an angle (degrees), its base held, tables."""
    steep, one = radians(angle), {"name": "bed", "dip": 0.0, "through": [1.0, HEIGHT]}
    return {
        "title": "a slope",
        "domain": {"size": list(size)},
        "rock": {"density": DENSITY, "intact_modulus": 5e9},
        "joint_sets": [one | {"normal_stiffness": 2e9, "shear_stiffness": 1e9} | joints],
        "gravity": {"direction": [sin(steep), -cos(steep)], "acceleration": G},
        "boundaries": {"bottom": "fixed"},
        "time": {"duration": 2e-3},
        "record": {"points": [[1.0, 1.7]], "joints": [[1.0, HEIGHT]], "interval": 2e-4},
        "numerics": {
            "dem": {"block": 1.0, "static_tolerance": 1e-11},
            "continuum": {"size": 1.0, "scheme": scheme},
        },
    }


def opening(rng, scheme="implicit"):
    """Return an opening excavated in rock under stress, whose joints slide beside it, tables."""
    stiff = {"normal_stiffness": rng.uniform(1e10, 4e10), "shear_stiffness": 8e9}
    law = stiff | SLIPS | {"friction_angle": rng.uniform(23.0, 25.0)}
    sets = [
        law | {"name": "bed", "dip": 20.0, "spacing": 2.0, "through": [5.0, 3.73]},
        law | {"name": "cross", "dip": -70.0, "spacing": 3.0, "through": [6.4, 5.0]},
    ]
    hole = [[4.0, 3.0], [6.0, 3.0], [6.0, 5.0], [4.0, 5.0]]
    return {
        "title": "an opening",
        "domain": {"size": [10.0, 8.0], "openings": [hole]}
        | {"non_convex": "cut", "least_width": 0.5},
        "rock": {"density": 2600.0, "intact_modulus": 5e10},
        "joint_sets": sets,
        "prestress": {"xx": rng.uniform(5e6, 6e6), "yy": rng.uniform(7e6, 8e6)},
        "boundaries": dict.fromkeys(("left", "right", "bottom", "top"), "quiet"),
        "time": {"duration": 2e-4},
        "record": {"points": [[5.0, 2.0], [7.0, 4.0]], "joints": [[7.0, 4.0]]} | {"interval": 4e-5},
        "numerics": {
            "dem": {"static_tolerance": 1e-11},
            "continuum": {"size": 3.0, "scheme": scheme},
        },
    }


def pillar(rng, scheme="implicit"):
    """Return a pillar on a fixed end under its inclined weight, whose joints slide, tables."""
    steep, around = radians(rng.uniform(5.0, 20.0)), rng.uniform(0, 2 * np.pi)
    down = [sin(steep) * cos(around), cos(steep), sin(steep) * sin(around)]
    return {
        "title": "a pillar",
        "pillar": {"length": 1.0, "side": 1.0, "block": 0.5},
        "rock": {"density": DENSITY, "p_speed": 2200.0, "s_speed": 800.0, "intact_modulus": 2e10},
        "joints": dict(SLIPS),
        "ends": {"end": "fixed"},
        "gravity": {"direction": down},
        "time": {"duration": 2e-3},
        "record": {"stress": [0.5], "velocity": [0.25], "interval": 2e-4},
        "numerics": {
            "dem": {"static_tolerance": 1e-11},
            "continuum": {"scheme": scheme, "elements_per_block": 1},
        },
    }


def slopes(rng):
    """Return a slope of random steepness with a few joints that dip either way, tables."""
    law, spacing = dict((SLIPS, LOSES)[rng.integers(2)]), rng.uniform(0.9, 1.4)
    tables = slope(rng.uniform(5.0, 14.0), size=(2.2, 3.0), spacing=spacing, **law)
    tables["joint_sets"][0]["dip"] = rng.uniform(-5.0, 5.0)
    return tables


def damped(tables, by):
    """Return tables of the same rock with dashpots in its joints, or with other damping."""
    if "damping_ratio" not in by:
        return tables | {"damping": by}
    if "joints" in tables:
        return tables | {"joints": tables["joints"] | by}
    return tables | {"joint_sets": [one | by for one in tables["joint_sets"]]}


def moved(found, name):
    """Return how far a quantity goes from where it starts."""
    return float(abs(found[name] - found[name].isel(time=0)).max())


@cache
def at_rest(engine, make, seed, by):
    """Return the result of a random scene without a load, damped or, by None, not."""
    tables = make(np.random.default_rng(seed))
    return jw.simulate(jw.load(tables if by is None else damped(tables, DAMPED[by])), engine)


@pytest.mark.parametrize("sides", ("periodic", "free"))
@pytest.mark.parametrize(
    "engine, scheme", [("dem", "auto"), (ENGINES[1], "explicit"), (ENGINES[1], "implicit")]
)
def test_a_damped_block_below_its_friction_angle_stays_and_bears_its_weight(engine, scheme, sides):
    """On 20 degrees with friction 21: of a slab without ends shear rho g h sin 20 = 8052.5 Pa and
    normal rho g h cos 20 = 22124 Pa at t = 0 and ever after. The corners of a block slip and hold.
    """
    tables = slope(20.0, scheme, friction_angle=21.0, tension=False, damping_ratio=0.05)
    tables["boundaries"] |= {"left": sides, "right": sides}
    found = jw.simulate(jw.load(tables), engine)
    weight, steep = DENSITY * G * HEIGHT, radians(20.0)
    traction = abs(found.traction.isel(joint_point=0)).transpose("time", ...)
    if sides == "periodic":
        assert np.abs(traction - weight * np.array([cos(steep), sin(steep)])).max() < 1e-6 * weight
    assert moved(found, "traction") < 1e-6 * weight
    assert moved(found, "velocity") < STILL


@pytest.mark.parametrize("seed", range(2))
@pytest.mark.parametrize("make", (slopes, opening, pillar))
@pytest.mark.parametrize("engine", ENGINES)
def test_a_static_state_is_the_same_however_motion_is_damped(engine, make, seed):
    """Each of some hundred freedoms is in balance within 1e-10 of the forces at work."""
    still, other = at_rest(engine, make, seed, None), at_rest(engine, make, seed, seed)
    for name in {"stress", "shear", "traction"} & set(still.data_vars):
        first, second = still[name].isel(time=0), other[name].isel(time=0)
        assert float(abs(first - second).max()) < 1e-8 * float(abs(first).max()), name


@pytest.mark.parametrize("seed", range(2))
@pytest.mark.parametrize("make", (slopes, opening, pillar))
@pytest.mark.parametrize("engine", ENGINES)
def test_nothing_moves_from_a_static_state_before_anything_acts(engine, make, seed):
    """What the tolerance leaves of a force, 1e-10 F, moves rock of impedance Z and area A by 1e-10
    F / (Z A): of a prestress of 10 MPa, 1e-10 of what a wave as strong as that moves."""
    most = 10 * STILL if make is opening else STILL
    for by in (None, seed):
        assert moved(at_rest(engine, make, seed, by), "velocity") < most
