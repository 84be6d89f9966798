"""The work of half a step and the energies of a sample, by hand: the kernel's parts as Python."""

import numpy as np
import pytest

from jointwave.continuum.explicit.leapfrog import add_energy, add_work, read

OLD, NEW = np.array([1.0, 2.0, -1.0, 0.5]), np.array([3.0, -2.0, 1.0, 1.5])
MASS = np.array([2.0, 4.0, 6.0, 8.0])
NOTHING = dict.fromkeys(
    [
        *("drag", "decay", "quiet", "reaction", "loaded", "share", "pressure", "fixed"),
        *("base_force", "driven", "drive", "dashpots", "braking"),
    ]
)
WORK = {
    # F . v / 4 s, taken from the motion: -(10 * 3 + 20 * -2 + 30 * 1 + 40 * 1.5) / 4.
    "drag": ({"drag": np.array([10.0, 20.0, 30.0, 40.0])}, [-20.0, 0, 0, 0]),
    # alpha = 2 (1/3) / (5/3) / dt = 0.8 1/s: half of it times m (v + v') v' over 0.25 s.
    "mass": ({"decay": 2 / 3}, [0.25 * 0.4 * (2 * 4 * 3 + 8 * 2 * 1.5), 0, 0, 0]),
    "ends": (
        {"quiet": np.array([1, 3]), "reaction": np.array([5.0, 6.0])},
        [0, 0, 0.25 * (5 * -2 + 6 * 1.5), 0],
    ),
    "load": (
        {"loaded": np.array([2]), "share": np.array([0.5]), "pressure": np.array([0, 100.0, 0])},
        [0, 0, 0, 0.25 * 50 * 1],
    ),
    # Step 1 takes the second of two rows that take turns.
    "driven": (
        {"driven": np.array([0, 3]), "drive": np.array([[1.0, 2.0], [8.0, 4.0]])},
        [0, 0, 0, 0.25 * (8 * 3 + 4 * 1.5)],
    ),
    "dashpots": (
        {"dashpots": np.array([[0, 2]]), "braking": np.array([[2.0, -3.0]])},
        [0, 0, 0.25 * (2 * 3 - 3 * 1), 0],
    ),
    "base": ({"fixed": np.array([0]), "base_force": np.array([7.0])}, [0, 0, 0, 0.25 * 7 * 3]),
}


@pytest.mark.parametrize("given, expected", WORK.values(), ids=WORK)
def test_work_of_half_a_step(given, expected):
    """On top of what the ledger has: viscous, friction, boundary and load, over a quarter second at
    the velocity behind the step; none where nothing acts."""
    ledger = np.array([1.0, 2.0, 3.0, 4.0])
    add_work(ledger, 0.25, NEW, OLD, NEW, mass=MASS, dt=0.5, n=1, **NOTHING | given)
    assert ledger - [1, 2, 3, 4] == pytest.approx(expected, rel=1e-14, abs=1e-14)


def test_energies_of_a_sample():
    """m v v' / 2 = 3 - 8 - 3 + 3 J; weight falls by u; the ledger behind them, as it is."""
    u, weight, ledger = (
        np.array([1.0, 2.0, 0.0, 0.0]),
        np.array([3.0, -5.0, 1.0, 1.0]),
        np.arange(4.0),
    )
    energy = np.full((8, 2), 9.0)
    add_energy(energy, 1, MASS, u, OLD, NEW, weight, ledger)
    assert energy[:, 1].tolist() == [-5.0, 9.0, 9.0, 7.0, 0.0, 1.0, 2.0, 3.0]
    add_energy(energy, 1, MASS, u, OLD, NEW, None, ledger)
    assert energy[3, 1] == 0.0 and (energy[:, 0] == 9.0).all()


def test_receivers_read_a_matrix_and_a_constant():
    """2 * 5 - 7 + 0.5 and 0.25: the third sample of both."""
    waves = np.zeros((2, 4))
    start, column, value = np.array([0, 2, 2]), np.array([0, 2]), np.array([2.0, -1.0])
    read(np.array([5.0, 6.0, 7.0]), start, column, value, np.array([0.5, 0.25]), waves, 2)
    assert waves.tolist() == [[0, 0, 3.5, 0], [0, 0, 0.25, 0]]
