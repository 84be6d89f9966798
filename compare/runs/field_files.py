"""Snapshots as files that ParaView opens: a .pvd of VTK files by meshio, or VTX by dolfinx.

The points are those of the unloaded pillar; the filter "Warp By Vector" shows its motion.
"""

from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import meshio
import numpy as np

from jointwave.cases.errors import SceneError
from jointwave.compare.runs.output import refuse_foreign, write
from jointwave.results.snapshots import Snapshots

#: From VTK's order of corners to dolfinx's tensor-product order.
TENSOR_ORDER = {"quad": [0, 1, 3, 2], "hexahedron": [0, 1, 3, 2, 4, 5, 7, 6]}
CELLS = {"line": "interval", "quad": "quadrilateral", "tetra": "tetrahedron"}


def write_pvd(path: Path, s: Snapshots) -> Path:
    """Write NAME.pvd at `path`, and beside it NAME-fields/0000.vtu, ..., one per instant.

    Point data: displacement (m), velocity (m/s). Cell data: block, stress (Pa) where known.
    """
    refuse_foreign(path, (b"<?xml",))
    folder = path.with_name(f"{path.stem}-fields")
    names = [f"{i:04d}.vtu" for i in range(len(s.time))]

    def save(new: Path) -> None:
        new.mkdir()
        for i, name in enumerate(names):
            _mesh(s, i).write(new / name)

    write(folder, save)
    root = ElementTree.Element("VTKFile", type="Collection", version="0.1")
    collection = ElementTree.SubElement(root, "Collection")
    for time, name in zip(s.time.tolist(), names, strict=True):
        ElementTree.SubElement(
            collection, "DataSet", timestep=repr(time), file=f"{folder.name}/{name}"
        )
    tree = ElementTree.ElementTree(root)
    ElementTree.indent(tree)
    return write(path, lambda file: tree.write(file, encoding="utf-8", xml_declaration=True))


def _mesh(s: Snapshots, i: int) -> meshio.Mesh:
    cell_data: dict[str, Any] = {"block": [s.block]}
    if s.stress is not None:
        cell_data["stress"] = [s.stress[i]]
    vectors = {"displacement": s.displacement[i], "velocity": s.velocity[i]}
    return meshio.Mesh(s.points, [(s.kind, s.cells)], vectors, cell_data)


def read_pvd(path: Path) -> Snapshots:
    """Return the snapshots written by `write_pvd`."""
    sets = ElementTree.parse(path).getroot().iter("DataSet")
    files = {float(s.attrib["timestep"]): path.parent / s.attrib["file"] for s in sets}
    meshes = [meshio.read(file) for file in files.values()]
    (block,) = meshes[0].cells
    cell_data = meshes[0].cell_data
    return Snapshots(
        np.array(list(files)),
        meshes[0].points,
        block.type,
        block.data,
        cell_data["block"][0],
        np.stack([mesh.point_data["displacement"] for mesh in meshes]),
        np.stack([mesh.point_data["velocity"] for mesh in meshes]),
        np.stack([m.cell_data["stress"][0] for m in meshes]) if "stress" in cell_data else None,
    )


def refuse_vtx() -> None:
    """Raise SceneError if VTX files cannot be written."""
    try:
        from jointwave.continuum.space import dolfinx_export
    except ImportError as error:
        raise SceneError("--vtx", "", None, f"dolfinx cannot be imported ({error})") from None
    if dolfinx_export.vtx_writer() is None:
        allowed = "this dolfinx was built without ADIOS2; the .pvd file needs neither"
        raise SceneError("--vtx", "", None, allowed)


def write_vtx(path: Path, s: Snapshots) -> Path:
    """Write displacement (m) and velocity (m/s) of all instants as one ADIOS2 file, NAME.bp."""
    from jointwave.continuum.space import dolfinx_export

    displacement, velocity, at, nodes = _functions(s)

    def save(new: Path) -> None:
        with dolfinx_export.vtx_writer()(
            dolfinx_export.MPI.COMM_SELF, str(new), [displacement, velocity]
        ) as file:
            for i, time in enumerate(s.time.tolist()):
                displacement.x.array.reshape(-1, 3)[at] = s.displacement[i, nodes]
                velocity.x.array.reshape(-1, 3)[at] = s.velocity[i, nodes]
                file.write(time)

    return write(path, save)


def _functions(s: Snapshots) -> tuple[Any, Any, np.ndarray, np.ndarray]:
    """Return dolfinx functions for displacement and velocity, and the indices of their values
    [cells, corners] with those of the corresponding nodes [cells, corners]."""
    from jointwave.continuum.space import dolfinx_export

    cells = s.cells[:, TENSOR_ORDER.get(s.kind, slice(None))].astype(np.int64)
    domain = dolfinx_export.cell_mesh(CELLS.get(s.kind, s.kind), cells, s.points)
    space = dolfinx_export.lagrange_space(domain, 1, 3)
    functions = [dolfinx_export.fem.Function(space, dtype=np.float64) for _ in range(2)]
    for function, name in zip(functions, ("displacement", "velocity"), strict=True):
        function.name = name
    return *functions, dolfinx_export.cell_nodes(space), cells[dolfinx_export.input_cells(domain)]
