"""Explicit steps pay only for what a scene calls for, proved on what is compiled, without a clock;
and their products are those of the matrix."""

import numpy as np
import pytest

from jointwave.continuum import simulate
from jointwave.continuum.space.evaluation import blocks_of_nodes
from jointwave.continuum.stepping import leapfrog, product
from jointwave.continuum.stepping.explicit import leapfrog_for
from tests.continuum.stacked import stack

INCREF = r"(?:tail )?call void @NRT_incref\(\S+"
SQRT = r"(?:tail )?call \S+ @llvm\.sqrt\S*"
SLIP = {"friction_angle": 20.0, "cohesion": 1e4}
LEDGER = {"record": {"energy": True}}


@pytest.mark.parametrize("dim", [1, 2, 3])
def test_products_by_any_structure_are_the_matrix_times_a_vector(dim, monkeypatch):
    body, random = stack(dim, 13, 1, 1), np.random.default_rng(1)
    K, block = body.stiffness, blocks_of_nodes(body)
    alike = product.product_of(K, dim, block, body.x)
    rows = product.product_of(K, dim, 0 * block, body.x)
    monkeypatch.setattr(product, "CACHE", 0)
    half = product.product_of(K, dim, 0 * block, body.x)
    assert [one.kind for one in (alike, rows, half)] == ["shared", "rows", "half"]
    x = random.standard_normal(K.shape[0])
    for one in (alike, rows, half):
        placed, found = np.zeros((2, one.size))
        placed[one.place] = x
        product.product_for(one.kind, dim)(one.table, placed, found)
        np.testing.assert_allclose(found[one.place], -(K @ x), atol=1e-12 * np.abs(K @ x).max())


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
        record = {"energy": False} | changes.pop("record", {})
        keys = {"numerics__continuum__scheme": "explicit"} | changes
        simulate(short(**keys, record=record), model, dim=dim)
        return found[0]

    return of


@pytest.mark.parametrize("dim", [1, 3])
def test_elastic_joints_add_no_comparison_division_or_root_to_steps(kernel, instructions, dim):
    """They are sums and products. What else there is is of fixed sides, and of the samples."""

    def counted(model):
        flags, given = kernel(model, dim)
        kinds = ("fcmp", "fdiv", SQRT, INCREF, "fmul")
        return [instructions(leapfrog_for(flags), given, kind) for kind in kinds]

    (*joints, products), (*none, fewer) = counted("jointed"), counted("equivalent")
    assert joints == none and products > fewer


def test_steps_count_no_references_to_arrays(kernel, instructions):
    """Which rock with every kind of array would do by the hundred."""
    everything = {
        "joints": SLIP | {"damping_ratio": 0.02, "tension": False},
        "ends": {"start": "quiet", "end": "matched"},
        "prestress": {"normal": 1e5},
        "rock__quality_factor": 20.0,
    }
    flags, given = kernel(dim=2, **everything, **LEDGER)
    assert instructions(leapfrog_for(flags), given, INCREF) == 0


#: Keys, and the flags that they set: those of steps, and those of the joints' law; none of what
#: calls for nothing.
EFFECTS = [
    (LEDGER, {"ledger"}),
    ({"prestress": {"normal": 1e5}}, {"stressed"}),
    ({"rock__quality_factor": 20.0}, {"relaxing"}),
    ({"ends__end": "matched"}, {"sprung"}),
    ({"joints": {"damping_ratio": 0.02}}, {"damped", "dashpots"}),  # of rock, of joints
    ({"joints": {"tension": False}}, {"no_tension"}),
    ({"joints": {"tensile_strength": 5e6, "fracture_energy": 2000.0}}, {"softening"}),
    ({"joints": {"maximum_closure": 1e-4}}, {"closure"}),
    ({"joints": SLIP, "dim": 2}, {"slip", "limited"}),
    ({"joints": {"tension": True, "damping_ratio": None}}, set()),
    ({"joints": {"friction_angle": 30.0}}, set()),  # of the bar
    ({"damping": {"mass_proportional": 0.0}}, set()),
    ({"ends": {"end": "quiet"}}, set()),
]


@pytest.mark.parametrize(("changes", "flags"), EFFECTS)
def test_a_key_compiles_its_effect_alone(kernel, changes, flags):
    def flags_of(**keys):
        found, _ = kernel(**keys)
        return found._asdict() | found.law._asdict() | {"law": None}

    one, other = flags_of(dim=changes.get("dim")), flags_of(**changes)
    assert {name for name in one if one[name] != other[name]} == flags
    assert all(other[name] for name in flags)


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
