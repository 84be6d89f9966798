"""Snapshots: exact stress in every linear cell, what receivers record, and what dolfinx writes of
them, as it reads it back."""

from itertools import pairwise
from types import SimpleNamespace

import numpy as np
import pytest
import xarray as xr
from mpi4py import MPI

from jointwave.cases.gmsh_file import FROM_GMSH
from jointwave.continuum import simulate, write_xdmf
from jointwave.continuum.receivers.snapshots import RockRecorder
from jointwave.continuum.scene import body_of
from jointwave.continuum.space.compat import cell_corners, input_cells
from jointwave.continuum.space.fenicsx import PETSc, dolfinx
from jointwave.results.snapshots import snapshots_of
from jointwave.results.stress import stress_components
from tests.continuum.bodies import PUSH, SHEAR
from tests.continuum.test_patch import STRESS, stressed

FLAT = {"dip": 0.0, "spacing": 1.7}
STEEP = {"dip": -65.0, "spacing": 1.9}
SLANTED = {"dip": 35.0, "dip_direction": 110.0, "spacing": 2.3}
GIVEN = {"xx": 2e6, "yy": 3e6, "xy": 5e5}
DEEP = GIVEN | {"zz": 4e6, "yz": 2e5, "xz": -1e5}
#: Dimension, joint, order, kind, and linear cells in a cell.
CASES = [(2, FLAT, order, "quad", order**2) for order in (1, 3)]
CASES += [(2, STEEP, 1, "triangle", 1), (2, STEEP, 2, "triangle", 4)]
CASES += [(3, FLAT, 2, "hexahedron", 8), (3, SLANTED, 1, "tetra", 1), (3, SLANTED, 2, "tetra", 8)]


def volumes(s):
    """Return the volume of linear cells, positive where corners are in VTK's order."""
    x = s.points[s.cells]
    if s.kind in ("triangle", "quad"):
        rolled = np.roll(x, -1, axis=1)
        return (x[..., 0] * rolled[..., 1] - x[..., 1] * rolled[..., 0]).sum(axis=1) / 2
    tetra = [[0, 1, 2, 3]]
    if s.kind == "hexahedron":  # around one diagonal
        ring = [1, 2, 3, 7, 4, 5, 1]
        tetra = [[0, b, a, 6] for a, b in pairwise(ring)]
    arms = x[:, tetra][:, :, 1:] - x[:, tetra][:, :, :1]
    sign = -1 if s.kind == "hexahedron" else 1
    return sign * np.linalg.det(arms).sum(axis=1) / 6


def snapshot(found, u, v=None):
    """Return the snapshots of a body at rest, and then at displacements u and velocities v."""
    scene, steps = found.scene, SimpleNamespace(last=(0 * u, 0 * u, 0 * u))
    recorder = RockRecorder(scene, found, steps)
    recorder.record_if_due(0)
    steps.last = u, 0 * u if v is None else v, u
    recorder.record_if_due(recorder.every)
    time = np.arange(recorder.every + 1) * scene.interval
    empty = xr.Dataset(coords={"time": time})
    return snapshots_of(recorder.add_to(empty))


@pytest.mark.parametrize(("dim", "joint", "order", "kind", "parts"), CASES)
def test_uniform_stress_is_that_of_every_linear_cell(rock_mass, dim, joint, order, kind, parts):
    given = GIVEN if dim == 2 else DEEP
    record = {"points": [], "interval": 1e-4, "fields": 1e-4}
    continuum = {"order": order, "size": 1.7}
    scene = rock_mass(joint, dim=dim, continuum=continuum, prestress=given, record=record)
    found = body_of(scene)
    s = snapshot(found, stressed(found, STRESS[:dim, :dim]))
    expected = scene.prestress.tensor - STRESS[:dim, :dim]
    pairs = stress_components(dim).values()
    assert s.kind == kind
    assert len(s.cells) == parts * len(found.body.block)
    assert np.allclose(s.stress[1], [expected[i, j] for i, j in pairs], rtol=0, atol=1e-2)
    size = volumes(s)
    assert size.min() > 0
    own = np.bincount(s.block, size)
    assert np.allclose(own, found.blocks.volume, rtol=1e-12)


@pytest.mark.parametrize("order", [1, 2])
def test_rock_that_is_whole_across_periodic_sides_is_shown_within_them(rock_mass, order):
    """Slabs under shear: u_x = y."""
    record = {"points": [], "fields": 1e-4}
    sides = {"left": "periodic", "right": "periodic"}
    continuum = {"cell": "triangle", "order": order}
    scene = rock_mass(FLAT, continuum=continuum, boundaries=sides, record=record)
    found = body_of(scene)
    assert found.body.tied is not None
    s = snapshot(found, (found.body.x[:, [1]] * [1.0, 0.0]).ravel())
    assert np.allclose(s.stress[1], [0.0, 0.0, -SHEAR], rtol=0, atol=1e-9 * SHEAR)
    assert np.allclose(s.displacement[1, :, 0], s.points[:, 1], rtol=0, atol=1e-12)
    assert volumes(s).min() > 0 and np.isclose(volumes(s).sum(), 24.0, rtol=1e-12)


def test_dashpots_of_the_rock_carry_stress(rock_mass):
    """As much as the strain of a time constant."""
    keys = {"rayleigh": {"frequencies": [100.0, 500.0], "ratios": [0.01, 0.05]}}
    found = body_of(rock_mass(record={"points": [], "fields": 1e-4}, damping=keys))
    eta, u = found.materials[-1].time_constant, (found.body.x @ STRESS[:2, :2]).ravel()
    assert eta > 0
    one, other = snapshot(found, u), snapshot(found, 0 * u, u / eta)
    np.testing.assert_allclose(other.stress, one.stress, rtol=1e-12)


@pytest.mark.parametrize(
    ("dim", "cell", "kind"),
    [(1, "hexahedron", "line"), (2, "hexahedron", "quad"), (3, "simplex", "tetra")],
)
def test_a_pillar_has_the_stress_along_it(pillar, dim, cell, kind):
    """Rock that shortens along y alone."""
    scene = pillar(
        pillar__length=2.0,
        rock__intact_modulus=5e10,
        numerics__continuum={"dim": dim, "cell": cell, "elements_per_block": 2},
        record={"velocity": [0.0], "fields": 1e-4},
        prestress={"normal": 1e6},
    )
    found, along = body_of(scene), dim // 2
    u = np.zeros((len(found.body.x), found.body.components))
    u[:, along] = -1e-5 * found.body.x[:, along]
    s = snapshot(found, u.ravel())
    k = 0 if dim == 1 else 1
    expected = 1e6 + 1e-5 * found.materials[0].stiffness[k, k]
    assert s.kind == kind
    assert np.allclose(s.stress[1], expected, rtol=1e-10)
    assert np.allclose(s.displacement[1, :, 1], -1e-5 * s.points[:, 1], rtol=0, atol=1e-18)
    middle = s.points[s.cells, 1].mean(axis=1)
    assert np.array_equal(s.block, middle // scene.pillar.block)


@pytest.mark.parametrize("scheme", ["explicit", "implicit"])
def test_snapshots_are_what_receivers_record(rock_mass, scheme):
    """At corners, to the last digits; samples are the same bit for bit as without snapshots."""
    joint = {"dip": 0.0, "through": [3.0, 2.0], "friction_angle": 30.0}
    record = {"points": [[0.0, 4.0], [6.0, 0.0]], "interval": 2e-5}
    table = {"loads": [PUSH], "boundaries": {"left": "quiet"}}
    table["continuum"] = {"scheme": scheme, "order": 2, "steps_per_period": 50}
    scene = rock_mass(joint, **table, record=record | {"fields": 1.6e-4})
    found, plain = simulate(scene), simulate(rock_mass(joint, **table, record=record))
    for name in ("velocity", "displacement", "stress", "energy"):
        np.testing.assert_array_equal(found[name], plain[name], err_msg=name)
    s = snapshots_of(found)
    np.testing.assert_array_equal(s.time, found.time.values[::8])
    assert not s.displacement[0].any()
    for k, place in enumerate(scene.record.points):
        (node,) = np.flatnonzero(np.abs(s.points[:, :2] - place).max(axis=1) < 1e-9)
        for name in ("velocity", "displacement"):
            known = found[name].values[k, ::8]
            away = np.abs(getattr(s, name)[:, node, :2] - known).max()
            assert away < 1e-12 * np.abs(known).max()


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
        joint = (STEEP, SLANTED)[dim - 2]
        scene = rock_mass(joint, dim=dim, record=record, loads=[PUSH])
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
