"""Mesh, stiffness, mass, jump and receivers of the bar against what each must reproduce exactly."""

import numpy as np
import pytest
import ufl
from scipy.linalg import eigh
from scipy.sparse.csgraph import connected_components

from continuum import compat
from continuum.elasticity import discretise, mass_form
from continuum.interface import jump_operator
from continuum.mesh import Grid, create, elements_in_block
from continuum.receivers import points, sections

ORDERS = [1, 2, 3, 4]


def grid(elements: int = 6, length: float = 3.0, cuts: tuple[int, ...] = ()) -> Grid:
    cut = np.zeros(elements - 1, dtype=bool)
    cut[list(cuts)] = True
    return Grid(length / elements * np.arange(elements + 1), cut)


@pytest.mark.parametrize("order", ORDERS)
def test_pieces_between_cuts_are_disconnected(order):
    bar = discretise(grid(cuts=(1, 2)), order)
    pieces, label = connected_components(bar.stiffness)
    assert pieces == 3
    assert bar.y.size == 6 * order + 3
    assert (np.diff(bar.y) >= 0).all() and (np.diff(label) >= 0).all()


@pytest.mark.parametrize("order", ORDERS)
def test_gap_is_exact_for_any_motion_linear_in_each_piece(order):
    bar = discretise(grid(cuts=(1, 2)), order)
    _, piece = connected_components(bar.stiffness)
    shift, strain = np.array([0.3, -0.2, 0.7]), np.array([0.1, 0.5, -0.4])
    u = shift[piece] + strain[piece] * bar.y
    y = bar.grid.edges[[2, 3]]
    expected = np.diff(shift) + np.diff(strain) * y
    assert jump_operator(bar) @ u == pytest.approx(expected, abs=1e-15)


@pytest.mark.parametrize("order", ORDERS)
def test_no_gap_opens_when_all_pieces_move_together(order):
    bar = discretise(grid(cuts=(1, 2)), order)
    assert (jump_operator(bar) @ np.ones(bar.y.size) == 0).all()


@pytest.mark.parametrize("order", ORDERS)
def test_mass_is_the_diagonal_of_the_matrix_and_adds_up_to_the_length(order):
    space = compat.lagrange_space(create(grid(cuts=(1,))), order)
    u, w = ufl.TrialFunction(space), ufl.TestFunction(space)
    rule = {"quadrature_rule": "GLL", "quadrature_degree": max(2 * order - 1, 1)}
    matrix = compat.matrix(u * w * ufl.dx(metadata=rule)).toarray()
    mass = compat.vector(mass_form(space, order))
    assert np.abs(matrix - np.diag(mass)).max() < 1e-15
    assert (mass > 0).all()
    assert mass.sum() == pytest.approx(3.0, rel=1e-15)


@pytest.mark.parametrize("order", ORDERS)
def test_uniform_strain_is_in_equilibrium(order):
    bar = discretise(grid(), order)
    force = bar.stiffness @ (0.5 + 2.0 * bar.y)
    expected = np.zeros(bar.y.size)
    expected[[0, -1]] = -2.0, 2.0
    assert np.abs(force - expected).max() < 1e-12
    assert np.abs(bar.stiffness - bar.stiffness.T).max() < 1e-13


@pytest.mark.parametrize("order", ORDERS)
def test_frequencies_converge_at_twice_the_order(order):
    """Lumped by GLL quadrature, omega converges at 2p (Cohen, Higher-Order Numerical Methods for
    Transient Wave Equations, 2002); the second free mode of a bar of length 3 is 2 pi / 3."""
    errors = []
    for elements in (4, 8):
        bar = discretise(grid(elements), order)
        values = eigh(bar.stiffness.toarray(), np.diag(bar.mass), eigvals_only=True)
        errors.append(abs(np.sqrt(values[2]) - 2 * np.pi / 3))
    assert np.log2(errors[0] / errors[1]) == pytest.approx(2 * order, abs=0.25)


@pytest.mark.parametrize("order", ORDERS)
def test_points_read_polynomials_exactly_and_the_mean_on_a_joint(order):
    bar = discretise(grid(cuts=(1,)), order)
    places = [0.0, 0.31, 1.0, 1.5, 3.0]
    right = bar.y >= 1.0
    right[bar.elements[1, -1]] = False
    read = points(bar, places) @ (bar.y**order + 1.0 * right)
    assert read == pytest.approx(
        np.array(places) ** order + [0, 0, 0.5, 1, 1], rel=1e-12, abs=1e-12
    )


@pytest.mark.parametrize("order", ORDERS)
def test_section_force_of_a_bar_pushed_at_one_end_falls_linearly(order):
    """A free bar under a constant end force F accelerates as a whole; force(y) = F (1 - y / L)."""
    bar, force = discretise(grid(), order), 5.0
    push = np.zeros(bar.y.size)
    push[0] = force
    acceleration = np.full(bar.y.size, force / 3.0)
    u = np.linalg.lstsq(bar.stiffness.toarray(), push - bar.mass * acceleration, rcond=None)[0]
    places = np.array([0.0, 0.2, 0.5, 1.37, 2.0, 3.0])
    read = sections(bar, places.tolist())
    stress = read.elastic @ u + read.inertia @ acceleration
    assert stress == pytest.approx(force * (1 - places / 3.0), abs=1e-11)


def test_elements_are_crossed_within_a_hundredth_of_the_period():
    assert elements_in_block(0.5, 6000.0, 0.01) == 1
    assert elements_in_block(0.5, 1350.0, 0.01) == 4
    assert elements_in_block(0.5, 5000.0, 0.01) == 1
    assert elements_in_block(0.5, 2500.0, 0.01) == 2
    assert elements_in_block(0.5, 1350.0, 0.01, damped=True) == 1
