"""The cost of a step, as the least of runs that alternate."""

import pytest

from jointwave import cases
from jointwave.cases.effects import effects
from jointwave.compare.scenes import find
from jointwave.compare.solvers.record import OF_BLOCK_IN_PLANE
from jointwave.compare.studies import step_cost
from jointwave.compare.studies.step_cost import shortened, step_costs, with_every_effect

PILLAR = find("guo-li-2002/fig-03")


def test_the_least_of_runs_in_turns_counts(monkeypatch):
    """Whatever else the machine does meanwhile: runs of six turns take three times as long, and
    the median with them."""
    turns, solve = [], step_cost.solve
    costs = {100: 2e-9, 50: 3e-8}

    def slowed(name, scene):
        result, blocks = solve(name, scene), scene.block_count
        turn = turns.count(blocks)
        turns.append(blocks)
        steps = result.attrs["steps"] * blocks
        result.attrs["seconds_stepping"] = costs[blocks] * steps * (3 if turn in range(2, 8) else 1)
        return result

    monkeypatch.setattr(step_cost, "solve", slowed)
    scenes = [cases.load_variant(PILLAR, "", {"pillar.length": x}) for x in (50.0, 25.0)]
    found = [x for cost in step_costs(scenes) for x in cost]
    assert found == pytest.approx([2.0, 4.0, 30.0, 60.0])
    assert turns == [100, 50] * 11


def test_a_timed_run_is_the_beginning_of_its_scene():
    """As many block-steps as asked for, or a sample; its numerics otherwise its own."""
    scene = cases.load_variant(PILLAR, "", {"pillar.length": 5000.0})
    short = shortened(scene)
    steps = round(short.time.duration / scene.time.duration * 7200)
    assert 0.5 * step_cost.UNIT_STEPS < 10_000 * steps < 2 * step_cost.UNIT_STEPS
    assert short.time.duration >= short.interval == scene.interval


@pytest.mark.parametrize(("blocks", "measured"), [(2, 2), (100, 100), (10**4, 1000)])
def test_every_effect_is_measured_in_as_many_blocks(blocks, measured):
    """A step has a cost of its own, which few blocks share; a thousand hardly feel it."""
    changes = {"pillar.length": 0.5 * blocks, "record.stress": [0.0]}
    scene = cases.load_variant(PILLAR, "", changes)
    assert with_every_effect(scene).block_count == measured


def test_every_effect_is_measured_once(monkeypatch):
    """For scenes of the same number of blocks."""
    timed = []
    monkeypatch.setattr(step_cost, "_every_effect", {})
    monkeypatch.setattr(step_cost, "step_costs", lambda some: timed.extend(some) or [len(timed)])
    scenes = [cases.load_variant(PILLAR, "", {"pillar.length": x}) for x in (20.0, 20.0, 30.0)]
    assert [step_cost.cost_of_every_effect(one) for one in scenes] == [1, 1, 2]
    assert [one.block_count for one in timed] == [40, 60]


def test_every_effect_that_can_be_beside_others_is_there():
    """In a rock mass all but periodic and roller sides and, since blocks are rigid, a quality
    factor; in a pillar also but those that exclude others of it."""
    pillar = with_every_effect(cases.load_variant(PILLAR))
    off = {one.name for one in effects(pillar) if not one.active}
    excluded = {"no tension", "rate and state", "fixed ends", "prestress", "shaken base"}
    other = {"segments", "scatter", "field output", "local damping", "constant Q"}
    assert off == excluded | other
    mass = cases.load_variant(find("rock-mass/brickwork"))
    lattice = with_every_effect(mass)
    off = {one.name for one in effects(lattice) if not one.active}
    assert off == {"periodic sides", "roller sides", "field output", "constant Q"}
    blocks = step_cost.solver("dem").prepare(mass).freedoms // OF_BLOCK_IN_PLANE
    assert 0.5 * blocks < lattice.domain.size[0] ** 2 <= blocks or blocks > step_cost.BLOCKS
