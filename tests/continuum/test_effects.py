"""Rock pays only for what its scene calls for, proved on what is compiled, without a clock."""

import pytest

from jointwave.continuum import simulate
from jointwave.continuum.stepping import leapfrog
from jointwave.continuum.stepping.explicit import leapfrog_for
from jointwave.continuum.stepping.tractions import forces_for

SQRT = r"(?:tail )?call \S+ @llvm\.sqrt\S*"
INCREF = r"(?:tail )?call void @NRT_incref\(\S+"
BLOW = {"load__direction": [0.6, 0.8, 0.0], "load__at": [0.1, 0.0], "time__duration": 2e-3}
SLIP = {"friction_angle": 20.0, "cohesion": 1e4}
BREAKS = {"tensile_strength": 5e6, "fracture_energy": 2000.0}
CLOSES = {"maximum_closure": 1e-4}
SILENT = {"record": {"energy": False}, "numerics__continuum__scheme": "explicit"}


@pytest.fixture
def kernel(short, monkeypatch):
    """Return a function of a scene's keys: the flags of the explicit steps that it takes, and what
    their kernel is given. None is taken."""
    found = []

    def seen(flags):
        return lambda *given: found.append((flags, given))

    monkeypatch.setattr(leapfrog, "leapfrog_for", seen)

    def of(model="jointed", dim=None, **changes):
        found.clear()
        record = SILENT["record"] | changes.pop("record", {})
        simulate(short(**(SILENT | changes | {"record": record})), model, dim=dim)
        return found[0]

    return of


@pytest.fixture
def joints(kernel, instructions):
    """Return a function that counts kinds of instructions in the forces of a scene's joints."""

    def count(*kinds, **changes):
        flags, (c, state, work, *_) = kernel(**changes)
        law = forces_for(flags.law, flags.dim, flags.stressed)
        history = state.history
        given = work.jump, work.moved, work.jump_rate, history, history, work.loads, work.drags
        return [instructions(law, (c.points, c.dt, *given), kind) for kind in kinds]

    return count


@pytest.fixture
def counted(kernel, instructions):
    """Return a function that counts kinds of instructions in the steps of a scene."""

    def count(*kinds, **changes):
        flags, given = kernel(**changes)
        return [instructions(leapfrog_for(flags), given, kind) for kind in kinds]

    return count


@pytest.mark.parametrize("dim", [1, 2, 3])
def test_elastic_joints_compare_and_divide_nothing(joints, dim):
    """They are sums and products."""
    compares, divides, roots, multiplies = joints("fcmp", "fdiv", SQRT, "fmul", dim=dim)
    assert (compares, divides, roots) == (0, 0, 0) < (multiplies,) * 3


OF_JOINTS = {
    "dashpots": ("fmul", {"joints": {"damping_ratio": 0.02}}),
    "no tension": ("fcmp", {"joints": {"tension": False}}),
    "slip compares": ("fcmp", {"joints": SLIP}),
    "slip divides": ("fdiv", {"joints": SLIP}),
    "slip has a root in space": (SQRT, {"joints": SLIP, "dim": 3}),
    "softening": ("fcmp", {"joints": BREAKS}),
    "closure": ("fdiv", {"joints": CLOSES}),
    "prestress": ("fsub", {"prestress": {"normal": 1e5}}),
}


@pytest.mark.parametrize(("kind", "changes"), OF_JOINTS.values(), ids=OF_JOINTS)
def test_each_effect_of_joints_adds_instructions(joints, kind, changes):
    """So joints without it have none of them."""
    keys = {"dim": 2} | changes
    assert joints(kind, dim=keys["dim"]) < joints(kind, **keys)


def test_joints_of_the_bar_have_no_shear(joints):
    assert joints("load", dim=1) < joints("load", dim=2) < joints("load", dim=3)
    assert joints(SQRT, "fdiv", dim=1, joints=SLIP) == [0, 0]


def test_elastic_joints_add_no_comparison_and_no_division_to_steps(counted):
    """What others there are is of fixed sides, and of the samples."""
    kinds = "fcmp", "fdiv", INCREF
    assert counted(*kinds) == counted(*kinds, model="equivalent")


def test_steps_count_no_references_to_arrays(counted):
    """Which rock with every kind of array would do by the hundred."""
    everything = {
        "joints": SLIP | {"damping_ratio": 0.02, "tension": False},
        "ends": {"start": "quiet", "end": "matched"},
        "prestress": {"normal": 1e5},
        "rock__quality_factor": 20.0,
        "record": {"energy": True},
    }
    assert counted(INCREF, dim=2, **everything) == [0]


OF_ROCK = {
    "ledger": ("equivalent", {"record": {"energy": True}}),
    "quality factor": ("equivalent", {"rock__quality_factor": 20.0}),
    "springs of matched ends": ("jointed", {"ends__end": "matched"}),
    "dashpots of homogenised joints": ("equivalent", {"joints": {"damping_ratio": 0.02}}),
}


@pytest.mark.slow
@pytest.mark.parametrize(("model", "changes"), OF_ROCK.values(), ids=OF_ROCK)
def test_each_effect_of_rock_adds_instructions(counted, model, changes):
    """So rock without it has none of them."""
    assert counted("fmul", model=model) < counted("fmul", model=model, **changes)


@pytest.mark.parametrize(
    "nothing",
    [
        {"joints": {"tension": True, "damping_ratio": None}},
        {"joints": {"friction_angle": 30.0}},
        {"damping": {"mass_proportional": 0.0}},
        {"ends": {"start": "free", "end": "free"}},
        {"ends": {"end": "quiet"}},
    ],
    ids=["joints", "friction of the bar", "damping", "free ends", "an end on dashpots"],
)
def test_a_key_that_calls_for_nothing_changes_no_flag(kernel, nothing):
    assert kernel(**nothing)[0] == kernel()[0]


def test_absent_effects_leave_no_array(kernel):
    """No rates, histories, mechanisms, springs of ends, energies, forces or stresses at u = 0."""
    _, (c, state, work, samples, *_) = kernel(load__amplitude=0.0)
    absent = (
        c.damping.value, c.points.carried, c.steady, c.quiet.freedom, c.fixed, c.receivers.viscous,
        state.elongation, state.history, state.closure, work.rate, work.drag, work.strained,
        work.rock, work.moved, work.jump_rate, work.drags, work.braking, samples.energy,
    )  # fmt: skip
    arrays = [one.value if isinstance(one, tuple) else one for one in absent]
    assert [one.size for one in arrays] == [0] * len(arrays)


@pytest.mark.parametrize(
    "idle",
    [
        {"joints": {"cohesion": 1e12}},
        {"joints": {"cohesion": 1e12, "residual_cohesion": 0.0, "friction_angle": 0.0}},
        {"joints": {"tensile_strength": 1e12, "fracture_energy": 1e18}},
        {"prestress": {"normal": 0.0}},
    ],
    ids=["cohesion", "cohesion that slip takes", "tensile strength", "prestress"],
)
def test_strength_that_nothing_reaches_changes_nothing(idle, short):
    """An oblique and eccentric blow in the plane, which opens and shears the joints."""
    blow = BLOW | {"numerics__continuum__order": 1}
    one, other = (simulate(short(**blow, **changes), dim=2) for changes in ({}, idle))
    for quantity in ("stress", "shear", "velocity", "rotation"):
        assert abs(one[quantity]).max() > 0
        assert other[quantity].equals(one[quantity]), quantity


def test_the_ledger_changes_nothing(short):
    keys = {"joints__damping_ratio": 0.02, "numerics__continuum__order": 1}
    one, other = (simulate(short(record={"energy": on}, **keys)) for on in (True, False))
    for quantity in ("stress", "velocity", "displacement"):
        assert other[quantity].equals(one[quantity]), quantity
