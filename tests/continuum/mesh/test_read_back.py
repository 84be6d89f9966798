"""A mesh that is written as a gmsh file reads back."""

import numpy as np
import pytest

from jointwave.cases.material.calibrate import calibrate
from jointwave.continuum.mesh.given import given_mesh
from jointwave.continuum.mesh.pillar import pillar_mesh

KINDS = [(2, "hexahedron"), (2, "simplex"), (3, "hexahedron"), (3, "simplex")]


@pytest.mark.parametrize(("dim", "cell"), KINDS)
def test_round_trip(dim, cell, column, exported, capfd):
    scene = column(6)
    p = calibrate(scene)
    mesh = pillar_mesh(p, dim, cell, 2, 2, np.array([0, 1, 3]))
    again = given_mesh(exported(mesh), scene, p, dim)
    assert again.cell == mesh.cell
    # Parts stand once each and along y in the file.
    assert len(again.parts) == sum(part.copies for part in mesh.parts)
    for one, other in zip(heights(mesh), heights(again), strict=True):
        assert other == pytest.approx(one, abs=1e-15)
    assert (again.joints.joint == mesh.joints.joint).all()
    assert _places(again.joints.corners) == _places(mesh.joints.corners)
    for side, back in ((mesh.start, again.start), (mesh.end, again.end)):
        assert _places(back.corners) == _places(side.corners)
    assert capfd.readouterr() == ("", "")


def heights(mesh):
    """Return where along the pillar the middle of each cell is."""
    found = [p.shifts[:, None, 1] + p.x[p.cells].mean(axis=1)[:, 1] for p in mesh.parts]
    return np.sort(np.concatenate([y.ravel() for y in found]))


def _places(corners):
    return sorted(map(tuple, np.round(corners.mean(axis=1), 12) + 0.0))
