"""Which exact solution of pillars answers yes to which scene, and the reason of every no."""

import numpy as np
import pytest

from jointwave.cases import SceneError
from jointwave.compare.engines import EXACT, solve, solver
from jointwave.compare.solvers.record import Answer

BARRED, DAMPED = {"joints": {"tension": False}}, {"joints": {"damping_ratio": 0.02}}
LAYER = [{"y": 20.0, "spacing_stiffness": 4.375e8}]
CLOSES = [LAYER[0] | {"maximum_closure": 2e-3}]
STIFF = [{"y": 20.0, "spacing_stiffness": 4.375e10}]
RELAXES = {"rock": {"quality_factor": 20.0}}
QUIET = {"ends": {"start": "quiet", "end": "quiet"}}
STEP = {"load": {"shape": "step", "period": None}, "time": {"duration": 0.02}}
STEP |= {"record": {"interval": 1e-4}}
SHORT = {"pillar": {"length": 5.0}, "record": {"stress": [2.0], "velocity": [0.0, 3.3]}}
LONG = {"pillar": {"length": 1500.0}}
SHAKEN = {"ends": {"start": "fixed"}, "load": {"quantity": "velocity", "amplitude": 0.1}}
ACROSS = {"load": {"direction": [1.0, 0.0, 0.0]}}
SHEAR = ACROSS | QUIET | {"motion": {"rotation": "none"}}
UP = {"direction": [0.0, -1.0, 0.0], "static": False}
NO_SHEAR = "there is no plane shear wave: needs a load across and no rotation"
SLIPS = [{"y": 20.0, "cohesion": 1e5}]
SOFT_SLIPS = [LAYER[0] | SLIPS[0]]
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
    ("no-tension-chain", BARRED | SHORT),
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
    ("slip-joint", SHEAR | {"soft_layers": SOFT_SLIPS, "time": {"duration": 0.03}}),
    ("slip-joint", PRESSED | {"soft_layers": [{"y": 20.0} | WEAKENS], "time": {"duration": 0.04}}),
    ("slip-joint", PRESSED | {"soft_layers": [DILATES], "time": {"duration": 0.04}}),
    ("sliding-block", SLOPE),
]
BREAKS = {"tensile_strength": 1e6, "fracture_energy": 1e3}
#: Physics that hardly any solution covers, and the reason.
SPATIAL = (ACROSS, "the motion is spatial")
SOFTENS = ({"joints": BREAKS}, "a joint has a tensile strength")
LOCAL = ({"damping": {"local": 0.1}}, "the damping is local and not linear")
BEYOND = [
    SPATIAL,
    SOFTENS,
    LOCAL,
    ({"load": {"direction": [0.0, -1.0, 0.0]}}, "the load acts against the axis"),
    ({"joints": {"maximum_closure": 1e-3}}, "a joint stiffens as it closes"),
    ({"gravity": UP, "ends": {"end": "fixed"}}, "gravity acts"),
    ({"damping": {"mass_proportional": 1.0}}, "the damping is proportional to mass"),
]
PULLED = (BARRED, "a joint carries no tension")
SHAKES = (SHAKEN, "the loaded end is fixed")
LAYERED = ({"soft_layers": LAYER}, "a soft layer reflects")
RELAXED = (RELAXES, "the rock has a quality_factor")
RIGID = {"rock": {"intact_modulus": None}}
TWO_LAYERS = {"soft_layers": [*CLOSES, {"y": 30.0, "spacing_stiffness": 4.375e8}]}
LAYERED_DAMPED = {"pillar": {"length": 4.0}, "soft_layers": [{"y": 2.0, "damping_ratio": 0.1}]}
LAYERED_DAMPED |= {"record": {"stress": [2.0], "velocity": []}}
ONE_DIFFERS = "not exactly one joint differs in stiffness"
ONE_CLOSES = "not exactly one joint has closure"
ONE_SLIPS = "not exactly one joint can slip"
AT_REST = "a no-tension joint is in tension at rest"
NO_GRAVITY = "no sudden gravity compresses the joint"
HANGS = {"gravity": {"direction": [0.0, -1.0, 0.0]}, "ends": {"end": "fixed"}}
STATIC, SIDEWAYS = (
    SLOPE["gravity"] | more for more in ({"static": True}, {"direction": [1.0, 0.0, 0.0]})
)
TALL = {"pillar": {"length": 1.0, "side": 0.2}, "joints": {"friction_angle": 35.0}}
NO = {
    "lattice": [
        PULLED, RELAXED, SPATIAL, SOFTENS, LOCAL,
        (LONG, "more than 2,000 blocks: the matrix exponential is dense"),
    ],
    "no-tension-chain": [
        SPATIAL, SOFTENS, LOCAL,
        ({}, "every joint carries tension: see lattice"),
        (BARRED | LONG, "more than 2,000 blocks: too many events"),
        (BARRED | HANGS, AT_REST),
        (BARRED | {"prestress": {"normal": -1.0}}, AT_REST),
    ],
    "jointed-bar": [
        *BEYOND, PULLED, SHAKES,
        (RIGID, "rock.intact_modulus is not given"),
    ],
    "equivalent-bar": [
        *BEYOND, PULLED, SHAKES,
        ({"soft_layers": STIFF} | RIGID, "a soft layer is stiffer than the other joints"),
    ],
    "images": [
        *BEYOND, PULLED, SHAKES, LAYERED, RELAXED,
        (DAMPED, "the joints are damped"),
        (LAYERED_DAMPED, "the joints are damped"),
    ],
    "series": [
        *BEYOND,
        (DAMPED, "the joints are damped"),
        (QUIET, "an end is not free"),
        (STEP, "the load is not a sine"),
        ({"record": {"stress": [0.0, 20.0]}}, "every term is zero at the loaded end"),
    ],
    "kelvin-voigt": [
        *BEYOND, PULLED,
        ({}, "the rock is not damped"),
        (DAMPED | LAYERED[0], LAYERED[1]),
        (DAMPED | QUIET, "an end is not free"),
        (DAMPED | STEP, "the load is not a sine"),
    ],
    "one-joint": [
        *BEYOND, PULLED,
        (DAMPED, "the rock is damped"),
        (QUIET, ONE_DIFFERS),
        (QUIET | {"soft_layers": STIFF} | RIGID, "the layer is stiffer than the other joints"),
        (QUIET | {"soft_layers": [*LAYER, {"y": 30.0, "damping_ratio": 1.0}]},
         "another joint has a dashpot"),
        (LAYERED[0], "the far end reflects"),
        (LAYERED[0] | SHAKEN | {"ends": {"start": "fixed", "end": "quiet"}}, SHAKES[1]),
        (LAYERED[0] | {"ends": {"end": "quiet"}},
         "the free start reflects back to a receiver at 0.02963 s"),
        (QUIET | {"soft_layers": CLOSES}, "a joint stiffens as it closes"),
        (PRESSED | {"soft_layers": [RATED]}, "friction depends on the rate of slip"),
    ],
    "closing-joint": [
        (QUIET | LAYERED[0], ONE_CLOSES),
        (QUIET | {"joints": {"maximum_closure": 1e-3}}, ONE_CLOSES),
        (QUIET | DAMPED | {"soft_layers": CLOSES}, "the joints are damped"),
        (QUIET | TWO_LAYERS, "another joint differs in stiffness"),
        (QUIET | {"soft_layers": [CLOSES[0] | {"maximum_closure": 1e-5}]},
         "the joint becomes stiffer than the other joints"),
        ({"soft_layers": CLOSES}, "the far end reflects"),
    ],
    "spatial-lattice": [
        ({}, "the motion is axial: see lattice"),
        (ACROSS | BARRED, PULLED[1]),
        (ACROSS | SOFTENS[0], SOFTENS[1]),
        (ACROSS | LOCAL[0], LOCAL[1]),
        (ACROSS | {"soft_layers": SLIPS}, "a joint can slip"),
        (ACROSS | {"motion": {"rotation": "finite"}}, "rotations are finite"),
        (ACROSS | LONG, "more than 500 blocks: the matrix exponential is dense"),
    ],
    "slip-joint": [
        ({}, NO_SHEAR),
        (SHEAR | {"motion": {"rotation": "small"}}, NO_SHEAR),
        (SHEAR | {"load": {"direction": [0.6, 0.8, 0.0]}}, NO_SHEAR),
        (SHEAR | BARRED, PULLED[1]),
        (SHEAR | SOFTENS[0], SOFTENS[1]),
        (SHEAR | LOCAL[0], LOCAL[1]),
        (SHEAR | DAMPED, "the joints are damped"),
        (SHEAR | {"ends": {}}, "an end reflects"),
        (SHEAR, ONE_SLIPS),
        (SHEAR | {"joints": {"cohesion": 1e5}}, ONE_SLIPS),
        (PRESSED | {"soft_layers": [RATED | {"cohesion": 1e4}]},
         "the rate-and-state joint has cohesion"),
        (SHEAR | {"soft_layers": [RATED]}, "the rate-and-state joint has no normal stress"),
        (PRESSED | {"soft_layers": [SNAPS]},
         "friction falls with slip faster than the joint unloads"),
        (PRESSED | {"soft_layers": [DILATES | {"spacing_stiffness": 4.375e8}]},
         "the joint that dilates is softer than the others"),
        (SHEAR | {"soft_layers": SOFT_SHEAR}, "a joint that cannot slip differs in stiffness"),
        (SHEAR | {"soft_layers": [SLIPS[0] | {"shear_stiffness": 3.0719e9}]} | RIGID,
         "the joint is too stiff: the scene lasts 1.2e+07 times its Z / 2K"),
        (SHEAR | {"soft_layers": STIFF_SLIPS} | RIGID, "the joint is stiffer than the others"),
    ],
    "sliding-block": [
        ({}, "the pillar does not have two blocks"),
        (SLOPE | {"gravity": UP}, NO_GRAVITY),
        (SLOPE | {"gravity": STATIC}, NO_GRAVITY),
        (SLOPE | {"gravity": SIDEWAYS}, NO_GRAVITY),
        (SLOPE | {"load": {}}, "a load acts"),
        (SLOPE | {"ends": {"start": "quiet", "end": "fixed"}},
         "the block is not free, or its base is not fixed"),
        (SLOPE | {"joints": {}}, "the joint does not slip by friction only"),
        (SLOPE | TALL, "the block topples"),
    ],
}  # fmt: skip


@pytest.mark.parametrize("name, tables", YES)
def test_yes_means_that_it_solves_with_the_schema(scene, name, tables):
    """Also without sections or points."""
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
    for record in ({"velocity": []}, {"stress": []}):
        record = tables.get("record", {}) | record | {"interval": 1e-4}
        at = scene(**{**tables, "time": {"duration": 0.004}, "record": record})
        result = solver(name).run(at)
        assert result.stress.shape[0] == len(at.record.stress)
        assert result.displacement.shape[0] == len(at.record.velocity)


@pytest.mark.parametrize("name", NO)
def test_no_gives_the_reason(scene, name):
    for tables, reason in NO[name]:
        at = scene(**tables)
        assert solver(name).applies(at) == Answer(reason)
        with pytest.raises(SceneError, match=reason.split(":")[0]):
            solve(name, at)


@pytest.mark.parametrize("name", ["lattice", "images", "jointed-bar"])
def test_friction_does_not_matter_while_nothing_shears_the_joints(scene, name):
    assert solver(name).applies(scene(joints={"friction_angle": 30.0, "cohesion": 0.0}))


def test_every_solution_is_asked_both_ways():
    of_pillars = {name for name in EXACT if "pillar" in solver(name).kinds}
    assert {name for name, _ in YES} == set(NO) == of_pillars
