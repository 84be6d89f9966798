"""Field files as a viewer meets them: read back by meshio, whole or not there at all."""

import json
from xml.etree import ElementTree

import meshio
import numpy as np
import pytest
import xarray as xr

from jointwave.compare.runs.output import write_pvd
from jointwave.results.snapshots import Snapshots, snapshots, snapshots_of

BOX = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]]
#: One cell of each kind: name to its corners in VTK's order.
CELLS = {
    "line": [[0, 0, 0], [0, 1, 0]],
    "triangle": BOX[:2] + BOX[3:4],
    "quad": BOX[:4],
    "tetra": [BOX[i] for i in (0, 1, 3, 4)],
    "hexahedron": BOX,
}


def two_cells(kind):
    """Return snapshots of two cells of a kind, a joint between them, at three instants."""
    one, draw = np.array(CELLS[kind], dtype=float), np.random.default_rng(7).normal
    points = np.concatenate([one, one + np.array([0.0, 1.0, 0.0])])
    times, cells = np.array([0.0, 0.1, 0.30000000000000004]), np.arange(len(points)).reshape(2, -1)
    motion = draw(size=(3, *points.shape)), draw(size=(3, *points.shape))
    return snapshots(times, points, kind, cells, np.array([0, 1]), *motion, draw(size=(3, 2)))


def read_pvd(path):
    """Return the snapshots of a .pvd."""
    sets = list(ElementTree.parse(path).getroot().iter("DataSet"))
    meshes = [meshio.read(path.parent / s.get("file")) for s in sets]
    (block,), cell_data = meshes[0].cells, meshes[0].cell_data
    return Snapshots(
        np.array([float(s.get("timestep")) for s in sets]),
        meshes[0].points,
        block.type,
        block.data,
        cell_data["block"][0],
        np.stack([mesh.point_data["displacement"] for mesh in meshes]),
        np.stack([mesh.point_data["velocity"] for mesh in meshes]),
        np.stack([m.cell_data["stress"][0] for m in meshes]) if "stress" in cell_data else None,
    )


def assert_equal(one, other):
    for name, values in one._asdict().items():
        np.testing.assert_array_equal(values, getattr(other, name), name)


@pytest.mark.parametrize("kind", CELLS)
def test_files_hold_every_bit(kind, tmp_path):
    found = two_cells(kind)
    assert_equal(read_pvd(write_pvd(tmp_path / "deep" / "dem.pvd", found)), found)
    bare = read_pvd(write_pvd(tmp_path / "bare.pvd", found._replace(stress=None)))
    assert bare.stress is None


def test_a_second_run_replaces_all_files_of_the_first(tmp_path):
    found = two_cells("quad")
    write_pvd(tmp_path / "dem.pvd", found)
    write_pvd(tmp_path / "dem.pvd", found.since(1))
    assert sorted(p.name for p in tmp_path.iterdir()) == ["dem-fields", "dem.pvd"]
    assert len(list((tmp_path / "dem-fields").iterdir())) == 2
    assert_equal(read_pvd(tmp_path / "dem.pvd"), found.since(1))


def test_a_failed_write_leaves_the_old_files_and_no_others(tmp_path, monkeypatch):
    old, whole = two_cells("quad"), meshio.Mesh.write
    path = write_pvd(tmp_path / "dem.pvd", old)

    def fail_at_the_second(mesh, file):
        if file.name == "0001.vtu":
            raise OSError(28, "No space left on device")
        whole(mesh, file)

    monkeypatch.setattr(meshio.Mesh, "write", fail_at_the_second)
    with pytest.raises(OSError, match="No space"):
        write_pvd(path, old._replace(displacement=2 * old.displacement))
    assert_equal(read_pvd(path), old)
    assert sorted(p.name for p in tmp_path.iterdir()) == ["dem-fields", "dem.pvd"]


SCENE = ("run", "guo-li-2002/fig-03", "--set", "time.duration=0.02")
FIELDS = (*SCENE, "--set", "record.fields=4e-3")


def test_run_names_the_file_to_open_for_each_variant(jointwave, tmp_path):
    done = jointwave(*FIELDS, "--out", tmp_path)
    for path in (tmp_path / "dem.pvd", tmp_path / "zeta 0.02" / "dem.pvd"):
        assert str(path) in done.out.replace("\n", "")
        sets = ElementTree.parse(path).getroot().iter("DataSet")
        assert [s.get("file") for s in sets] == [f"dem-fields/000{i}.vtu" for i in range(6)]
        assert read_pvd(path).time == pytest.approx(4e-3 * np.arange(6))
        assert_equal(read_pvd(path), snapshots_of(xr.load_dataset(path.with_suffix(".nc"))))


@pytest.mark.parametrize("asked", [SCENE, FIELDS])
def test_run_writes_fields_where_they_are_asked_for(jointwave, tmp_path, asked):
    (fact,) = json.loads(jointwave(*asked, "--variant", "", "--out", tmp_path, "--json").out)
    assert fact["fields"] == ([] if asked is SCENE else [str(tmp_path / "dem.pvd")])
    assert (tmp_path / "dem-fields").exists() == (asked is FIELDS)


def test_an_exact_solution_says_that_it_has_no_snapshots(jointwave, tmp_path):
    exact = ("--engine", "exact", "--model", "images", "--variant", "")
    assert "no snapshots" in jointwave(*FIELDS, *exact, "--out", tmp_path).out
