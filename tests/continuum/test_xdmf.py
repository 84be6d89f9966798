"""Snapshots written by dolfinx are what dolfinx and PETSc read back."""

import numpy as np
import pytest
from mpi4py import MPI

from jointwave.cases.gmsh_file import FROM_GMSH
from jointwave.continuum import simulate, write_xdmf
from jointwave.continuum.space.compat import cell_corners, input_cells
from jointwave.continuum.space.fenicsx import PETSc, dolfinx
from jointwave.results.snapshots import snapshots_of
from tests.continuum.test_snapshots import PUSH, SLANTED, STEEP


def read_function(path, name, count):
    """Return the values of a function at one time, float array [count, n]."""
    file = PETSc.Viewer().createHDF5(str(path.with_suffix(".h5")), "r", comm=PETSc.COMM_SELF)
    values = PETSc.Vec().create(PETSc.COMM_SELF)
    values.setName(f"Function/{name}")
    values.load(file)
    return np.real(values.array).reshape(count, -1)


def written(path, s, names, time):
    """Return for each cell of the file its corners, and there displacement and velocity; its block
    and stresses: all in a row [cells, n], in order of the middles of cells."""
    with dolfinx.io.XDMFFile(MPI.COMM_SELF, str(path), "r") as file:
        mesh = file.read_mesh(name="mesh")
    corners, row = cell_corners(mesh), input_cells(mesh)
    geometry = mesh.geometry
    table = geometry.dofmaps[0] if hasattr(geometry, "dofmaps") else geometry.dofmap
    table = np.asarray(getattr(table, "array", table)).reshape(len(row), -1)
    place = np.asarray(geometry.input_global_indices)[table]
    parts = [corners]
    parts += [
        read_function(path, f"{one}/{time}", len(s.points))[place]
        for one in ("displacement", "velocity")
    ]
    parts += [read_function(path, f"{one}/{time}", len(row))[row] for one in names]
    parts.append(read_function(path, "block/0", len(row))[row])
    return in_order(parts)


def in_order(parts):
    """Return arrays [cells, ...] as rows in the order of the last part, the block, and then of the
    middles of cells."""
    middle = parts[0].mean(axis=1).round(9)
    order = np.lexsort((*middle.T, parts[-1].ravel()))
    return np.concatenate([one.reshape(len(order), -1)[order] for one in parts], axis=1)


@pytest.mark.parametrize("dim", [1, 2, 3])
def test_what_is_written_reads_back(dim, rock_mass, pillar, tmp_path):
    if dim == 1:
        scene = pillar(time__duration=2e-3, record__fields=1e-3, load__amplitude=1e6)
    else:
        record = {"points": [], "interval": 1e-4, "fields": 1e-3}
        joint, push = (STEEP, SLANTED)[dim - 2], [PUSH]
        scene = rock_mass(joint, dim=dim, record=record, loads=push)
    result = simulate(scene)
    path = write_xdmf(tmp_path / "fields.xdmf", result)
    s, last = snapshots_of(result), len(result["field_time"]) - 1
    names = ["axial stress"]
    if dim > 1:
        names = [f"stress {one}" for one in result["stress_component"].values]
    cells = s.cells[:, FROM_GMSH[{1: "interval", 2: "triangle", 3: "tetrahedron"}[dim]]]
    stress = s.stress[last].reshape(len(cells), -1)
    moved = s.displacement[last][cells], s.velocity[last][cells]
    expected = in_order([s.points[cells], *moved, stress, s.block[:, None]])
    text = f"{s.time[last]:.16g}".replace(".", "_")
    assert np.abs(s.velocity[last]).max() > 0 and np.ptp(s.block) > 0
    found = written(path, s, names, text)
    assert found.shape == expected.shape
    np.testing.assert_allclose(found, expected, rtol=1e-12, atol=1e-14)


def test_a_result_without_snapshots_is_refused(pillar, tmp_path):
    result = simulate(pillar(time__duration=1e-3))
    with pytest.raises(ValueError, match="has no snapshots"):
        write_xdmf(tmp_path / "fields.xdmf", result)
