"""Shared by the tests of figures: small comparisons by the fast engine and its exact solution."""

import matplotlib
import numpy as np
import pytest

from jointwave.compare.engines import applies, solve
from jointwave.compare.misfit.pairs import Comparison


@pytest.fixture(scope="session")
def compared():
    """Return a function that solves scenes by the rigid blocks, or by the named solvers."""

    def comparisons(*scenes, by=("dem", "lattice")):
        return [
            Comparison(scene, {name: solve(name, scene) for name in by if applies(name, scene)})
            for scene in scenes
        ]

    return comparisons


@pytest.fixture
def ink():
    """Return a function that gives the share of a figure's pixels that are not nearly white."""

    def share(figure):
        figure.canvas.draw()
        image = np.asarray(figure.canvas.buffer_rgba())[..., :3]
        return float((image.min(axis=2) < 230).mean())

    with matplotlib.rc_context():
        yield share
