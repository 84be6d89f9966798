"""The reference of each solution, on scenes whose finest physics is known by reasoning."""

import pytest

from jointwave.compare.engines import ENGINES
from jointwave.compare.misfit.ranking import applicable, deciding, finest, own_exact, reference_of

LAYER = {"y": 20.0, "spacing_stiffness": 4.375e8, "thickness": 0.05}
ROCK = {"dem": "continuum-jointed", "continuum-jointed": None}
BARS = {"dem": "jointed-bar", "continuum-jointed": "jointed-bar"}
BLOCKS = {"dem": "lattice", "continuum-equivalent": "lattice"}


@pytest.mark.parametrize(
    ("changes", "best", "references"),
    [
        ({}, "jointed-bar", BARS),  # rock with every joint, exact
        ({"joints__tension": False}, "continuum-jointed", ROCK),  # which nothing has checked
        ({"rock__intact_modulus": None}, "lattice", BLOCKS),  # joints are finer than none
        ({"soft_layers": [LAYER]}, "continuum-jointed", {"dem": "continuum-jointed"}),
        ({"numerics__continuum__dim": 2}, "continuum-jointed", {"continuum-jointed": None}),
    ],
)
def test_the_finest_is_what_leaves_out_least(pillar, changes, best, references):
    """A layer with a thickness is a joint to blocks and formulas; the sides of a column of two
    dimensions move, those of a bar do not. What decides is held against the same as among
    everything: the short answer of `jointwave compare` solves no more than its numbers rest on."""
    scene = pillar(**changes)
    every, few = (
        [name for name, answer in of(scene).items() if answer] for of in (applicable, deciding)
    )
    assert finest(every, scene).name == best and set(few) <= set(every)
    for name, expected in references.items():
        found = reference_of(name, every, scene)
        assert (found and found.name) == expected
    for engine in (name for name in few if name in ENGINES):
        assert reference_of(engine, few, scene) == reference_of(engine, every, scene)
        assert own_exact(engine, few, scene) == own_exact(engine, every, scene)


def test_an_engine_errs_against_the_exact_solution_of_its_own_model(pillar):
    scene = pillar()
    there = [name for name, answer in applicable(scene).items() if answer]
    expected = {"dem": "lattice", "continuum-jointed": "jointed-bar"}
    expected |= {"continuum-equivalent": "images"}
    assert {name: own_exact(name, there, scene) for name in ENGINES} == expected
    assert own_exact("continuum-jointed", ["dem", "lattice"], scene) is None
