"""What the tests of meshes share: the pillar's numbers, and exact measures."""

from math import factorial

import numpy as np
import pytest

from jointwave.cases.material.calibrate import calibrate
from jointwave.continuum.mesh.cells import DIMENSION, jacobians
from jointwave.continuum.mesh.description import Mesh


@pytest.fixture
def column(pillar):
    """Return a scene of `blocks` blocks of 0.5 m, 0.4 m wide, with dotted keys changed."""

    def scene(blocks=3, **changes):
        shape = dict(pillar__length=0.5 * blocks, pillar__side=0.4, pillar__block=0.5)
        places = dict(soft_layers=[], record__stress=[0.5], record__velocity=[0.25])
        return pillar(**(shape | places | changes))

    return scene


@pytest.fixture
def properties(column):
    """Return the numbers of such a scene."""
    return lambda blocks=3, **changes: calibrate(column(blocks, **changes))


@pytest.fixture
def volumes():
    """Return a function: the volume of each cell of a part, exact for parallelepipeds, m^dim."""

    def of(mesh: Mesh, part):
        simplex = mesh.cell in ("triangle", "tetrahedron")
        mean = jacobians(mesh.cell, part.x, part.cells).mean(axis=1)
        return mean / (factorial(DIMENSION[mesh.cell]) if simplex else 1)

    return of


@pytest.fixture
def areas():
    """Return a function: the area of facets by their corners, exact for parallelograms."""

    def of(corners: np.ndarray) -> np.ndarray:
        count, dim = corners.shape[1:]
        if dim == 1:
            return np.ones(len(corners))
        one, other = corners[:, 1] - corners[:, 0], corners[:, -1] - corners[:, 0]
        if dim == 2:
            return np.linalg.norm(one, axis=1)
        if count == 4:  # in tensor order the last corner is opposite to the first
            other = corners[:, 2] - corners[:, 0]
        return np.linalg.norm(np.cross(one, other), axis=1) / (2 if count == 3 else 1)

    return of
