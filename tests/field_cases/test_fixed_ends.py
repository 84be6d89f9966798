"""A wall is a wall in every solver: rock joins it without a joint (blocks and elements disagreed).

The exact bar with joints is the referee: rigid blocks tend to it with the square of their size
when the end block is joined to the wall by half a block of its rock. With half a joint there, the
frequency of 20 blocks was 2.4 % off, and its distance fell with the size alone."""

import numpy as np
import pytest

from jointwave import load, misfit, simulate
from jointwave.cases.loads import velocity_of
from jointwave.cases.material.calibrate import calibrate
from jointwave.dem.run import plan
from tests.field_cases.scenes import ENGINES, mass

L, RHO, E, G = 10.0, 2400.0, 8.64e10, 8.64e10 / 2.5
PILLAR = {
    "title": "a bar on a wall",
    "pillar": {"length": L, "side": 1.0, "block": 0.5},
    "rock": {"density": RHO, "p_speed": 2200.0, "s_speed": 800.0, "intact_modulus": E},
    "load": {"shape": "ricker", "amplitude": 1e5, "period": 0.05},
    "ends": {"start": "free", "end": "fixed"},
    "time": {"duration": 0.15},
    "record": {"stress": [5.0, L], "velocity": [0.5]},
    "numerics": {"dem": {"step_fraction": 0.1}},
}


def run(solver, **changes):
    return simulate(load(PILLAR, changes=changes), solver)


def test_blocks_on_a_wall_tend_to_the_jointed_bar():
    """At order 2; the continuum and the exact chain are the bar's and the blocks' to 1e-4."""
    far = []
    for block in (1.0, 0.5):
        bar, blocks = (run(s, **{"pillar.block": block}) for s in ("jointed-bar", "dem"))
        far.append(misfit(blocks, bar))
    assert far[1] < 2e-3 and far[0] / far[1] > 3.5
    assert misfit(run("continuum-jointed"), bar) < 1e-4
    assert misfit(blocks, run("lattice")) < 1e-4


@pytest.mark.parametrize("across", [False, True])
def test_motion_at_a_wall_is_the_walls(across):
    """Of blocks that carry all compliance in their joints the first centre lags by w d / 2 c."""
    wave = {"shape": "ricker", "amplitude": 0.1, "period": 0.02, "quantity": "velocity"}
    changes = {
        "rock.intact_modulus": 4.5e9, "motion.rotation": "none", "time.duration": 0.06,
        "load": wave | {"direction": [0.6, 0.8, 0.0] if across else [0.0, -1.0, 0.0]},
        "ends": {"start": "fixed", "end": "fixed"}, "record": {"velocity": [0.0, 0.125, 0.25, L]},
    }  # fmt: skip
    blocks = run("dem", **changes)
    base, t = velocity_of(load(PILLAR, changes=changes).load, 0.1), blocks.time.values
    for name, history in (("velocity", base.value(t)), ("displacement", base.impulse(t))):
        moved = blocks[name].transpose("velocity_y", "axis", "time").values
        expected = np.outer(changes["load"]["direction"] if across else [-1.0], history)
        assert moved[0] == pytest.approx(expected, abs=1e-12)
        assert not moved[3].any()
        assert moved[1] == pytest.approx((moved[0] + moved[2]) / 2, abs=1e-12)
        assert np.abs(moved[2] - moved[0]).max() > 0.1 * np.abs(moved[0]).max()
    exact = run("spatial-lattice" if across else "lattice", **changes)
    assert misfit(blocks, exact) < 1e-4


@pytest.mark.parametrize("solver", ENGINES)
@pytest.mark.parametrize("across", [False, True])
def test_static_deflection_on_a_wall(solver, across, plain):
    """Weight rho g y over the rock, and the joints between: none at the wall. Along the axis, and
    across it without rotation.

    Blocks have their weight at their centres, which adds rho g d^2 / 8 over the modulus to the
    deflection of the first centre, 1e-4 of it."""
    changes = {
        "load.amplitude": 0.0, "motion.rotation": "none", "time.duration": 0.01,
        "gravity": {"direction": [1.0, 0.0, 0.0] if across else [0.0, 1.0, 0.0]},
        "record": {"stress": [5.0], "velocity": [0.25]},
    }  # fmt: skip
    scene = load(PILLAR, changes=changes)
    p, u = calibrate(scene), simulate(scene, solver).displacement.values[0, 0]
    own = p.own_shear_stiffness if across else p.own_stiffness
    modulus = G if across else E
    expected = RHO * 9.81 * ((L**2 - 0.25**2) / 2 / modulus + (p.joint_y / own).sum())
    assert np.abs(u).max() == pytest.approx(expected, rel=2e-4)


def test_walls_of_rock_masses_follow_the_same_rule():
    """Blocks and elements: 20 beds, one of them cut off at the wall without a joint."""
    bed = {"name": "bed", "dip": 0.0, "spacing": 0.5, "through": [0.0, 0.5]}
    push = {"kind": "pressure", "side": "top", "shape": "ricker", "amplitude": 1e5, "period": 0.05}
    tables = mass(
        *(1.0, L),
        rock={"density": RHO, "intact_modulus": E, "intact_poisson": 0.0},
        joint_sets=[bed | {"normal_stiffness": 9e9, "shear_stiffness": 4e9}],
        boundaries={"bottom": "fixed"},
        loads=[push],
        time={"duration": 0.15},
        record={"points": [[0.5, 9.75]], "joints": [[0.5, 5.0]]},
        numerics={"continuum": {"size": 0.5}},
    )
    assert misfit(*(simulate(load(tables), engine) for engine in ENGINES)) < 0.01


def test_rock_that_is_all_but_rigid_does_not_decide_the_step():
    """Half a block is at most 100 times as stiff at a wall as with half a joint: 8 times the steps
    of a free end at most, sqrt((2 * 100 + 1) / 4) = 7.1 in a long chain."""
    stiff = load(PILLAR, changes={"rock.intact_modulus": 1e20})
    free = load(PILLAR, changes={"rock.intact_modulus": 1e20, "ends.end": "free"})
    steps = [plan(one).critical for one in (free, stiff)]
    assert steps[0] / steps[1] == pytest.approx(np.sqrt(201 / 4), rel=0.01)
