"""Plane waves in periodic squares and bricks, against the closed form of their discrete motion.

Bricks against the assembled Bloch problem. Of squares:

With k_n, k_s (N/m) and the bending stiffness k_b (N m) of a contact, x = k_x A, y = k_y A and the
freedoms (u, v, phi), omega^2 are the eigenvalues of the Hermitian D against diag(m, m, I):

    D_uu = 2 k_n (1 - cos x) + 2 k_s (1 - cos y),   D_vv the same with x and y exchanged,
    D_u,phi = -i k_s A sin y,   D_v,phi = i k_s A sin x,
    D_phi,phi = (k_s A^2 / 2)(2 + cos x + cos y) + 2 k_b (2 - cos x - cos y).

Leapfrog turns omega into Omega with sin(Omega dt / 2) = omega dt / 2, and nothing else.
"""

import numpy as np
import pytest
from scipy.linalg import eigh

from closed_forms.bloch import brickwork, leapfrog
from closed_forms.bloch import modes as bloch_modes
from jointwave.dem.blocks.leapfrog import march, samples_for
from jointwave.dem.blocks.model import state_at_rest

K_N, K_S, SIDE, DENSITY, NUMBER = 9e9, 4e9, 0.5, 2600.0, np.array([6, 5])


def modes(wave):
    """Return omega^2 [3] and the shapes [3, 3] of the branches at this wave number times A."""
    (x, y), k_n, k_s = wave, K_N * SIDE, K_S * SIDE
    bend = K_N * SIDE**3 / 12
    D = np.zeros((3, 3), dtype=complex)
    D[0, 0] = 2 * k_n * (1 - np.cos(x)) + 2 * k_s * (1 - np.cos(y))
    D[1, 1] = 2 * k_n * (1 - np.cos(y)) + 2 * k_s * (1 - np.cos(x))
    D[0, 2], D[1, 2] = -1j * k_s * SIDE * np.sin(y), 1j * k_s * SIDE * np.sin(x)
    D[2, 0], D[2, 1] = D[0, 2].conj(), D[1, 2].conj()
    both = np.cos(x) + np.cos(y)
    D[2, 2] = k_s * SIDE**2 / 2 * (2 + both) + 2 * bend * (2 - both)
    mass = DENSITY * SIDE**2
    return eigh(D, np.diag([mass, mass, mass * SIDE**2 / 6]))


STEPS = 5000


@pytest.mark.parametrize("points", [0, 2], ids=["whole contacts", "by points"])
@pytest.mark.parametrize("branch", [0, 1, 2])
@pytest.mark.parametrize("wave", [(1, 0), (0, 2), (1, 1), (2, -1), (3, 2)])
def test_plane_waves_are_exact_in_every_branch_and_direction(wave, branch, points, lattice):
    """After 5000 steps to 1e-10 of the amplitude: round-off of the phase, 5000 times 1e-15 of a
    step's rotation, and its square root of sums."""
    number = 2 * np.pi * np.array(wave) / NUMBER
    squares, shapes = modes(number)
    check(*lattice(points=points), number, np.sqrt(squares[branch]), shapes[:, branch])


@pytest.mark.parametrize("points", [0, 2], ids=["whole contacts", "by points"])
@pytest.mark.parametrize("branch", [0, 1, 2])
@pytest.mark.parametrize("wave", [(1, 0), (0, 2), (2, -1)])
@pytest.mark.parametrize("offset", [0.5, 0.3])
def test_plane_waves_in_brickwork_are_those_of_its_bloch_problem(
    wave, branch, points, offset, lattice
):
    """As in squares: bricks of 0.8 m by 0.5 m, each on two others."""
    cell = brickwork(0.8, 0.5, offset, DENSITY, (K_N, K_S), (K_N, K_S))
    number = 2 * np.pi * np.array(wave) / NUMBER
    omega, shapes = bloch_modes(cell, np.linalg.solve(cell.vectors, number))
    model, at = lattice(points=points, brick=(0.8, 0.5, offset))
    check(model, at, number, omega[branch], shapes[:, branch])


def check(model, at, number, omega, shape):
    """March a mode of unit amplitude, whose phase from cell to cell is given, for 5000 steps."""
    dt = model.blocks.dt
    shape = 1e-6 * shape / np.abs(shape).max()
    Omega, phase = leapfrog(omega, dt), np.exp(1j * (at @ number))

    def u(t):
        return (phase[:, None] * shape * np.exp(-1j * Omega * t)).real

    state = state_at_rest(model)
    state.u[:] = u(0.0)
    state.v[:] = (u(0.0) - u(-dt)) / dt
    march(model, state, samples_for(model, 0), 1 << 40, (1, STEPS + 1))
    assert np.abs(state.u - u(STEPS * dt)).max() < 1e-10 * 1e-6
