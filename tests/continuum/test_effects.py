"""Effects that are idle change no bit; those that are absent leave no array, no instruction."""

from functools import partial

import numpy as np
import pytest

from jointwave.cases.errors import SceneError
from jointwave.cases.material.calibrate import calibrate
from jointwave.continuum import applies, simulate
from jointwave.continuum.build import discretise
from jointwave.continuum.explicit.leapfrog import leapfrog_for
from jointwave.continuum.explicit.march import arguments, readings
from jointwave.continuum.implicit.balance import arguments as arguments_of_trials
from jointwave.continuum.implicit.balance import forces_for, implicit_matrices
from jointwave.continuum.implicit.pattern import empty_tangents
from jointwave.continuum.run import discrete_and_steps
from jointwave.continuum.state import state_at_rest
from jointwave.numerics.divergence import guard
from jointwave.results.arrays import copied

SUDDEN = {"direction": [0.0, 1.0, 0.0], "static": False}
SHAKEN = {"shape": "sine", "amplitude": 0.1, "period": 1e-3, "quantity": "velocity"}
LOST = {"residual_cohesion": 0.0, "friction_angle": 0.0}
NEVER = {"dynamic_friction_angle": 0.0, "weakening_distance": 1e-3}
WEIGHTLESS = {"direction": [0.6, 0.8, 0.0], "acceleration": 0.0, "static": False}
BREAKS = {"tensile_strength": 5e6, "fracture_energy": 2000.0}
SILENT = {"record__energy": False}


@pytest.fixture
def waves(ready):
    """Return a function: stress, velocity and displacement of a run whose model was changed."""

    def of(scene, model, change=lambda built: built):
        _, choice, _ = discrete_and_steps(scene, model)
        at = ready(scene, model, clock=choice.time)
        built = change(at.model)
        state = state_at_rest(built, scene.record.energy)
        at = at._replace(model=built, state=state).to_the_end()
        return np.concatenate([at.samples.stress, at.samples.velocity, at.samples.displacement])

    return of


@pytest.mark.parametrize(
    "idle",
    [
        {"joints": {"cohesion": 1e12}},
        {"joints": {"cohesion": 1e12} | LOST | NEVER, "gravity": WEIGHTLESS},
        {"joints": {"tensile_strength": 1e12, "fracture_energy": 1e18}},
        {"prestress": {"normal": 0.0}},
    ],
    ids=["cohesion", "lost cohesion, weakening, weight", "tensile strength", "prestress"],
)
def test_strength_that_nothing_reaches_changes_nothing(idle, short):
    """An oblique and eccentric blow in the plane, which opens and shears the joints."""
    blow = {"load__direction": [0.6, 0.8, 0.0], "load__at": [0.1, 0.0], "time__duration": 2e-3}
    one, other = (simulate(short(**blow, **changes), "jointed", 2) for changes in ({}, idle))
    for quantity in ("stress", "shear", "velocity", "rotation"):
        assert other[quantity].equals(one[quantity]), quantity


def test_ledger_changes_nothing(pillar, waves):
    scene = pillar(joints__damping_ratio=0.02, time__duration=0.06)
    silent = pillar(joints__damping_ratio=0.02, time__duration=0.06, **SILENT)
    assert np.array_equal(waves(scene, "jointed"), waves(silent, "jointed"))


@pytest.fixture
def count(short, ready, instructions):
    """Return a function that counts one kind of instruction in the kernel of a scene.

    of_runs : whether the kernel keeps the ledger and ends a run at its bounds, as those do that
    other tests compile; else it steps the motion alone.
    """

    def counted(kind, model="jointed", dim=None, of_runs=False, **changes):
        at = ready(short(**{} if of_runs else SILENT, **changes), model, dim)
        joints = at.model.interfaces
        constants = (None, None) if joints is None else (joints.parts, joints.directions)
        read = readings(at.model, at.state)
        limits = guard(np.inf) if of_runs else None
        given = arguments(at.model, at.state, at.samples, limits, read)
        kernel = leapfrog_for(*constants, shared=False)
        return instructions(kernel, (given, None, 0, 0, 1, at.model.dt), kind)

    return counted


@pytest.fixture
def in_runs(count):
    """Return `count` for kernels of runs."""
    return partial(count, of_runs=True)


def test_absent_effects_leave_no_instruction(count, in_runs):
    """Without no-tension nothing is compared, without a quiet end nothing is divided."""
    assert count("fcmp") == 0 < in_runs("fcmp") < in_runs("fcmp", joints__tension=False)
    assert count("fdiv") == in_runs("fdiv") == 0 < in_runs("fdiv", ends__end="quiet")
    assert count("fmul", "equivalent") < count("fmul") < count("fmul", joints__damping_ratio=0.02)


@pytest.mark.parametrize(
    ("kind", "changes"),
    [
        ("fcmp", {"joints": {"cohesion": 1e5}}),
        ("fcmp", {"joints": BREAKS}),
        ("fdiv", {"joints": {"cohesion": 1e5}}),
        ("fdiv", {"joints": BREAKS}),
    ],
    ids=["slip compares", "softening compares", "slip divides", "softening divides"],
)
def test_elastic_joints_in_space_compare_and_divide_nothing(kind, changes, count, in_runs):
    """Joints that hold, with no load before, are sums and products."""
    assert count(kind, dim=2) == 0
    assert in_runs(kind, dim=2) < in_runs(kind, dim=2, **changes)


@pytest.fixture
def in_trials(short, ready, instructions):
    """Return a function that counts one kind of instruction in the forces of implicit steps."""

    def counted(kind, dim=None, **changes):
        at = ready(short(**SILENT, **changes), "jointed", dim)
        joints, matrices = at.model.interfaces, implicit_matrices(at.discrete.body)
        now, tangents = copied(at.state), empty_tangents(at.model)
        given = arguments_of_trials(at.model, matrices, now, at.state, tangents, None, 1.0, 0.0)
        kernel = forces_for(joints.parts, joints.directions)
        return instructions(kernel, (given, 0.0), kind)

    return counted


def test_joints_of_the_bar_have_no_shear(in_trials):
    """Told by the trial forces of implicit steps: jumps and tractions along joints are not read."""
    assert in_trials("load", dim=1) < in_trials("load", dim=2)


def test_absent_effects_leave_no_instruction_in_trials(in_trials):
    """Dashpots, quiet ends and weight add to forces; joints that cannot open compare nothing."""
    assert in_trials("fcmp") < in_trials("fcmp", joints__tension=False)
    assert in_trials("fadd") < in_trials("fadd", joints__damping_ratio=0.02)
    assert in_trials("fmul") < in_trials("fmul", ends__end="quiet")
    assert in_trials("fadd") < in_trials("fadd", gravity=SUDDEN)


def test_absent_effects_of_the_rock_leave_no_instruction(count, in_runs):
    """Weight is one more sum; a base that does not move divides nothing. How many products
    mass-proportional damping adds depends on how many freedoms the machine moves at once: code
    that has it is another."""

    def rock(kind, **changes):
        return count(kind, "equivalent", **changes)

    fixed = in_runs("fdiv", "equivalent", ends__end="fixed")
    shaken = rock("fdiv", ends__start="fixed", load=SHAKEN)
    assert 0 < rock("fadd") < rock("fadd", gravity=SUDDEN)
    assert rock("fdiv") == fixed == 0 < shaken
    plain, damped = (
        [rock(kind, **changes) for kind in ("fmul", "fadd", "load")]
        for changes in ({}, {"damping__mass_proportional": 10.0})
    )
    assert plain != damped


def test_homogenised_rock_is_whole_but_for_soft_layers(pillar):
    layer = [{"y": 20.0, "spacing_stiffness": 4.375e8}, {"y": 30.0}]
    scene = pillar(soft_layers=layer)
    p = calibrate(scene)
    joints = discretise(scene, "equivalent").joints
    assert joints.area.size == 1
    excess = 1 / p.stiffness[39] - 1 / p.regular_stiffness
    assert joints.law.normal_stiffness == pytest.approx(1 / excess, rel=1e-12)


def test_homogenised_rock_keeps_a_joint_that_can_fail_as_stiff_as_ten(pillar):
    """A joint as stiff as the others is in the homogenised rock already."""
    scene = pillar(soft_layers=[{"y": 20.0, "cohesion": 1e5}], load__direction=[0.6, 0.8, 0.0])
    p = calibrate(scene)
    law = discretise(scene, "equivalent", 2).joints.law
    assert law.normal_stiffness == pytest.approx(10 * p.regular_stiffness, rel=1e-12)
    assert law.shear_stiffness == pytest.approx(10 * p.regular_shear_stiffness, rel=1e-12)


@pytest.mark.parametrize(
    ("changes", "model", "reason"),
    [
        ({"rock__intact_modulus": None}, "jointed", "needs rock.intact_modulus"),
        ({"joints__tension": False}, "equivalent", "no joints without tension"),
        ({"soft_layers": [{"y": 20.0, "spacing_stiffness": 9e9}]}, "equivalent", "stiffer"),
        ({"soft_layers": [{"y": 20.0, "damping_ratio": 0.1}]}, "equivalent", "ordinary joint"),
        (
            {
                "soft_layers": [{"y": 20.0, "shear_stiffness": 1e11}],
                "load__direction": [0.6, 0.8, 0.0],
            },
            "equivalent",
            "stiffer than the others in shear",
        ),
        ({"joints": BREAKS}, "equivalent", "no joints that slide or break"),
        (
            {"joints__friction_angle": 30.0, "load__direction": [0.6, 0.8, 0.0]},
            "equivalent",
            "no joints that slide",
        ),
        ({"damping__local": 0.5}, "jointed", "no local damping"),
        ({"damping__local": 0.5}, "equivalent", "no local damping"),
    ],
)
def test_model_that_does_not_apply_says_why(pillar, changes, model, reason):
    scene = pillar(**changes)
    assert reason in applies(scene, model)
    with pytest.raises(SceneError, match=reason):
        simulate(scene, model)


@pytest.mark.parametrize("model", ["jointed", "equivalent"])
@pytest.mark.parametrize(
    ("changes", "dim", "reason"),
    [
        ({"load__at": [0.1, 0.0]}, 1, "a bar does not bend or twist"),
        ({"load__direction": [0.0, 0.8, 0.6]}, 1, "a bar does not bend or twist"),
        ({"load__direction": [0.0, 0.8, 0.6]}, 2, "leaves the plane of x and y"),
        ({"load__at": [0.0, 0.1]}, 2, "leaves the plane of x and y"),
        ({"load__arm": 0.1}, 2, "leaves the plane of x and y"),
        (
            {"load__at": [0.1, 0.0], "motion__rotation": "finite"},
            3,
            "its strains and rotations are small",
        ),
    ],
)
def test_dimension_that_does_not_hold_the_motion_says_why(pillar, changes, dim, reason, model):
    assert reason in applies(pillar(**changes), model, dim)


@pytest.mark.parametrize("model", ["jointed", "equivalent"])
@pytest.mark.parametrize(
    ("changes", "dim"),
    [
        ({}, 1),
        ({"load__direction": [0.0, 0.8, 0.6], "motion__rotation": "none"}, 1),
        ({"load__direction": [0.6, 0.8, 0.0]}, 2),
        ({"load__at": [0.1, 0.0]}, 2),
        ({"load__arm": 0.1, "load__direction": [0.0, 0.0, 1.0]}, 2),
        ({"load__arm": 0.1}, 3),
        ({"load__at": [0.0, 0.1]}, 3),
    ],
)
def test_the_least_dimension_that_holds_the_motion_is_taken(pillar, changes, dim, model):
    scene = pillar(**changes)
    assert discretise(scene, model).kinematics.dim == dim
    assert applies(scene, model) == ""


@pytest.mark.parametrize("model", ["jointed", "equivalent"])
def test_friction_that_nothing_calls_for_is_no_obstacle(pillar, model):
    assert applies(pillar(joints__friction_angle=30.0), model) == ""


def test_soft_layer_without_tension_opens_in_the_homogenised_rock(pillar):
    layer = [{"y": 20.0, "spacing_stiffness": 4.375e8, "tension": False}]
    scene = pillar(soft_layers=layer)
    assert applies(scene, "equivalent") == ""
    stress = simulate(scene, "equivalent")["stress"]
    assert float(stress.min()) > -1e-10 * float(stress.max())


@pytest.mark.parametrize(("key", "value"), [("dim", 0), ("dim", 4), ("model", "discrete")])
def test_what_is_not_there_is_refused(pillar, key, value):
    with pytest.raises(SceneError, match=key):
        simulate(pillar(), **{key: value})
