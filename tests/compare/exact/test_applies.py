"""Which exact solution answers yes to which scene, and the reason of every no."""

import numpy as np
import pytest

from jointwave.cases import SceneError
from jointwave.compare.engines import EXACT, solve, solver
from jointwave.compare.exact.bar import images
from jointwave.compare.exact.bar.bars import JOINTED
from jointwave.compare.exact.blocks import row_of_blocks
from jointwave.compare.solvers.record import Answer

BARRED, DAMPED = {"joints": {"tension": False}}, {"joints": {"damping_ratio": 0.02}}
LAYER = [{"y": 20.0, "spacing_stiffness": 4.375e8}]
CLOSES = [LAYER[0] | {"maximum_closure": 2e-3}]
STIFF = [{"y": 20.0, "spacing_stiffness": 4.375e10}]
RELAXES = {"rock": {"quality_factor": 20.0}}
QUIET = {"ends": {"start": "quiet", "end": "quiet"}}
STEP = {
    "load": {"shape": "step", "period": None},
    "time": {"duration": 0.02},
    "record": {"interval": 1e-4},
}
LONG = {"pillar": {"length": 1500.0}}
SHAKEN = {"ends": {"start": "fixed"}, "load": {"quantity": "velocity", "amplitude": 0.1}}
ACROSS = {"load": {"direction": [1.0, 0.0, 0.0]}}
SHEAR = ACROSS | QUIET | {"motion": {"rotation": "none"}}
UP = {"direction": [0.0, -1.0, 0.0], "static": False}
NO_SHEAR = "there is no plane shear wave: needs a load across and no rotation"
SLIPS = [{"y": 20.0, "cohesion": 1e5}]
STIFF_SLIPS = [{"y": 20.0, "cohesion": 1e5, "shear_stiffness": 1e12}]
WEAKENS = {"friction_angle": 35.0, "dynamic_friction_angle": 15.0, "weakening_distance": 1e-3}
SNAPS = {"y": 20.0, "shear_stiffness": 1e8} | WEAKENS
PRESSED = SHEAR | {"prestress": {"normal": 1e6}}
RATED = {"y": 20.0, "friction_angle": 30.0, "direct_effect": 0.01, "evolution_effect": 0.015}
RATED |= {"critical_slip_distance": 1e-4, "reference_rate": 1e-6}
DILATES = {"y": 20.0, "friction_angle": 35.0, "dilation_angle": 5.0, "dilation_distance": 1e-3}
SOFT_SHEAR = [*SLIPS, {"y": 30.0, "shear_stiffness": 1e8}]
SLOPE = {
    "pillar": {"length": 1.0},
    "joints": {"friction_angle": 20.0},
    "ends": {"end": "fixed"},
    "load": {"amplitude": 0.0},
    "gravity": {"direction": [0.6, 0.8, 0.0], "static": False},
    "record": {"stress": [0.5], "velocity": [0.25]},
}

YES = [
    ("lattice", DAMPED | QUIET | {"soft_layers": LAYER}),
    ("no-tension-chain", BARRED),
    ("jointed-bar", DAMPED | QUIET | {"soft_layers": LAYER}),
    ("equivalent-bar", DAMPED | QUIET | {"soft_layers": LAYER}),
    ("jointed-bar", DAMPED | RELAXES),
    ("equivalent-bar", DAMPED | RELAXES),
    ("images", STEP),
    ("images", QUIET),
    ("series", {}),
    ("kelvin-voigt", DAMPED),
    ("one-joint", QUIET | {"soft_layers": LAYER}),
    ("closing-joint", QUIET | {"soft_layers": CLOSES}),
    ("spatial-lattice", ACROSS | DAMPED | {"soft_layers": LAYER, "ends": {"end": "quiet"}}),
    ("slip-joint", SHEAR | {"soft_layers": SLIPS, "time": {"duration": 0.04}}),
    ("slip-joint", PRESSED | {"soft_layers": [{"y": 20.0} | WEAKENS], "time": {"duration": 0.04}}),
    ("slip-joint", PRESSED | {"soft_layers": [DILATES], "time": {"duration": 0.04}}),
    ("sliding-block", SLOPE),
]
NO = [
    ("lattice", BARRED, "a joint carries no tension"),
    ("lattice", LONG, "more than 2,000 blocks: the matrix exponential is dense"),
    ("no-tension-chain", {}, "every joint carries tension: see lattice"),
    ("no-tension-chain", BARRED | LONG, "more than 2,000 blocks: too many events"),
    ("jointed-bar", {"rock": {"intact_modulus": None}}, "rock.intact_modulus is not given"),
    ("lattice", RELAXES, "the rock has a quality_factor"),
    ("images", RELAXES, "the rock has a quality_factor"),
    ("jointed-bar", BARRED, "a joint carries no tension"),
    ("jointed-bar", SHAKEN, "the loaded end is fixed"),
    ("equivalent-bar", BARRED, "a joint carries no tension"),
    (
        "equivalent-bar",
        {"soft_layers": STIFF, "rock": {"intact_modulus": None}},
        "a soft layer is stiffer than the other joints",
    ),
    ("equivalent-bar", SHAKEN, "the loaded end is fixed"),
    ("images", BARRED, "a joint carries no tension"),
    ("images", DAMPED, "the joints are damped"),
    ("images", {"soft_layers": LAYER}, "a soft layer reflects"),
    ("images", SHAKEN, "the loaded end is fixed"),
    ("series", DAMPED, "the joints are damped"),
    ("series", QUIET, "an end is not free"),
    ("series", STEP, "the load is not a sine"),
    ("series", {"record": {"stress": [0.0, 20.0]}}, "every term is zero at the loaded end"),
    ("kelvin-voigt", BARRED, "a joint carries no tension"),
    ("kelvin-voigt", {}, "the rock is not damped"),
    ("kelvin-voigt", DAMPED | {"soft_layers": LAYER}, "a soft layer reflects"),
    ("kelvin-voigt", DAMPED | QUIET, "an end is not free"),
    ("kelvin-voigt", DAMPED | STEP, "the load is not a sine"),
    ("one-joint", BARRED, "a joint carries no tension"),
    ("one-joint", DAMPED, "the rock is damped"),
    ("one-joint", QUIET, "not exactly one joint differs in stiffness"),
    (
        "one-joint",
        QUIET | {"soft_layers": STIFF, "rock": {"intact_modulus": None}},
        "the layer is stiffer than the other joints",
    ),
    ("one-joint", {"soft_layers": LAYER}, "the far end reflects"),
    (
        "one-joint",
        SHAKEN | {"soft_layers": LAYER, "ends": {"start": "fixed", "end": "quiet"}},
        "the loaded end is fixed",
    ),
    (
        "one-joint",
        {"soft_layers": LAYER, "ends": {"end": "quiet"}},
        "the free start reflects back to a receiver at 0.02963 s",
    ),
    ("closing-joint", QUIET | {"soft_layers": LAYER}, "not exactly one joint has closure"),
    (
        "closing-joint",
        QUIET | {"joints": {"maximum_closure": 1e-3}},
        "not exactly one joint has closure",
    ),
    ("closing-joint", QUIET | DAMPED | {"soft_layers": CLOSES}, "the joints are damped"),
    (
        "closing-joint",
        QUIET | {"soft_layers": [*CLOSES, {"y": 30.0, "spacing_stiffness": 4.375e8}]},
        "another joint differs in stiffness",
    ),
    (
        "closing-joint",
        QUIET | {"soft_layers": [CLOSES[0] | {"maximum_closure": 1e-5}]},
        "the joint becomes stiffer than the other joints",
    ),
    ("closing-joint", {"soft_layers": CLOSES}, "the far end reflects"),
    ("one-joint", QUIET | {"soft_layers": CLOSES}, "a joint stiffens as it closes"),
    ("spatial-lattice", {}, "the motion is axial: see lattice"),
    ("spatial-lattice", ACROSS | BARRED, "a joint carries no tension"),
    ("spatial-lattice", ACROSS | {"soft_layers": SLIPS}, "a joint can slip"),
    ("spatial-lattice", ACROSS | {"motion": {"rotation": "finite"}}, "rotations are finite"),
    ("spatial-lattice", ACROSS | LONG, "more than 500 blocks: the matrix exponential is dense"),
    ("slip-joint", {}, NO_SHEAR),
    ("slip-joint", SHEAR | {"motion": {"rotation": "small"}}, NO_SHEAR),
    ("slip-joint", SHEAR | {"load": {"direction": [0.6, 0.8, 0.0]}}, NO_SHEAR),
    ("slip-joint", SHEAR | BARRED, "a joint carries no tension"),
    ("slip-joint", SHEAR | DAMPED, "the joints are damped"),
    ("slip-joint", SHEAR | {"ends": {}}, "an end reflects"),
    ("slip-joint", SHEAR, "not exactly one joint can slip"),
    ("slip-joint", SHEAR | {"joints": {"cohesion": 1e5}}, "not exactly one joint can slip"),
    (
        "slip-joint",
        SHEAR | {"soft_layers": [SLIPS[0] | {"residual_cohesion": 0.0}]},
        "slip weakens the joint",
    ),
    (
        "slip-joint",
        PRESSED | {"soft_layers": [RATED | {"cohesion": 1e4}]},
        "the rate-and-state joint has cohesion",
    ),
    (
        "slip-joint",
        SHEAR | {"soft_layers": [RATED]},
        "the rate-and-state joint has no normal stress",
    ),
    ("one-joint", PRESSED | {"soft_layers": [RATED]}, "friction depends on the rate of slip"),
    (
        "slip-joint",
        PRESSED | {"soft_layers": [SNAPS]},
        "friction falls with slip faster than the joint unloads",
    ),
    (
        "slip-joint",
        PRESSED | {"soft_layers": [DILATES | {"spacing_stiffness": 4.375e8}]},
        "the joint that dilates is softer than the others",
    ),
    (
        "slip-joint",
        SHEAR | {"soft_layers": SOFT_SHEAR},
        "a joint that cannot slip differs in stiffness",
    ),
    (
        "slip-joint",
        SHEAR | {"soft_layers": STIFF_SLIPS, "rock": {"intact_modulus": None}},
        "the joint is stiffer than the others",
    ),
    ("sliding-block", {}, "the pillar does not have two blocks"),
    ("sliding-block", SLOPE | {"gravity": UP}, "no sudden gravity compresses the joint"),
    (
        "sliding-block",
        SLOPE | {"gravity": SLOPE["gravity"] | {"static": True}},
        "no sudden gravity compresses the joint",
    ),
    ("sliding-block", SLOPE | {"load": {}}, "a load acts"),
    (
        "sliding-block",
        SLOPE | {"ends": {"start": "quiet", "end": "fixed"}},
        "the block is not free, or its base is not fixed",
    ),
    ("sliding-block", SLOPE | {"joints": {}}, "the joint does not slip by friction only"),
    (
        "sliding-block",
        SLOPE | {"pillar": {"length": 1.0, "side": 0.2}, "joints": {"friction_angle": 35.0}},
        "the block topples",
    ),
]
BREAKS = {"tensile_strength": 1e6, "fracture_energy": 1e3}
BEYOND = [
    (ACROSS, "the motion is spatial"),
    ({"load": {"direction": [0.0, -1.0, 0.0]}}, "the load acts against the axis"),
    ({"joints": BREAKS}, "a joint has a tensile strength"),
    ({"joints": {"maximum_closure": 1e-3}}, "a joint stiffens as it closes"),
    ({"gravity": UP, "ends": {"end": "fixed"}}, "gravity acts"),
    ({"damping": {"mass_proportional": 1.0}}, "the damping is proportional to mass"),
    ({"damping": {"local": 0.1}}, "the damping is local and not linear"),
]
AXIAL_ROCK = ("images", "series", "kelvin-voigt", "one-joint", "jointed-bar", "equivalent-bar")


@pytest.mark.parametrize("name, tables", YES)
def test_yes_means_that_it_solves_with_the_schema(scene, name, tables):
    at = scene(**{"time": {"duration": 0.02}, **tables})
    assert solver(name).applies(at) == Answer()
    result = solver(name).run(at)
    assert result.attrs["engine"] == name
    force = "shear" if "shear" in result else "stress"
    for variable, places in ((force, at.record.stress), ("velocity", at.record.velocity)):
        values = result[variable].values
        assert values.shape[0] == len(places)
        assert np.isfinite(values).all()
        assert np.abs(values).max() > 0


@pytest.mark.parametrize("name, tables, reason", NO)
def test_no_gives_the_reason(scene, name, tables, reason):
    at = scene(**tables)
    assert solver(name).applies(at) == Answer(reason)
    with pytest.raises(SceneError, match=reason.split(":")[0]):
        solve(name, at)


@pytest.mark.parametrize("tables, reason", BEYOND)
@pytest.mark.parametrize("name", AXIAL_ROCK)
def test_no_bar_takes_what_it_leaves_out(scene, name, tables, reason):
    assert solver(name).applies(scene(**tables)) == Answer(reason)


@pytest.mark.parametrize("tables, reason", [BEYOND[i] for i in (0, 2, -1)])
@pytest.mark.parametrize("name", ["lattice", "no-tension-chain"])
def test_the_chains_leave_out_slip_softening_and_local_damping(scene, name, tables, reason):
    assert solver(name).applies(scene(**tables)) == Answer(reason)


@pytest.mark.parametrize("tables, reason", [BEYOND[i] for i in (2, -1)])
@pytest.mark.parametrize("name, spatial", [("spatial-lattice", ACROSS), ("slip-joint", SHEAR)])
def test_spatial_solutions_leave_out_softening(scene, name, spatial, tables, reason):
    assert solver(name).applies(scene(**spatial, **tables)) == Answer(reason)


def test_friction_does_not_matter_while_nothing_shears_the_joints(scene):
    at = scene(joints={"friction_angle": 30.0, "cohesion": 0.0})
    assert row_of_blocks.applies(at) and images.applies(at) and JOINTED.applies(at)


def test_every_solution_is_asked_both_ways():
    of_pillars = {name for name in EXACT if "pillar" in solver(name).kinds}
    assert {name for name, _ in YES} == {name for name, *_ in NO} == of_pillars


def test_a_solution_works_without_sections_or_points(scene):
    for name, tables in YES:
        for record in ({"velocity": []}, {"stress": []}):
            record = tables.get("record", {}) | record | {"interval": 1e-4}
            at = scene(**{**tables, "time": {"duration": 0.004}, "record": record})
            result = solver(name).run(at)
            assert result.stress.shape[0] == len(at.record.stress)
            assert result.displacement.shape[0] == len(at.record.velocity)
