"""The reference of each solution, on scenes whose finest physics is known by reasoning."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from jointwave.compare.engines import ENGINES, names, solver
from jointwave.compare.misfit.ranking import (
    applicable,
    deciding,
    finest,
    lacks,
    own_exact,
    reference_of,
)

LAYER = {"y": 20.0, "spacing_stiffness": 4.375e8}
CASES = [
    # A free elastic pillar: rock with every joint, exact.
    ({}, "jointed-bar", {"dem": "jointed-bar", "continuum-jointed": "jointed-bar"}),
    # No tension: nothing exact of jointed rock, so nothing has checked it.
    ({"joints__tension": False}, "continuum-jointed", {"continuum-jointed": None}),
    ({"joints__tension": False}, "continuum-jointed", {"dem": "continuum-jointed"}),
    # Unknown intact rock: the joints of rigid blocks are finer than none.
    ({"rock__intact_modulus": None}, "lattice", {"dem": "lattice"}),
    ({"rock__intact_modulus": None}, "lattice", {"continuum-equivalent": "lattice"}),
    # A layer with a thickness, which blocks and formulas take for a joint.
    (
        {"soft_layers": [LAYER | {"thickness": 0.05}]},
        "continuum-jointed",
        {"dem": "continuum-jointed"},
    ),
    # A column of two dimensions, whose sides move: a bar does not have that.
    ({"numerics__continuum__dim": 2}, "continuum-jointed", {"continuum-jointed": None}),
]


@pytest.mark.parametrize(("changes", "best", "references"), CASES)
def test_the_finest_is_what_leaves_out_least(pillar, changes, best, references):
    scene = pillar(**changes)
    there = [name for name, answer in applicable(scene).items() if answer]
    assert finest(there, scene).name == best
    for name, expected in references.items():
        found = reference_of(name, there, scene)
        assert (found and found.name) == expected


def test_an_engine_errs_against_the_exact_solution_of_its_own_model(pillar):
    scene = pillar()
    there = [name for name, answer in applicable(scene).items() if answer]
    own = {name: own_exact(name, there, scene) for name in ("dem", "continuum-jointed")}
    assert own == {"dem": "lattice", "continuum-jointed": "jointed-bar"}
    assert own_exact("continuum-equivalent", there, scene) == "images"  # closed before computed
    assert own_exact("continuum-jointed", ["dem", "lattice"], scene) is None


@pytest.mark.parametrize("changes", [changes for changes, *_ in CASES])
def test_what_decides_is_held_against_the_same_as_among_everything(pillar, changes):
    """The short answer of `jointwave compare` solves no more than its numbers rest on."""
    scene = pillar(**changes)
    every = [name for name, answer in applicable(scene).items() if answer]
    few = [name for name, answer in deciding(scene).items() if answer]
    assert set(few) <= set(every)
    for engine in (name for name in few if name in ENGINES):
        assert reference_of(engine, few, scene) == reference_of(engine, every, scene)
        assert own_exact(engine, few, scene) == own_exact(engine, every, scene)


@settings(max_examples=25)
@given(st.sets(st.sampled_from(names()), min_size=1), st.sampled_from(names()), st.randoms())
def test_a_reference_is_finer_complete_and_the_same_in_any_order(
    pillar_scene, there, name, shuffle
):
    order = sorted(there)
    shuffle.shuffle(order)
    found = reference_of(name, order, pillar_scene)
    if found is None:
        return
    one, other = solver(name), solver(found.name)
    assert found.name != name and not lacks(found.name, pillar_scene)
    assert (other.rock, other.form) > (one.rock, one.form)
    again = solver(reference_of(name, sorted(there), pillar_scene).name)
    assert (again.rock, again.form) == (other.rock, other.form)


@pytest.fixture(scope="module")
def pillar_scene():
    from jointwave import cases
    from jointwave.compare.scenes import SHIPPED

    return cases.load_variant(SHIPPED / "guo-li-2002" / "fig-03.toml")
