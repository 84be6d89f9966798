"""Where a row of blocks breaks, and what flies off: momentum is the load's impulse."""

import json
from itertools import pairwise

import numpy as np
import pytest

from closed_forms.spall import lattice_spall
from jointwave import cases, dem
from jointwave.cases.loads import load_history
from jointwave.compare.scenes import SHIPPED

FREE = {"ends.start": "free", "load.quantity": "stress"}


def spalled(**changes):
    """Return the shipped spall scene without a matched start, as one pulse of the same height."""
    return cases.load_variant(SHIPPED / "beyond" / "spall.toml", "", FREE | changes)


def impulse(scene):
    """Return the whole impulse of the load, N s."""
    return scene.pillar.area * float(load_history(scene).impulse(np.array(scene.time.duration)))


def momentum(pieces):
    """Return the sum of mass times velocity, N s."""
    return sum(piece["mass"] * np.array(piece["velocity"]) for piece in pieces)


HEAVY = {"y": [10.0, 15.0], "density": 4000.0, "block": 0.5, "intact_modulus": 1e11}
BAR = {"y": [0.0, 5.0], "joints": False, "density": 3000.0}


@pytest.mark.parametrize(
    ("changes", "mass"),
    [({}, 20 * 2400.0), ({"segments": [BAR, HEAVY]}, 5 * 3000.0 + 5 * 4000.0 + 10 * 2400.0)],
    ids=["one rock", "several rocks"],
)
def test_fragments_share_the_whole_pillar_and_the_impulse_of_the_load(changes, mass):
    """No force is left but between the blocks: momentum is conserved to round-off. Each piece has
    the mass of its own rock, and the velocity of its centre of mass."""
    scene = spalled(**changes)
    pieces = json.loads(dem.simulate(scene).attrs["fragments"])
    assert len(pieces) > 2
    assert pieces[0]["from_y"] == 0 and pieces[-1]["to_y"] == scene.pillar.length == 20.0
    assert all(a["to_y"] == b["from_y"] for a, b in pairwise(pieces))
    found = sum(piece["mass"] for piece in pieces)
    assert found == pytest.approx(scene.pillar.area * mass, rel=1e-12)
    assert momentum(pieces) == pytest.approx(impulse(scene), rel=1e-12)


def test_break_time_is_when_a_joint_carries_its_last_tension():
    """Each broken joint is pulled up to its break time and never after; none before the exact
    chain has reached its strength anywhere."""
    times = dem.simulate(spalled()).break_time
    broken = np.isfinite(times.values)
    scene = spalled(**{"record.stress": times.joint_y.values[broken].tolist()})
    result, at = dem.simulate(scene), times.values[broken]
    assert at.min() > lattice_spall(scene).time
    for stress, broke in zip(result.stress.values, at, strict=True):
        pulled = result.time.values[stress < 0]
        assert broke - scene.interval <= pulled.max() <= broke
    pieces = json.loads(result.attrs["fragments"])
    assert [piece["to_y"] for piece in pieces[:-1]] == scene.record.stress


def test_fragments_in_space_share_the_impulse_along_its_direction():
    """An oblique pull tears the row; what flies off has the load's impulse, component by component.

    The sections slide freely across each other, so only the sum is known beforehand."""
    along = [0.28, 0.96, 0.0]
    scene = spalled(**{"load.direction": along, "motion.rotation": "none"})
    pieces = json.loads(dem.simulate(scene).attrs["fragments"])
    assert len(pieces) > 1
    off = momentum(pieces) - impulse(scene) * np.array(along)
    assert np.abs(off).max() < 1e-12 * impulse(scene)
