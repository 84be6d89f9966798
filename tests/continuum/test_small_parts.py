"""Small parts of the continuum, by numbers worked out by hand."""

import logging
from math import sqrt

import numpy as np
import pytest
from scipy.sparse import csr_matrix

from jointwave.continuum.explicit.critical import critical_step


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
