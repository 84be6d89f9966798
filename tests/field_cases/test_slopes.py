"""Rock on slopes and around openings: Coulomb's law says what stays and how fast the rest slides.

Users of Yade (answers 4102, 4142), MuJoCo (3328), newton (943), cb-geo mpm (703, PR 3) and MOOSE
(18233) ask for these: a block stays for ever below its friction angle, what damps motion has no
part in a state without any, and nothing moves in it until something acts."""

from math import cos, radians, sin, tan

import numpy as np
import pytest

import jointwave as jw
from jointwave.cases.errors import SceneError
from jointwave.compare.misfit.metrics import misfit, pairings
from tests.field_cases.scenes import ENGINES, WEIGHT, G, mass, slope, stands

#: m/s, 1e-10 of what a wave of 1 MPa moves in rock of 4 MPa s/m.
STILL = 1e-10 * 1e6 / 4e6
DASHPOTS = {"damping_ratio": 0.2}
RAYLEIGH = {"rayleigh": {"frequencies": [100.0, 1000.0], "ratios": [0.05, 0.1]}}
COARSE = {"continuum": {"size": 1.0}}
SLIPS = {"friction_angle": 22.0, "tension": False}
LOSES = SLIPS | {"friction_angle": 21.0, "cohesion": 2e3, "residual_cohesion": 2e2}


def opening(rng):
    """Return an opening excavated in rock under stress, whose joints slide beside it, tables."""
    law = {"normal_stiffness": rng.uniform(1e10, 4e10), "shear_stiffness": 8e9}
    law |= SLIPS | {"friction_angle": rng.uniform(23.0, 25.0)}
    sets = [
        law | {"name": "bed", "dip": 20.0, "spacing": 2.0, "through": [5.0, 3.73]},
        law | {"name": "cross", "dip": -70.0, "spacing": 3.0, "through": [6.4, 5.0]},
    ]
    hole = [[4.0, 3.0], [6.0, 3.0], [6.0, 5.0], [4.0, 5.0]]
    return mass(
        *(10.0, 8.0),
        domain={"size": [10.0, 8.0], "openings": [hole], "non_convex": "cut", "least_width": 0.5},
        joint_sets=sets,
        prestress={"xx": rng.uniform(5e6, 6e6), "yy": rng.uniform(7e6, 8e6)},
        time={"duration": 2e-4},
        record={"points": [[5.0, 2.0], [7.0, 4.0]], "joints": [[7.0, 4.0]], "interval": 4e-5},
        numerics={"dem": {"static_tolerance": 1e-11}, "continuum": {"size": 3.0}},
    )


def slopes(rng):
    """Return a slope of random steepness with a few joints that dip either way, tables."""
    law, spacing = (SLIPS, LOSES)[rng.integers(2)], rng.uniform(0.9, 1.4)
    tables = slope(rng.uniform(5.0, 14.0), 0.0, 2.2, 3.0)
    tables["joint_sets"][0] |= law | {"spacing": spacing, "dip": rng.uniform(-5.0, 5.0)}
    tables["rock"]["intact_modulus"] = 5e9
    return tables


def damped(tables, by):
    """Return tables of the same rock with dashpots in its joints, or with other damping."""
    if by is RAYLEIGH:
        return tables | {"damping": by}
    return tables | {"joint_sets": [one | by for one in tables["joint_sets"]]}


def moved(found, name):
    """Return how far a quantity goes from where it starts."""
    return float(abs(found[name] - found[name].isel(time=0)).max())


@pytest.mark.parametrize("sides", ("periodic", "free"))
@pytest.mark.parametrize(
    "engine, scheme", [("dem", "auto"), (ENGINES[1], "explicit"), (ENGINES[1], "implicit")]
)
def test_a_damped_block_below_its_friction_angle_stays_and_bears_its_weight(engine, scheme, sides):
    """On 20 degrees with friction 21: of a slab without ends shear rho g h sin 20 = 8052.5 Pa and
    normal rho g h cos 20 = 22124 Pa at t = 0 and ever after. The corners of a block slip and hold.
    """
    tables = slope(20.0, 21.0)
    tables["joint_sets"][0]["damping_ratio"] = 0.05
    tables["numerics"]["continuum"]["scheme"] = scheme
    tables["boundaries"] |= {"left": sides, "right": sides}
    found = jw.simulate(jw.load(tables), engine)
    traction = abs(found.traction.isel(joint_point=0)).transpose("time", ...)
    if sides == "periodic":
        weight = WEIGHT * np.array([cos(radians(20.0)), sin(radians(20.0))])
        assert np.abs(traction - weight).max() < 1e-6 * WEIGHT
    assert moved(found, "traction") < 1e-6 * WEIGHT
    assert moved(found, "velocity") < STILL


@pytest.mark.parametrize("block", [None, 4.0, 100.0])
def test_a_block_that_is_not_cut_bears_its_weight_as_a_whole(block):
    found = jw.simulate(
        jw.load(slope(20.0, 21.0, numerics={} if block is None else {"dem": {"block": block}})),
        "dem",
    )
    weight = WEIGHT * np.array([cos(radians(20.0)), sin(radians(20.0))])
    assert found.traction.values[0, 0] == pytest.approx(weight, rel=1e-5)


@pytest.mark.parametrize(
    ("make", "seed", "by"), [(slopes, 0, DASHPOTS), (slopes, 1, DASHPOTS), (opening, 1, RAYLEIGH)]
)
@pytest.mark.parametrize("engine", ENGINES)
def test_a_static_state_is_the_same_however_motion_is_damped_and_stays(engine, make, seed, by):
    """Each of some hundred freedoms is in balance within 1e-10 of the forces at work. What is left
    of a force, 1e-10 F, moves rock of impedance Z and area A by 1e-10 F / (Z A): of a prestress of
    10 MPa, 1e-10 of what a wave as strong as that moves."""
    tables = make(np.random.default_rng(seed))
    still, other = (jw.simulate(jw.load(one), engine) for one in (tables, damped(tables, by)))
    for name in ("stress", "traction"):
        first, second = still[name].isel(time=0), other[name].isel(time=0)
        assert float(abs(first - second).max()) < 1e-8 * float(abs(first).max()), name
    for found in (still, other):
        assert moved(found, "velocity") < (10 * STILL if make is opening else STILL)


@pytest.mark.parametrize("engine", ENGINES)
def test_a_joint_below_its_strength_holds_for_ten_seconds(engine):
    """Shear of 2 % of the strength, set on at once: the joint comes to rest at W sin / (K_s A),
    within 0.1 % where the rock around it bends, and stays there to round-off."""
    tables = slope(1.0, 40.0, time={"duration": 10.0}, numerics={})
    tables["joint_sets"][0] |= {"damping_ratio": 0.3, "normal_stiffness": 1e9}
    tables["joint_sets"][0]["shear_stiffness"] = 4e8
    tables["gravity"]["static"], tables["record"]["interval"] = False, 1e-3
    slip = jw.simulate(jw.load(tables), engine).slip.values[0]
    exact = WEIGHT * sin(radians(1.0)) / 4e8
    assert abs(slip[-1]) == pytest.approx(exact, rel=1e-3)
    assert np.abs(slip[slip.size // 2 :] - slip[-1]).max() < 1e-12 * exact


@pytest.mark.parametrize("friction", [12.0, 30.0])
@pytest.mark.parametrize("engine", ENGINES)
def test_a_joint_that_weight_presses_bears_a_stress_that_it_could_not_alone(engine, friction):
    """Horizontal stress s in rock that is free beside and above: a joint at 10 degrees and at the
    depth h, which slides under s alone, bears the traction of s and rho g h, 3.8 degrees off its
    normal. It is stiff, so that the rock's own deformation puts little on it."""
    law = {"friction_angle": friction, "tension": False, "dip": 10.0, "through": [5.0, 5.0]}
    law |= {"name": "joint", "normal_stiffness": 1e13, "shear_stiffness": 1e13}
    tables = mass(
        *(10.0, 40.0),
        rock={"density": 2500.0, "intact_modulus": 4e10, "intact_poisson": 0.0},
        joint_sets=[law],
        prestress={"xx": 1.2e6, "yy": 0.0},
        boundaries={"bottom": "fixed"},
        time={"duration": 1e-3},
        record={"points": [[5.0, 30.0]], "joints": [[5.0, 5.0]], "interval": 1e-4},
        numerics={"continuum": {"size": 5.0}, "dem": {"static_tolerance": 1e-11}},
    )
    with pytest.raises(SceneError, match="'joint' slides under it"):
        jw.simulate(jw.load(tables), engine)
    found = jw.simulate(jw.load(tables | {"gravity": {}}), engine)
    dip, stress = radians(10.0), np.array([1.2e6, 2500.0 * G * 35.0])
    normal = np.array([-sin(dip), cos(dip)])
    exact = [stress * normal @ normal, stress * normal @ [cos(dip), sin(dip)]]
    assert np.abs(found.traction.values[0, 0]) == pytest.approx(np.abs(exact), rel=1e-5)
    assert moved(found, "velocity") < 10 * STILL


@pytest.mark.parametrize("engine", ENGINES)
def test_a_block_above_its_friction_angle_slides_as_coulomb_says(engine):
    """Gravity at once: once the block moves, its speed grows at g (sin 20 - cos 20 tan 19) =
    0.1811 m/s2; 1 % for the bounce on its joint, of period 2 pi sqrt(rho h / k_n) = 7 ms."""
    tables = slope(20.0, 19.0, time={"duration": 0.3}, numerics=COARSE)
    tables["gravity"]["static"] = False
    found = jw.simulate(jw.load(tables), engine)
    speed, times = found.velocity.values[0, :, 0], found.time.values
    slides = times > 0.1
    exact = G * (sin(radians(20.0)) - cos(radians(20.0)) * tan(radians(19.0)))
    assert np.polyfit(times[slides], speed[slides], 1)[0] == pytest.approx(exact, rel=0.01)


@pytest.mark.parametrize("engine", ENGINES)
def test_a_block_that_slides_slowly_slides(engine):
    """Friction of 19.99 degrees gives way at g (sin 20 - tan 19.99 cos 20) = 1.8 mm/s2, which is
    told from a residual that has not fallen yet; 20.01 degrees hold."""
    assert stands(jw.load(slope(20.0, 20.01, numerics=COARSE)), engine)
    assert not stands(jw.load(slope(20.0, 19.99, numerics=COARSE)), engine)


def test_the_acceleration_of_what_slides_is_said():
    with pytest.raises(SceneError, match=r"the rock at .* moves on, at 0\.181 m/s2"):
        jw.simulate(jw.load(slope(20.0, 19.0, numerics=COARSE)), "continuum-jointed")


def test_what_falls_is_not_compared_by_the_round_off_of_its_stress():
    """Rock on rollers that gravity pulls along them moves as a whole, by g t: what its displacement
    of 12 mm leaves of the last digits of stress was "100 % far off"."""
    bed = {"name": "bed", "dip": 0.0, "spacing": 1.0}
    tables = mass(
        *(4.0, 4.0),
        joint_sets=[bed | {"normal_stiffness": 1e9, "shear_stiffness": 5e8}],
        gravity={"direction": [1.0, 0.0], "static": False},
        boundaries={"bottom": "roller"},
        time={"duration": 0.05},
        record={"points": [[2.0, 2.5]], "interval": 1e-3},
        numerics=COARSE,
    )
    dem, rock = (jw.simulate(jw.load(tables), name) for name in ENGINES)
    for found in (dem, rock):
        expected = np.stack([G * found.time.values, 0 * found.time.values], axis=1)
        np.testing.assert_allclose(found.velocity.values[0], expected, atol=1e-9)
        assert float(abs(found.stress).max()) < 1e-3
    assert float(abs(rock.stress).max()) > 0
    assert misfit(dem, rock) < 1e-6 and misfit(rock, dem) < 1e-6
    assert {pair.place.quantity for pair in pairings(dem, rock)} == {"velocity", "displacement"}


def test_what_stays_at_rest_is_not_compared_by_its_round_off():
    """Blocks at rest creep by their static tolerance, 1e-9 m/s, the continuum by 1e-16: "5e+07 %
    far off". A change by a hundred thousandth of the static stress is a motion again."""
    scene = jw.load(slope(20.0, 21.0, numerics={}))
    dem, rock = (jw.simulate(scene, name) for name in ENGINES)
    assert (dem.velocity != 0).any() and (rock.velocity != 0).any()
    assert misfit(dem, rock) == 0 and not pairings(dem, rock)
    moved = dem.copy(deep=True)
    moved.stress[0, 1:, 1] += 1e-5 * float(abs(rock.stress[:, 0]).max())
    assert misfit(moved, rock) > 1
