"""The stability map: agreement with theory, and detection of wrong cells."""

import numpy as np
import pytest

from compare.experiments.robustness.map import ENGINES, boundary, make_map
from numerics.critical_step import critical_step_of_modes


@pytest.fixture(scope="module")
def maps():
    """Return a coarse map of every engine."""
    return {engine: make_map(engine, cells=12) for engine in ENGINES}


@pytest.mark.parametrize("engine", ENGINES)
def test_no_cell_is_wrong_beyond_one_of_the_line(maps, engine):
    """Both stable and unstable cells are many, and all but those on the line are as theory says."""
    found = maps[engine]
    assert 0.2 < found.stable.mean() < 0.8
    assert not found.far.any()


def test_line_is_the_critical_step_of_one_mode():
    """x = omega dt / 2 and zeta = eta omega / 2 of the closed form that the engines use."""
    omega, ratio = 3000.0, np.array([0.0, 0.01, 1.0, 10.0])
    steps = [critical_step_of_modes(omega, 2 * z / omega) for z in ratio]
    assert boundary(ratio) == pytest.approx(np.array(steps) * omega / 2, rel=1e-14)


def test_map_of_an_engine_with_another_limit_is_wrong(maps):
    """Steps taken half as long again as they are said to be are beyond the line in many cells."""
    found = maps["dem"]
    slower = found._replace(step=found.step / 2.5)
    assert slower.far.sum() > 5
    assert found._replace(stable=~found.stable).far.sum() > 50
