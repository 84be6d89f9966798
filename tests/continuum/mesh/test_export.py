"""What is written reads back: in our reader, and in gmsh itself."""

import numpy as np
import pytest

from cases.errors import SceneError
from cases.material.calibrate import calibrate
from continuum.mesh.export import export, whole_part
from continuum.mesh.given import given_mesh
from continuum.mesh.pillar import pillar_mesh
from continuum.mesh.session import gmsh_session

KINDS = [(2, "hexahedron"), (2, "simplex"), (3, "hexahedron"), (3, "simplex")]


@pytest.mark.parametrize(("dim", "cell"), KINDS)
def test_round_trip(dim, cell, column, tmp_path, capfd):
    scene = column(6)
    p = calibrate(scene)
    mesh = pillar_mesh(p, dim, cell, 2, 2, np.array([0, 1, 3]))
    export(mesh, tmp_path / "pillar.msh")
    again = given_mesh(tmp_path / "pillar.msh", scene, p, dim)
    assert again.cell == mesh.cell
    # Parts stand once each and along y in the file.
    assert len(again.parts) == sum(part.copies for part in mesh.parts)
    one, other = whole_part(mesh), whole_part(again)
    for middle in (np.sort(part.x[part.cells].mean(axis=1)[:, 1]) for part in (one, other)):
        assert middle == pytest.approx(np.sort(one.x[one.cells].mean(axis=1)[:, 1]), abs=1e-15)
    assert (again.joints.joint == mesh.joints.joint).all()
    assert _places(again.joints.corners) == _places(mesh.joints.corners)
    for side, back in ((mesh.start, again.start), (mesh.end, again.end)):
        assert _places(back.corners) == _places(side.corners)
    assert capfd.readouterr() == ("", "")


def _places(corners):
    return sorted(map(tuple, np.round(corners.mean(axis=1), 12) + 0.0))


@pytest.mark.parametrize(("dim", "cell"), KINDS)
def test_gmsh_reads_the_groups(dim, cell, properties, tmp_path):
    mesh = pillar_mesh(properties(4), dim, cell, 2, 2, np.array([0, 2]), {1: 0.1})
    export(mesh, tmp_path / "pillar.msh")
    with gmsh_session() as gmsh:
        gmsh.open(str(tmp_path / "pillar.msh"))
        groups = gmsh.model.getPhysicalGroups()
        names = {gmsh.model.getPhysicalName(*group): group[0] for group in groups}
        rock = gmsh.model.mesh.getElements(dim)[1]
    d = dim - 1
    assert names == {"rock": dim, "layer 1": dim, "joint 0": d, "joint 2": d, "start": d, "end": d}
    assert sum(map(len, rock)) == sum(part.copies * len(part.cells) for part in mesh.parts)


def test_a_mesh_with_layers_does_not_read_back_as_rock(column, tmp_path):
    scene = column(4)
    p = calibrate(scene)
    mesh = pillar_mesh(p, 2, "hexahedron", 1, 1, np.array([0, 2]), {1: 0.1})
    export(mesh, tmp_path / "pillar.msh")
    with pytest.raises(SceneError, match="1 of its cells are in no group whose name starts"):
        given_mesh(tmp_path / "pillar.msh", scene, p)
