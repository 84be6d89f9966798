"""Equations (4) to (7) of Guo & Li (2002) by hand and both ways round; dashpots and strength of
each joint.

A pillar of four blocks 2 m wide and 1.5 m thick: rock of 2000 kg/m3, E_eq = 8 GPa and nu = 1/4 with
joints, 24 GPa and 1/5 without. Engines and solutions start from these numbers, so that a comparison
of them sees no fault here."""

from math import pi, sqrt

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from jointwave.cases.material.calibrate import calibrate
from jointwave.cases.material.properties import NAMES
from jointwave.cases.material.rock import modulus_from_speeds, speeds_from_modulus
from jointwave.cases.schema.damping import Damping, Rayleigh
from jointwave.cases.schema.law_parts import UNLIMITED
from jointwave.cases.schema.scene import Scene

ROCK = {"density": 2000.0, "equivalent_modulus": 8e9, "equivalent_poisson": 0.25}
ROCK |= {"intact_modulus": 2.4e10, "intact_poisson": 0.2}
#: y = 4.5 m comes first; K_n = 6e9 / 1.5 = 4e9, K'_n = 4e9 / (1 + 1.5 * 4e9 / 2.4e10) = 3.2e9.
LAYER = {"y": 4.5, "spacing_stiffness": 6e9}
SOFT = LAYER | {"damping_ratio": 0.05}
#: As stiff as the others, under another dashpot.
STIFF = {"y": 1.5, "damping_ratio": 0.2}


def properties(**tables):
    """Return the properties of the pillar with tables put in place of its own."""
    own = {
        "title": "by hand",
        "pillar": {"length": 6.0, "side": 2.0, "block": 1.5},
        "rock": ROCK,
        "load": {"shape": "step", "amplitude": 3.0},
        "time": {"duration": 0.01},
        "record": {"stress": [3.0], "energy": False, "interval": 1e-3},
    }
    return calibrate(Scene.model_validate(own | tables))


def exact(value):
    """Hold a number to round-off."""
    return pytest.approx(value, rel=1e-14, abs=0)


def test_blocks_and_their_inertia():
    p = properties()
    assert (p.block_count, p.spacing, p.side, p.area) == (4, 1.5, 2.0, 4.0)
    assert p.joint_y.tolist() == [1.5, 3.0, 4.5]
    assert p.block_mass == 12000.0  # 2000 * 4 * 1.5
    assert p.inertia_across == 6250.0  # 12000 (2^2 + 1.5^2) / 12
    assert p.inertia_along == 8000.0  # 12000 * 2 * 2^2 / 12


def test_speeds_and_impedances():
    p = properties()
    assert p.shear_modulus == 3.2e9  # 8e9 / 2.5
    assert (p.bar_speed, p.impedance) == (2000.0, 4e6)
    assert p.shear_speed == exact(1264.9110640673518)  # sqrt(1.6e6)
    assert p.shear_impedance == exact(2529822.1281347036)


def test_numbers_of_the_paper(pillar):
    """nu, E_eq and S K_n from its speeds; G = rho c_s^2 comes back to the last bit."""
    p = calibrate(pillar())
    assert p.poisson == pytest.approx(0.4238, abs=5e-5)
    assert p.modulus == pytest.approx(4.375e9, rel=1e-3)
    assert 0.5 * p.own_stiffness[0] == pytest.approx(4.608e9, rel=1e-3)
    assert p.stiffness[0] / p.own_stiffness[0] == pytest.approx(0.949, abs=5e-4)
    assert p.bar_speed == pytest.approx(1350, rel=1e-3)  # not the P-wave speed, 2200
    assert (p.shear_modulus, p.shear_speed) == (2400.0 * 800.0**2, 800.0)


def test_stiffness_of_ordinary_joints():
    """1 / K_n = 1.5 (1 / 8e9 - 1 / 24e9); 1 / K_s = 1.5 (1 / 3.2e9 - 1 / 10e9)."""
    p = properties()
    assert p.stiffness == exact(np.full(3, 16e9 / 3))
    assert p.shear_stiffness == exact(np.full(3, 6.4e9 / 3))
    assert p.own_stiffness == exact(np.full(3, 8e9))
    assert p.own_shear_stiffness == pytest.approx(np.full(3, 1e9 / 0.31875), rel=1e-13)
    assert p.regular_stiffness == exact(16e9 / 3)
    assert p.regular_shear_stiffness == exact(6.4e9 / 3)
    assert p.regular_own_stiffness == exact(8e9)
    assert not p.excess_compliance.any()


def test_stiffness_of_soft_layers_stands_at_their_own_joint():
    """K'_s = 3.2e9 / 2.5; 1 / K_s = 1 / 1.28e9 - 1.5 / 10e9; excess 1 / 3.2e9 - 1.5 / 8e9."""
    p = properties(soft_layers=[SOFT, STIFF])
    assert p.soft.tolist() == [2, 0]
    assert p.stiffness == exact(np.array([16e9 / 3, 16e9 / 3, 3.2e9]))
    assert p.shear_stiffness == exact(np.array([6.4e9 / 3, 6.4e9 / 3, 1.28e9]))
    assert p.own_stiffness == exact(np.array([8e9, 8e9, 4e9]))
    own = np.array([1e9 / 0.31875, 1e9 / 0.31875, 1e9 / 0.63125])
    assert p.own_shear_stiffness == pytest.approx(own, rel=1e-13)
    assert p.excess_compliance == pytest.approx(np.array([0, 0, 1.25e-10]), rel=1e-13)


def test_ordinary_joints_are_known_where_all_are_soft():
    p = properties(soft_layers=[{"y": y, "spacing_stiffness": 7e9} for y in (1.5, 3.0, 4.5)])
    assert p.regular_own_shear_stiffness == pytest.approx(1e9 / 0.31875, rel=1e-13)


def test_given_stiffness_decides_the_moduli():
    """1 / E = 1 / 24e9 + 1 / (1.5 * 8e9) = 1 / 8e9; 1 / G = 1 / 10e9 + 1 / (1.5 * 10e9)."""
    rock, joints = ROCK | {"equivalent_modulus": 5e9}, {"normal_stiffness": 8e9}
    without = {k: v for k, v in ROCK.items() if k != "equivalent_modulus"}
    p = properties(rock=without, joints=joints)
    assert p.modulus == exact(8e9) and p.shear_modulus == exact(3.2e9)
    assert p.stiffness == exact(np.full(3, 16e9 / 3))
    p = properties(rock=rock, joints={"shear_stiffness": 1e10})
    assert p.modulus == 5e9 and p.shear_modulus == exact(6e9)
    assert p.shear_stiffness == exact(np.full(3, 4e9))
    assert p.own_shear_stiffness == pytest.approx(np.full(3, 1e10), rel=1e-13)


def test_shear_stiffness_of_a_layer_is_its_own_or_that_of_the_joints():
    """K'_s = 1e10 / (1 + 1.5 * 1e10 / 1e10) = 4e9, beside K'_n of the soft layer."""
    p = properties(soft_layers=[SOFT | {"shear_stiffness": 1e10}])
    assert p.shear_stiffness == exact(np.array([6.4e9 / 3, 6.4e9 / 3, 4e9]))
    assert p.stiffness[2] == exact(3.2e9)
    p = properties(soft_layers=[SOFT], joints={"shear_stiffness": 1e10})
    assert p.shear_stiffness == exact(np.full(3, 4e9)) and p.stiffness[2] == exact(3.2e9)


def test_rock_that_is_not_given_is_rigid():
    without = {k: v for k, v in ROCK.items() if not k.startswith("intact")}
    p = properties(rock=without, joints={"shear_stiffness": 2e9})
    assert p.own_stiffness is None and p.intact_modulus is None
    assert p.shear_stiffness == exact(np.full(3, 2e9)) and p.bar_speed == exact(2000.0)


def test_rock_as_soft_as_rock_and_joints_has_rigid_joints_in_shear():
    """G of the blocks is 10e9; 8e9 / (2 * 0.4) is that of the rock mass."""
    p = properties(rock=ROCK | {"equivalent_poisson": -0.6})
    assert p.shear_modulus == exact(1e10)
    p = properties(rock=ROCK | {"equivalent_poisson": -0.7})
    assert np.isinf(p.own_shear_stiffness).all()


def test_speeds_of_an_unbounded_medium():
    """2 : 1 is nu = 1/3, and E = 2 * 3000 * 1000^2 * 4/3."""
    assert modulus_from_speeds(2000.0, 1000.0, 3000.0) == exact((8e9, 1 / 3))
    assert speeds_from_modulus(8e9, 1 / 3, 3000.0) == exact((2000.0, 1000.0))


@given(e=st.floats(1e6, 1e12), poisson=st.floats(-0.5, 0.49), density=st.floats(500, 5000))
def test_modulus_to_speeds_and_back(e, poisson, density):
    p, s = speeds_from_modulus(e, poisson, density)
    assert modulus_from_speeds(p, s, density) == pytest.approx((e, poisson), rel=1e-6, abs=1e-9)


def test_tension_is_barred_joint_by_joint():
    layers = [SOFT | {"tension": True}, STIFF]
    p = properties(joints={"tension": False}, soft_layers=layers)
    assert p.tension.tolist() == [False, False, True]
    breaks = {"tensile_strength": 1e5, "fracture_energy": 10.0}
    p = properties(soft_layers=[SOFT | {"tension": False}, STIFF | breaks])
    assert p.tension.tolist() == [True, True, False]
    assert p.tensile_strength.tolist() == [1e5, UNLIMITED, UNLIMITED]
    assert p.critical_opening.tolist() == [2e-4, UNLIMITED, UNLIMITED]  # 2 * 10 / 1e5


DASHPOTS = {
    "each by its own ratio and stiffness": (0.03, [SOFT, STIFF], [3e-4, 4.5e-5, 9.68245836e-5]),
    "a layer takes the ratio of the joints": (0.03, [LAYER], [4.5e-5, 4.5e-5, 5.80947502e-5]),
    "a layer alone": (None, [SOFT, {"y": 1.5}], [0, 0, 9.68245836e-5]),
    "a stiff joint alone": (None, [STIFF], [3e-4, 0, 0]),
    "an undamped layer": (0.03, [SOFT | {"damping_ratio": 0.0}], [4.5e-5, 4.5e-5, 9e-6]),
    "none": (None, [{"y": 1.5}], None),
}


@pytest.mark.parametrize(("ratio", "layers", "eta"), DASHPOTS.values(), ids=DASHPOTS)
def test_time_constants_of_joints(ratio, layers, eta):
    """2 zeta sqrt(m / k), m = 2000 * 1.5 kg/m2: 0.06 sqrt(3000 / (16e9 / 3)) = 4.5e-5, 0.4 of the
    same root, 0.1 and 0.06 sqrt(3000 / 3.2e9). A fifth of the layer's compliance is rock, damped as
    elsewhere. The homogenised bar has no place for the dashpot of a joint as stiff as the others.
    """
    p = properties(joints={"damping_ratio": ratio}, soft_layers=layers)
    assert p.time_constant == (exact(4.5e-5) if ratio else None)
    if eta is None:
        assert p.joint_time_constant is None
    else:
        assert p.joint_time_constant == pytest.approx(np.array(eta), rel=1e-9, abs=0)
    assert p.damps_alone.tolist() == [STIFF in layers, False, False]


def test_rayleigh_damping():
    """0.6 / 20 + 0.004 * 10 / 2 = 0.05 at 10 rad/s; 0.6 / 60 + 0.004 * 30 / 2 = 0.07 at 30."""
    law = {"frequencies": [10 / (2 * pi), 30 / (2 * pi)], "ratios": [0.05, 0.07]}
    p = properties(damping={"rayleigh": law}, soft_layers=[LAYER])
    assert p.mass_damping == pytest.approx(0.6, rel=1e-13)
    assert p.time_constant == pytest.approx(0.004, rel=1e-13)
    assert p.joint_time_constant == pytest.approx(np.full(3, 0.004), rel=1e-13)


def test_rayleigh_without_the_round_off_of_one_that_is_zero():
    """Ratios proportional to frequencies, or to their inverse, except for the last digit."""
    law = {"frequencies": [1000.0, 7000.0]}
    p = properties(damping={"rayleigh": law | {"ratios": [0.017, 0.119]}})
    assert p.mass_damping is None
    assert p.time_constant == pytest.approx(0.017 / (1000 * pi), rel=1e-12)
    p = properties(damping={"rayleigh": law | {"ratios": [0.119, 0.017]}})
    assert p.mass_damping == pytest.approx(0.119 * 4000 * pi, rel=1e-12)
    assert p.time_constant is None and p.joint_time_constant is None


@given(
    low=st.floats(0.1, 1e3),
    factor=st.floats(1.5, 100.0),
    first=st.floats(1e-3, 0.5),
    share=st.floats(0.01, 0.99),
)
def test_rayleigh_has_the_ratios_that_were_asked_for(low, factor, first, share):
    """zeta = alpha / (2 omega) + beta omega / 2 at both; positive between ratios 1/r and r."""
    second = first * (1 / factor + share * (factor - 1 / factor))
    law = Rayleigh(frequencies=[low, factor * low], ratios=[first, second])
    alpha, beta = law.coefficients
    for f, ratio in zip(law.frequencies, law.ratios, strict=True):
        omega = 2 * pi * f
        assert alpha / (2 * omega) + beta * omega / 2 == pytest.approx(ratio, rel=1e-9)


def test_damping_of_the_motion_is_as_given_and_none_at_zero():
    p = properties(damping={"mass_proportional": 5.0, "local": 0.8})
    assert (p.mass_damping, p.local_damping, p.time_constant) == (5.0, 0.8, None)
    p = properties(damping={"mass_proportional": 0.0, "local": 0.0})
    assert p.mass_damping is None and p.local_damping is None and Damping().alpha is None


RUBS, HOLDS = {"friction_angle": 45.0}, {"cohesion": 2e5}
LESS, TAN_30 = {"friction_angle": 30.0}, 1 / sqrt(3)
BRITTLE = {"tensile_strength": 1e5, "fracture_energy": 30.0}
TOUGH = {"tensile_strength": 4e5, "fracture_energy": 50.0}
#: Keys of all joints and of the middle one, and what follows for the middle one and for the others;
#: w_c = 2 * 30 / 1e5, 2 * 50 / 4e5.
STRENGTHS = {
    "elastic": ({}, {}, {}),
    "friction": (RUBS, {}, {"friction": (1.0, 1.0)}),
    "cohesion": (HOLDS, {}, {"cohesion": (2e5, 2e5)}),
    "the friction of one": ({}, LESS, {"friction": (TAN_30, 0.0), "cohesion": (0.0, UNLIMITED)}),
    "the cohesion of one": ({}, {"cohesion": 30.0}, {"cohesion": (30.0, UNLIMITED)}),
    "a layer inherits": (RUBS, {"cohesion": 3e4}, {"friction": (1.0, 1.0), "cohesion": (3e4, 0.0)}),
    "slip of its own": (
        RUBS | HOLDS,
        LESS | {"cohesion": 1e5, "residual_cohesion": 4e4},
        {"friction": (TAN_30, 1.0), "cohesion": (1e5, 2e5), "residual_cohesion": (4e4, 2e5)},
    ),
    "softening of its own": (
        *(BRITTLE, TOUGH),
        {"tensile_strength": (4e5, 1e5), "critical_opening": (2.5e-4, 6e-4)},
    ),
    "all of it": (
        BRITTLE | RUBS | HOLDS | {"residual_cohesion": 1e5},
        {},
        {"friction": (1.0, 1.0), "cohesion": (2e5, 2e5), "residual_cohesion": (1e5, 1e5)}
        | {"tensile_strength": (1e5, 1e5), "critical_opening": (6e-4, 6e-4)},
    ),
}


@pytest.mark.parametrize(("joints", "layer", "found"), STRENGTHS.values(), ids=STRENGTHS)
def test_strength_of_every_joint(joints, layer, found):
    """Its own, that of [joints], or none: then it never slips and never breaks."""
    p = properties(joints=joints, soft_layers=[{"y": 3.0, **layer}])
    for name in NAMES:
        own, others = found.get(name, (None, None))
        expected = None if own is None else exact(np.array([others, own, others]))
        assert getattr(p, name) == expected, name
    with pytest.raises(AttributeError):
        p.strenght  # noqa: B018


def test_the_least_fracture_energy_that_is_named_is_accepted(pillar):
    """The refusal rounds its number up, so that it can be copied."""
    least = 1e5**2 / (2 * calibrate(pillar()).regular_stiffness)
    assert 0.57151 < least < 0.5716
    p = calibrate(pillar(**{"joints.tensile_strength": 1e5, "joints.fracture_energy": 0.5716}))
    assert (p.critical_opening > p.tensile_strength / p.stiffness).all()
