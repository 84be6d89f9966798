"""Sides on rollers, along which rock slides freely and normal to which it does not move."""

import numpy as np
import pytest

from jointwave import cases
from jointwave.cases.errors import SceneError
from jointwave.compare.engines import applies, solve

ENGINES = ("dem", "continuum-jointed")
BED = {"name": "bed", "dip": 0.0, "spacing": 2.0, "normal_stiffness": 1e10, "shear_stiffness": 4e9}
ROCK = {"density": 2600.0, "intact_modulus": 2e10, "intact_poisson": 0.25}
WAVE = {"direction": [0.0, 1.0], "shape": "ricker", "amplitude": 1e5, "period": 0.01}
ROLLERS = dict.fromkeys(("left", "right", "bottom"), "roller")


def column(**tables):
    """Five beds of 2 m, 3 m wide."""
    every = {"title": "column", "domain": {"size": [3.0, 10.0]}, "rock": ROCK, "joint_sets": [BED]}
    every |= {
        "time": {"duration": 0.02},
        "record": {"points": [[1.5, 5.0]], "joints": [[1.5, 4.0]]},
        "numerics": {"continuum": {"size": 1.0}},
    }
    return cases.load_tables(every | tables)


def rising(beside, kind="P", **tables):
    """A wave that rises from a quiet bottom between two sides."""
    sides = {"bottom": "quiet", "left": beside, "right": beside}
    return column(waves=[WAVE | {"kind": kind}], boundaries=sides, **tables)


@pytest.mark.parametrize(
    ("engine", "scheme"), [("dem", "auto"), (ENGINES[1], "explicit"), (ENGINES[1], "implicit")]
)
def test_rock_beside_rollers_is_that_of_a_periodic_column(engine, scheme):
    """A P wave along them: nothing moves to the sides, and dashpots in the corners still act."""
    numerics = {"continuum": {"scheme": scheme, "size": 0.5}}
    found, expected = (
        solve(engine, rising(one, numerics=numerics)) for one in ("roller", "periodic")
    )
    for name in ("velocity", "stress", "gap", "traction"):
        scale = float(np.abs(expected[name]).max())
        np.testing.assert_allclose(found[name], expected[name], atol=1e-9 * scale, err_msg=name)


def test_the_exact_column_has_rollers_beside_p_waves_alone():
    assert applies("parallel-joints", rising("roller"))
    reason = applies("parallel-joints", rising("roller", "S")).reason
    assert reason == "the left is on rollers, and waves vary along it or move rock into it"
    with pytest.raises(SceneError, match="needs a fixed side, a quiet or roller one below it"):
        column(gravity={"direction": [0.6, -0.8]}, boundaries={"bottom": "roller"})


@pytest.mark.parametrize("stiffness", [1e10, 1e7])
@pytest.mark.parametrize("engine", ENGINES)
def test_rollers_bear_the_weight_and_confine_it(engine, stiffness):
    """sigma_yy = rho g h, and of deformable rock sigma_xx = nu / (1 - nu) sigma_yy; no shear.
    Joints a thousandth as stiff as blocks beside the rollers come to rest as well."""
    soft = BED | {"normal_stiffness": stiffness, "shear_stiffness": stiffness}
    touch = {"kind": "pressure", "side": "top", "shape": "step", "amplitude": 1e-3}
    scene = column(joint_sets=[soft], gravity={}, boundaries=ROLLERS, loads=[touch])
    stress = solve(engine, scene)["stress"].isel(point=0, time=-1).values
    weight = 2600.0 * 9.81 * 5.0
    beside = weight / 3 if engine != "dem" else 0.0
    np.testing.assert_allclose(stress, [beside, weight, 0.0], atol=1e-5 * weight)


@pytest.mark.parametrize("engine", ENGINES)
def test_rock_under_a_stress_with_shear_rests_on_rollers(engine):
    """The rock beyond goes on to bear the shear of the in-situ stress."""
    stress = {"xx": 3e6, "yy": 5e6, "xy": 1e6}
    found = solve(engine, column(prestress=stress, boundaries=ROLLERS))
    np.testing.assert_allclose(found["stress"].values[0], [[3e6, 5e6, 1e6]] * found.sizes["time"])
    assert np.abs(found["velocity"].values).max() < 1e-9
