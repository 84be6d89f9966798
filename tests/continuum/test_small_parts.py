"""Small parts of the continuum, by numbers worked out by hand."""

import logging
from math import sqrt

import numpy as np
import pytest
from scipy.sparse import csr_matrix

from jointwave.cases.material.calibrate import calibrate
from jointwave.continuum.explicit.critical import critical_step
from jointwave.continuum.joints import RIGID, resolved_joints
from jointwave.continuum.space import basix_versions
from jointwave.continuum.space.nodes import levels


def test_critical_step_of_one_freedom():
    """omega = 3: 2/3 s. With a dashpot of C / M = 2: 9 dt^2 + 8 dt = 4, 2 (sqrt(13) - 2) / 9 s."""
    k, c = csr_matrix([[9.0]]), csr_matrix([[2.0]])
    assert critical_step(k, None, np.ones(1)) == pytest.approx(2 / 3, rel=1e-15)
    damped = 2 * (sqrt(13) - 2) / 9
    assert critical_step(k, c, np.ones(1)) == pytest.approx(damped, rel=1e-12)


def test_critical_step_where_dashpots_decide_the_mode():
    """The stiffest freedom is bounded by 2/3 s, the most damped one, 1 + 16 dt = 4 / dt, by less:
    (sqrt(68) - 8) s = 0.2462 s."""
    k, c = csr_matrix(np.diag([9.0, 1.0])), csr_matrix(np.diag([0.0, 4.0]))
    assert critical_step(k, c, np.ones(2)) == pytest.approx(sqrt(68) - 8, rel=1e-12)


def test_critical_step_of_modes_that_dashpots_turn():
    """The largest eigenvalue of dt^2 K + 4 dt C is 4, of no mode of either alone; to the square of
    the change of 1e-6 at which the search ends."""
    random = np.random.default_rng(4)
    springs, dashpots = random.standard_normal((2, 6, 6))
    k, c = springs @ springs.T, 0.2 * dashpots @ dashpots.T
    dt = critical_step(csr_matrix(k), csr_matrix(c), np.ones(6))
    largest = np.linalg.eigvalsh(dt**2 * k + 4 * dt * c)[-1]
    assert largest == pytest.approx(4.0, rel=1e-10)


def test_heights_are_numbered_from_zero_upwards():
    """In any order and shape; what differs by less than 1e-9 of the size is one height."""
    y = np.array([[0.5, 0.0], [1.0, 0.5 + 1e-10], [0.0, 0.5 + 1e-8]])
    assert levels(y, 1.0).tolist() == [[1, 0], [3, 1], [0, 2]]


@pytest.mark.parametrize("cell, dim", [("interval", 1), ("triangle", 2), ("hexahedron", 3)])
def test_no_points_have_no_values(cell, dim):
    basis, gradient = basix_versions.tabulate(cell, 2, np.zeros((0, dim)))
    nodes = len(basix_versions.reference_element(cell, 2).points)
    assert basis.shape == (0, nodes) and gradient.shape == (0, nodes, dim)


def test_layer_in_homogenised_rock_has_what_it_yields_more_than_a_joint(pillar):
    """1 / K_n - 1 / K_regular along, K_n = 4e8 Pa / 0.5 m, and alike across, of the joints without
    the rock between; where it yields like the others, ten times a joint with its block."""
    layers = [
        {"y": 10.0, "spacing_stiffness": 4e8, "shear_stiffness": 5e8},
        {"y": 20.0, "shear_stiffness": 5e8},
        {"y": 30.0, "cohesion": 1e5},
    ]
    scene = pillar(soft_layers=layers, motion__rotation="none", load__direction=[0.6, 0.8, 0.0])
    p = calibrate(scene)
    normal, shear = p.regular_stiffness, p.regular_shear_stiffness
    found, first = resolved_joints(p, "equivalent", True), [19, 39, 59]
    assert found.number.tolist() == first
    softer = 1 / (1 / 8e8 - 1 / p.regular_own_stiffness)
    assert found.stiffness[first] == pytest.approx([softer, RIGID * normal, RIGID * normal])
    softer = 1 / (1 / 5e8 - 1 / p.regular_own_shear_stiffness)
    assert found.shear_stiffness[first] == pytest.approx([softer, softer, RIGID * shear])
    # Along the axis alone the second one is like the others, and the third cannot slide.
    assert resolved_joints(p, "equivalent", False).number.tolist() == [19]
    assert resolved_joints(p, "equivalent", True, meshed=(19,)).number.tolist() == [39, 59]


def test_the_form_compiler_leaves_logging_as_it_was():
    """Its handlers and its level are taken away again, and what it reports is hidden meanwhile."""
    pytest.importorskip("dolfinx")
    from jointwave.continuum.space.dolfinx_export import quiet_logging

    root, was = logging.getLogger(), logging.root.manager.disable
    before = list(root.handlers), root.level
    logging.disable(5)
    try:
        with pytest.raises(RuntimeError), quiet_logging():
            hidden = not root.isEnabledFor(logging.INFO) and root.isEnabledFor(logging.WARNING)
            root.addHandler(logging.NullHandler())
            root.setLevel(before[1] + 1)
            raise RuntimeError
        assert hidden and (list(root.handlers), root.level) == before
        assert logging.root.manager.disable == 5
    finally:
        logging.disable(was)
