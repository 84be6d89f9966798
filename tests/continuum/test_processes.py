"""Bodies that several real processes share: what one finds, to round-off."""

import pickle
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from jointwave.continuum.run import simulate
from tests.continuum import shared

ROOT = Path(__file__).parents[2]
SAME = 1e-11  # of the largest value: sums of some hundred steps in another order
#: Terms of the ledger that a scene is there for.
HAPPENS = {
    "plane": ["viscous", "friction", "fracture", "boundary"],
    "blocks": [],
    "damped": ["viscous", "boundary"],
    "space": ["friction", "fracture", "boundary"],
    "implicit": ["friction", "fracture", "boundary"],
    "pillar": ["viscous", "boundary"],
}


@pytest.fixture(scope="module")
def alone():
    """Return the results of one process."""
    return {name: simulate(scene) for name, scene in shared.scenes().items()}


@pytest.fixture(scope="module", params=[pytest.param(2, marks=pytest.mark.slow), 3])
def found(request, mpiexec, alone, tmp_path_factory):
    """Return what `shared.main` finds in so many processes, by kernels compiled before."""
    (launcher, environment), count = mpiexec, request.param
    path = tmp_path_factory.mktemp("shared") / "found"
    command = [*launcher, "-n", str(count), sys.executable, "-m", shared.__name__, path]
    done = subprocess.run(
        command, capture_output=True, text=True, env=environment, timeout=900, cwd=ROOT
    )
    assert done.returncode == 0, done.stderr
    return count, pickle.loads(path.read_bytes())


@pytest.mark.parametrize("name", HAPPENS)
def test_any_number_of_processes_gives_the_same_waveforms(name, found, alone):
    count, (results, *_) = found
    one, other = alone[name], results[name]
    assert other.attrs["processes"] == count and one.attrs["processes"] == 1
    for key in ("dt", "steps", "degrees_of_freedom", "scheme"):
        assert other.attrs[key] == one.attrs[key]
    assert set(other.variables) == set(one.variables)
    for quantity in one.data_vars:
        error = np.abs(other[quantity] - one[quantity]).max()
        assert error <= SAME * np.abs(one[quantity]).max(), quantity
    spent = one["energy"].max("time")
    assert (spent.sel(term=HAPPENS[name]) > 1e-4 * spent.sel(term="work")).all()


def test_an_interrupted_run_goes_on_to_the_same_bits(found):
    _, (results, resumed, *_) = found
    for quantity in resumed.data_vars:
        np.testing.assert_array_equal(resumed[quantity], results["plane"][quantity])


def test_all_processes_stop_alike(found):
    _, (*_, told, refused) = found
    assert len(set(told)) == 1 and "times the critical step" in told[0][0]
    assert 1 <= told[0][1] < shared.SAMPLES
    assert len(set(refused)) == 1 and "too many for a mesh of so few cells: 1" in refused[0]
