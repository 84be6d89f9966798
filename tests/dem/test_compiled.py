"""Blocks pay only for what their scene calls for, proved on what is compiled, without a clock."""

from inspect import getclosurevars, isfunction
from itertools import product

import pytest

from jointwave.dem import simulate
from jointwave.dem.kernel import leapfrog, loop, motion, relative, tractions
from jointwave.dem.kernel.model import KernelFlags
from jointwave.joints.law import LawFlags
from tests.rocks import rock

SEVERAL = r" <\d+ x double>"  # of several contacts at once
SQRT = r"(?:tail )?call \S+ @llvm\.sqrt\S*"
SLIP = {"friction_angle": 20.0}
UP, EAST, NORTH = {"dip": 0.0}, {"dip": 90.0, "dip_direction": 90.0}, {"dip": 90.0}
ATTITUDES = {2: [UP, NORTH], 3: [UP | {"dip_direction": 0.0}, EAST, NORTH | {"dip_direction": 0.0}]}


def lattice(dim=2, joints=(), **tables):
    """Return free blocks of 1 m without a ledger, 4 along each axis; tables added."""
    sets = [one | {"spacing": 1.0, "through": [0.0] * dim} for one in ATTITUDES[dim]]
    bare = {"record": {"points": [[0.5] * dim], "energy": False}}
    return rock([4.0] * dim, sets, joints, **bare | tables)


@pytest.fixture
def kernel(monkeypatch):
    """Return a function of a scene: the flags of the time loop that it runs, the loop, and what
    this is given. No step is taken."""
    loop_for, found = leapfrog.loop_for, []

    def seen(form):
        return lambda *given: found.append((form, loop_for(form), given))

    monkeypatch.setattr(leapfrog, "loop_for", seen)

    def of(scene):
        found.clear()
        simulate(scene)
        return found[0]

    return of


@pytest.fixture
def counted(kernel, instructions):
    """Return a function that counts kinds of instructions in the time loop of a scene."""

    def count(scene, *kinds):
        _, loop, given = kernel(scene)
        return [instructions(loop, given, kind) for kind in kinds]

    return count


def test_absent_effects_leave_no_instruction(counted):
    """No comparison, division or root between elastic blocks; friction brings all three. Both work
    on several contacts at once."""
    kinds = "fcmp", "fdiv", SQRT, "fmul" + SEVERAL
    elastic, slips = counted(lattice(3), *kinds), counted(lattice(3, SLIP), *kinds)
    assert elastic[:3] == [0, 0, 0] and elastic[3] > 0
    assert min(slips) > 0


def test_steps_count_no_references_to_arrays(counted):
    """Which blocks that slip in space, and have every kind of array, would do by the hundred."""
    sides = {"boundaries": {"top": "quiet"}, "record": {"points": [[0.5] * 3], "energy": True}}
    assert counted(lattice(3, SLIP, **sides), r"(?:tail )?call void @NRT_incref\(\S+") == [0]


@pytest.mark.parametrize(
    "nothing",
    [
        {"joints": {"tension": True, "damping_ratio": None}},
        {"damping": {"local": 0.0, "mass_proportional": 0.0}},
        {"boundaries": {"top": "free"}},
    ],
    ids=["joints", "damping", "sides"],
)
def test_a_key_that_calls_for_nothing_changes_no_flag(kernel, nothing):
    assert kernel(lattice(**nothing))[0] == kernel(lattice())[0]


def test_absent_effects_leave_no_array(kernel):
    """No forces or dashpots on blocks, moving walls, energies, or memory of joints."""
    _, blocks, state, samples, drive, walls, *_ = kernel(lattice())[2]
    absent = blocks.held, blocks.tensor, state.history, samples.energy, drive, walls
    assert absent == (None,) * 6


def constants(formula):
    """Return the variables of the closure of each formula, and of those that it calls."""
    if isinstance(formula, tuple):
        return [*map(constants, formula)]
    own = getclosurevars(formula).nonlocals.items()
    return {name: constants(one) if isfunction(one) else one for name, one in own}


@pytest.mark.parametrize(
    "factory",
    [
        motion.motion_for, relative.relative_for, relative.onto_blocks_for,
        tractions.point_forces_for, tractions.face_forces_for, loop.records_for,
    ],
)  # fmt: skip
def test_shared_formulas_are_those_of_each_kernel(factory):
    """None depends on a flag that it is not given, and kernels of other laws share the motion."""
    bare = LawFlags(*[False] * 13)
    laws = [bare._replace(**{name: True}) for name in bare._fields]
    forms = [
        KernelFlags(dim, turns, law, *others, dim == 3 and turns and others[0])
        for dim, turns, law in product((2, 3), (False, True), laws)
        for others in ((*[k] * 12, 1 + k) for k in (False, True))
    ]
    for form in forms:
        assert constants(factory(form)) == constants(factory.__wrapped__(form))
    assert len(set(map(motion.motion_for, forms))) == 8
