"""A fault weakened by a step of stress (SeisSol 688, TPV5): the right time after which a point has
slipped by D is that of two half-spaces; a row of blocks, behind whose front a step overshoots by a
quarter, slips too early, and says which rise it takes. `compare` once judged the fault by rigid
blocks although an exact solution of its joint exists."""

import re

import numpy as np
import pytest

import jointwave as jw
from jointwave.cases.warnings import warnings
from jointwave.cases.warnings.sources import OF_A_RISE
from jointwave.compare.misfit.ranking import reference_of

DENSITY, SPEED, BLOCK = 2670.0, 3464.0, 10.0
NORMAL, STEP, DISTANCE = 120e6, 81.6e6, 0.40  # Pa, Pa of the wave, m


def fault(rise, **rock):
    """Return a fault between blocks that a wave rising in this time (s) slips, 0: a step."""
    angles = np.degrees(np.arctan([0.677, 0.525])).tolist()
    load = {"amplitude": STEP, "quantity": "incident-stress", "direction": [1.0, 0.0, 0.0]}
    if rise:
        load |= {"shape": "triangle", "rise": rise, "decay": 1e6}
    joint = {"y": 800.0, "friction_angle": angles[0], "dynamic_friction_angle": angles[1]}
    return {
        "title": "a fault under a step",
        "pillar": {"length": 1600.0, "side": BLOCK, "block": BLOCK},
        "rock": {"density": DENSITY, "p_speed": 6000.0, "s_speed": SPEED} | rock,
        "motion": {"rotation": "none"},
        "prestress": {"normal": NORMAL},
        "soft_layers": [joint | {"weakening_distance": DISTANCE, "tension": True}],
        "load": {"shape": "step"} | load,
        "ends": {"start": "matched", "end": "matched"},
        "time": {"duration": 1.2},
        "record": {"stress": [820.0], "velocity": [795.0, 805.0], "interval": 1e-3},
    }


def weakened(found):
    """Return when the faces have slipped by D, s."""
    x = found.displacement.sel(axis="x").transpose("velocity_y", "time").values
    slip = np.abs(x[0] - x[1])
    return float(np.interp(DISTANCE, slip, found.time.values))


def test_a_step_on_a_joint_that_can_fail_names_the_rise_that_blocks_need():
    """40 blocks of 10 m at the speed of shear waves: 0.115 s."""
    said = [line for line in warnings(jw.load(fault(0))) if "'step'" in line]
    assert len(said) == 1 and f"rises in {OF_A_RISE * BLOCK / SPEED:.3g} s" in said[0]
    assert not [line for line in warnings(jw.load(fault(0.24))) if "'step'" in line]


@pytest.mark.parametrize("law", [{}, {"tension": False}, {"cohesion": 1e5, "tension": True}])
def test_a_step_in_a_rock_mass_warns_where_its_joints_can_fail(law, one_joint):
    """40 blocks of 0.5 m at 5 GPa and 2600 kg/m3, nu = 0.25: 4804 m/s."""
    scene = one_joint(numerics={"dem": {"block": 0.5}})
    scene["joint_sets"][0] |= law
    assert not any("'step'" in line for line in warnings(jw.load(scene)))
    scene["waves"][0]["shape"] = "step"
    del scene["waves"][0]["period"]
    said = [line for line in warnings(jw.load(scene)) if "'step'" in line]
    assert len(said) == bool(law)
    assert all("waves[0].shape" in line and "rises in 0.00416 s" in line for line in said)


@pytest.mark.parametrize("engine", ("dem", "continuum-equivalent"))
def test_a_fault_weakens_in_time_under_a_load_that_rises(engine):
    """Within 2 % of the exact time since the wave came, by a rise over 80 blocks, which
    overshoots by half as much as one over 40; by a step it is a fifth too early and more."""
    arrival = 800.0 / SPEED
    for rise in (0.24, 0):
        scene = jw.load(fault(rise))
        right = weakened(jw.simulate(scene, "slip-joint")) - arrival
        off = (weakened(jw.simulate(scene, engine)) - arrival) / right - 1
        assert abs(off) < 0.02 if rise else off < -0.2


def test_a_fault_is_judged_by_the_exact_solution_of_its_joint(jointwave, in_toml, tmp_path):
    """Both engines against the slipping joint between half-spaces, a model other than theirs."""
    coarse = {"pillar": {"length": 1600.0, "side": 20.0, "block": 20.0}}
    (file := tmp_path / "fault.toml").write_text(in_toml(fault(0) | coarse))
    said = jointwave("compare", file).out
    for engine in ("rigid blocks", "homogenised rock"):  # without an own error
        assert re.search(rf"(?m)^{engine} .* sliding joint, exact +modelling error +– ", said)
    assert "reference: sliding joint, exact (homogenised rock, exact)" in said


def test_without_intact_rock_an_exact_solution_comes_before_a_computed_one():
    """Rigid blocks and homogenised rock are two readings of the same speeds; with it, rock with
    every joint resolves more than the slipping joint between half-spaces."""
    there = ["dem", "continuum-equivalent", "continuum-jointed", "slip-joint"]
    for rock, reference in (({}, "slip-joint"), ({"intact_modulus": 9.6e10}, "continuum-jointed")):
        scene = jw.load(fault(0, **rock))
        able = there if rock else [name for name in there if name != "continuum-jointed"]
        assert {reference_of(name, able, scene).name for name in there[:2]} == {reference}
