"""The cost of a block-step is measured, and that of all effects only once."""

import json

import numpy as np
import pytest

import cases
from compare.experiments.cost import scenes, step_cost, timings
from compare.experiments.cost.scenes import changed
from compare.experiments.cost.step_cost import in_turns, stretch, whole
from compare.scenes import find

SLIDING = {"y": 5.0, "tensile_strength": 1e4, "fracture_energy": 1e3}


def test_stretch_counts_its_block_steps():
    """Blocks times steps of the samples taken, both along the axis and in space."""
    for changes in ({}, scenes.ACROSS):
        scene = changed({**changes, "time.duration": 5e-4, "record.energy": False}, 100)
        march, block_steps = stretch(scene)
        march()
        assert block_steps % 100 == 0 and block_steps > 0


def test_the_least_of_stretches_in_turns_counts(monkeypatch):
    """Whatever else the machine does meanwhile: three rounds of five take three times as long, and
    the median with them."""
    now, marches = [0.0], []

    def stretch_of(ns, threads):
        def march():
            turn = (len(marches) - 2) // 2  # after both have been compiled
            marches.append(ns)
            now[0] += ns * 0.1 * (3 if turn in (1, 2, 3) else 1)

        return march, 10**8

    monkeypatch.setattr(step_cost, "perf_counter", lambda: now[0])
    monkeypatch.setattr(step_cost, "stretch", stretch_of)
    assert np.ravel(in_turns([2.0, 30.0])) == pytest.approx([2.0, 4.0, 30.0, 60.0])
    assert marches == [2.0, 30.0] * 6


@pytest.mark.parametrize("scheme", ["explicit", "implicit"])
def test_a_run_of_rock_is_timed_again_from_its_start(scheme):
    """Every repeat takes the same steps: its samples are those of a run of its own, bit by bit."""
    from continuum.simulate import simulate, start

    keys = {"time.duration": 5e-3, "numerics.continuum.scheme": scheme, "soft_layers": [SLIDING]}
    scene = cases.load_variant(find("hard/short-pillar"), "", keys)
    begun = start(scene, "jointed")
    begun.engine.compile()
    march, energy = begun.march_again(), simulate(scene)["energy"]
    for _ in range(2):
        begun.run.samples.energy[:] = 0.0
        march()
        kept = begun.run.samples.energy
        assert kept[0].max() > 0
        np.testing.assert_array_equal(kept[0], energy.sel(term="kinetic"))


def test_everything_is_measured_once(tmp_path, monkeypatch):
    """The first call measures and saves; later ones read; a broken file is measured again."""
    monkeypatch.setattr(timings.jit, "DIRECTORY", tmp_path)
    measured = []
    monkeypatch.setattr(step_cost, "nanoseconds", lambda scene: measured.append(scene) or 42.0)
    assert [whole(100), whole(100)] == pytest.approx([42.0, 42.0])
    assert [scene.pillar.block_count for scene in measured] == [100]
    file = timings._file()
    assert list(json.loads(file.read_text()).values()) == [pytest.approx(42e-9)]
    for broken in ("broken", "[1]", '{"100": null}'):
        file.write_text(broken)
        assert whole(100) == pytest.approx(42.0)
    assert len(measured) == 4


@pytest.mark.parametrize(("blocks", "measured"), [(1, 2), (2, 2), (100, 100), (10**6, 1000)])
def test_everything_is_measured_in_as_many_blocks(blocks, measured):
    """A step has a cost of its own, which few blocks share; a thousand hardly feel it."""
    assert scenes.everything(blocks).pillar.block_count == measured


@pytest.mark.parametrize("name", ["finite rotation", "slip", "softening", "dashpots", "gravity"])
def test_everything_calls_for_everything(name):
    """The line of 100 % has every effect on that joints and motion have."""
    from cases.effects import active_effects

    assert name in active_effects(changed(scenes.EVERYTHING))
