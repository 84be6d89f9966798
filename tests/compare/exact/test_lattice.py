"""The lattice against an ODE solver on matrices assembled here, its modes, and the bars."""

from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from closed_forms import leapfrog
from jointwave.cases.loads import load_history
from jointwave.cases.material.calibrate import calibrate
from jointwave.cases.sampling import sample_times
from jointwave.compare.exact.bar import images, modes
from jointwave.compare.exact.bar.bars import JOINTED
from jointwave.compare.exact.blocks import row_of_blocks
from jointwave.compare.exact.blocks.pillar import system_of

SHORT = {"length": 5.0, "side": 0.5, "block": 0.5}
QUICK = {"shape": "sine", "amplitude": 1e6, "period": 0.002}
SOFT = [{"y": 2.0, "spacing_stiffness": 4.375e8, "damping_ratio": 0.1}]


def assembled(stiffness, eta, ends, modulus, intact, density, d, area, rock_eta):
    """Return K, C over N blocks and two faces, element by element: at a wall half a block of intact
    rock, on a massless face half a block and its joint."""
    n, half, dashpot = len(stiffness) + 1, 2 * modulus / d * area, area * np.sqrt(modulus * density)
    K, C = np.zeros((2, n + 2, n + 2))

    def element(matrix, value, i, j=None):
        for a, b, sign in ((i, i, 1), (j, j, 1), (i, j, -1), (j, i, -1)):
            if a is not None and b is not None:
                matrix[a, b] += sign * value

    for j in range(n - 1):
        element(K, stiffness[j] * area, j, j + 1)
        element(C, stiffness[j] * area * eta[j], j, j + 1)
    for kind, block, face in ((ends[0], 0, n), (ends[1], n - 1, n + 1)):
        partner = face if kind == "matched" else None
        if kind in ("fixed", "matched"):
            spring = 2 * intact / d * area if kind == "fixed" else half
            element(K, spring, block, partner)
            element(C, spring * rock_eta, block, partner)
        if kind in ("quiet", "matched"):
            element(C, dashpot, face if kind == "matched" else block)
    return K, C


def integrated(scene):
    """Return displacements [n, N] of the blocks by DOP853; faces follow from C_ff w' = -(...)."""
    p, load, times = calibrate(scene), load_history(scene), sample_times(scene)
    eta = np.zeros(9) if p.joint_time_constant is None else p.joint_time_constant
    ends, rock_eta = (scene.ends.start, scene.ends.end), p.time_constant or 0.0
    moduli = p.modulus, p.intact_modulus
    K, C = assembled(p.stiffness, eta, ends, *moduli, p.density, 0.5, p.area, rock_eta)
    n, b, f = 10, slice(0, 10), [i for i in (10, 11) if C[i, i] > 0]
    x, rows, at = np.zeros(2 * n + 2), [np.zeros(n)], [0.0, *load.breaks[1:], times[-1]]

    def slope(t, x):
        u, v = np.r_[x[:n], x[2 * n :]], np.r_[x[n : 2 * n], 0.0, 0.0]
        if f:
            v[f] = np.linalg.solve(C[np.ix_(f, f)], -(K @ u + C @ v)[f])
        force = -(K @ u + C @ v)[b] / p.block_mass
        force[0] += load.value(t) * p.area / p.block_mass
        return np.r_[v[b], force, v[n:]]

    for start, stop in pairwise(at):
        inside = np.append(times[(times > start) & (times < stop)], stop)
        tight = {"rtol": 1e-11, "atol": 1e-15, "max_step": 1e-4}
        y = solve_ivp(slope, (start, stop), x, "DOP853", inside, **tight).y
        x, keep = y[:, -1], np.isclose(inside[:, None], times).any(axis=1)
        rows.extend(y[:n, keep].T)
    return np.array(rows)


@pytest.mark.parametrize(
    "ends, joints, layers",
    [
        (("free", "free"), {}, []),
        (("free", "fixed"), {"damping_ratio": 0.05}, []),
        (("quiet", "matched"), {}, SOFT),
        (("matched", "quiet"), {"damping_ratio": 0.2}, SOFT),
        (("free", "matched"), {"damping_ratio": 1.5}, SOFT),
    ],
)
def test_an_ode_solver_on_assembled_matrices_agrees(scene, misfit, ends, joints, layers):
    """DOP853 at a relative tolerance of 1e-11 over some thousand steps: 1e-8 is safe to ask."""
    at = scene(
        pillar=SHORT,
        load=QUICK,
        ends=dict(zip(("start", "end"), ends, strict=True)),
        joints=joints,
        soft_layers=layers,
        time={"duration": 0.012},
        record={"stress": [0.0, 1.3, 2.0, 5.0], "velocity": [0.5 * j + 0.25 for j in range(10)]},
    )
    blocks = integrated(at)
    assert misfit(row_of_blocks.solve(at).displacement.values[..., 0].T, blocks) < 1e-8


def test_stress_is_the_contact_force_with_the_load_and_the_ends_as_nodes(scene):
    """From the same result's displacements: K'_n times the closing of the joint; f at a free
    loaded end; halfway between in between; nothing at the free far end."""
    at = scene(
        record={"stress": [0.0, 0.25, 0.5, 49.75, 50.0], "velocity": [0.25, 0.75, 49.25, 49.75]}
    )
    p, result = calibrate(at), row_of_blocks.solve(at)
    u, sigma = result.displacement.values[..., 0], result.stress.values
    f = load_history(at).value(result.time.values)
    first, last = (p.regular_stiffness * (u[i] - u[i + 1]) for i in (0, 2))
    expected = np.array([f, (f + first) / 2, first, last / 2, 0 * f])
    assert np.abs(sigma - expected).max() < 1e-7 * 1e6


def test_the_state_matrix_has_the_closed_form_s_frequencies_and_decay(scene):
    """omega_n = 2 sqrt(k/m) sin(n pi / 2N), decay eta omega_n^2 / 2."""
    at = scene(joints={"damping_ratio": 0.02})
    p = calibrate(at)
    eta = p.time_constant
    omega = leapfrog.frequencies(p.regular_stiffness * p.area, p.block_mass, 100)
    roots = np.linalg.eigvals(system_of(at).matrix.toarray())
    found = roots[roots.imag > 1e-3 * omega[1]]
    found = found[np.argsort(np.abs(found))]
    ratio = eta * omega[1:] / 2
    expected = omega[1:] * (-ratio + 1j * np.sqrt(1 - ratio**2))
    assert np.abs(found / expected - 1).max() < 1e-9


@pytest.mark.parametrize("zeta", [0.02, 1.5])
def test_the_modes_under_a_sine_agree(scene, misfit, zeta):
    """u_j = sum_n phi_n(j) phi_n(1) q_n A / m_n with q_n in closed form; round-off of 100 modes."""
    at = scene(
        joints={"damping_ratio": zeta}, record={"velocity": [0.25 + 0.5 * j for j in (0, 39, 99)]}
    )
    p, load, times = calibrate(at), load_history(at), sample_times(at)
    omega = leapfrog.frequencies(p.regular_stiffness * p.area, p.block_mass, 100)
    shapes = np.cos(np.outer(np.arange(100) + 0.5, np.arange(100)) * np.pi / 100)
    q, _ = modes.sums(np.eye(99), omega[1:], p.time_constant, load, times)
    q = np.array([load.double_impulse(times), *q])
    weights = p.area * shapes[0] / (p.block_mass * (shapes**2).sum(axis=0))
    expected = shapes[[0, 39, 99]] @ (weights[:, None] * q)
    assert misfit(row_of_blocks.solve(at).displacement.values[..., 0], expected) < 1e-10


@pytest.mark.parametrize(
    "period, percent, digit", [(5e-3, 78, 1), (1e-2, 17.9, 0.1), (2e-2, 5, 0.1)]
)
def test_the_chain_is_as_far_off_the_homogenised_bar_as_its_dispersion(
    scene, misfit, period, percent, digit
):
    """78 % at T = 5 ms, 17.9 % at 10 ms, 5.0 % at 20 ms, to half a unit of the last digit."""
    at = scene(load={"period": period})
    off = 100 * misfit(row_of_blocks.solve(at), images.solve(at))
    assert off == pytest.approx(percent, abs=digit / 2)


def test_the_chain_is_nearer_the_bar_with_its_joints_resolved(scene, misfit):
    """With the joints resolved 4.0 % are left at T = 10 ms."""
    at = scene()
    assert 100 * misfit(row_of_blocks.solve(at), JOINTED.run(at)) == pytest.approx(4.0, abs=0.05)
