"""Snapshots as files that ParaView opens: a .pvd of VTK files by meshio.

The points are those of the unloaded pillar; the filter "Warp By Vector" shows its motion.
"""

from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import meshio

from jointwave.compare.runs.output import refuse_foreign, write
from jointwave.results.snapshots import Snapshots


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
            cell_data: dict[str, Any] = {"block": [s.block]}
            if s.stress is not None:
                cell_data["stress"] = [s.stress[i]]
            vectors = {"displacement": s.displacement[i], "velocity": s.velocity[i]}
            meshio.Mesh(s.points, [(s.kind, s.cells)], vectors, cell_data).write(new / name)

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
