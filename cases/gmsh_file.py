"""Read gmsh files (vertices, rock cells, facets of named groups) and VTU files."""

from contextlib import redirect_stderr
from io import StringIO
from pathlib import Path
from typing import NamedTuple
from warnings import catch_warnings, simplefilter

import numpy as np

from jointwave.cases.size import memory, require, within

#: How to install gmsh and the system libraries that its wheel loads.
INSTALL = (
    "pip install gmsh; on Debian also apt install libglu1-mesa libxcursor1 libxft2 libxinerama1"
)

#: Cell types by meshio's names, and meshio's names of their facets.
KINDS = {
    "triangle": "triangle",
    "quad": "quadrilateral",
    "tetra": "tetrahedron",
    "hexahedron": "hexahedron",
}
FACET_NAMES = {
    "triangle": "line",
    "quadrilateral": "line",
    "tetrahedron": "triangle",
    "hexahedron": "quad",
}

#: gmsh numbers corners around a face: gmsh's corner for each basix corner, and the reverse.
FROM_GMSH = {
    "interval": [0, 1],
    "triangle": [0, 1, 2],
    "quadrilateral": [0, 1, 3, 2],
    "tetrahedron": [0, 1, 2, 3],
    "hexahedron": [0, 1, 3, 2, 4, 5, 7, 6],
}

#: Bytes that reading may allocate: constant, and per byte of the file. The reader makes an array
#: as long as the largest vertex number, whatever the file holds.
ROOM, ROOM_OF_BYTE = 300_000_000, 100

KINDS_OF_FILE = {"gmsh": "a gmsh mesh, version 2.2 or 4.1", "vtu": "a VTU file of VTK"}
SAVE_GROUPS = "save it with Mesh.SaveAll = 0"


class MeshError(ValueError):
    """An error in a gmsh file, in one phrase."""


class Tagged(NamedTuple):
    """The rock of a gmsh file and its named groups of facets.

    x : float array [vertices, 3], m, all vertices of the file.
    kind : cell type: "triangle", "quadrilateral", "tetrahedron" or "hexahedron".
    cells : int array [cells, corners], vertex numbers in basix's corner order.
    facets : for each group "joint...", "start" and "end", int arrays [facets, facet corners] of
        vertex numbers in any order.
    """

    x: np.ndarray
    kind: str
    cells: np.ndarray
    facets: dict[str, np.ndarray]


def read_tagged(path: str | Path) -> Tagged:
    """Read a gmsh file, version 2.2 or 4.1, text or binary. Groups whose names start with "rock",
    in any case, are the rock. Raises MeshError."""
    mesh, _ = read_file(Path(path), "gmsh")
    names = {name: name.strip().lower() for name in mesh.field_data}
    kind, cells = _rock(mesh, [name for name, plain in names.items() if plain.startswith("rock")])
    facets = {
        plain: cells_of_type(mesh, [name], FACET_NAMES[kind])
        for name, plain in names.items()
        if plain.startswith("joint") or plain in ("start", "end")
    }
    empty = [name for name, found in facets.items() if not len(found)]
    if empty:
        raise MeshError(f"its group '{empty[0]}' has no facets ({FACET_NAMES[kind]}s)")
    return Tagged(mesh.points, kind, cells[:, FROM_GMSH[kind]], facets)


def read_file(path: Path, kind: str):
    """Return a file of kind "gmsh" or "vtu" as meshio's mesh, and meshio's messages."""
    import meshio

    if not path.is_file():
        raise MeshError("is not a file" if path.exists() else "does not exist")
    said = StringIO()
    try:
        size = path.stat().st_size
        require(size, "it")
        room = min(ROOM + ROOM_OF_BYTE * size, max(ROOM, memory()))
        with redirect_stderr(said), catch_warnings(), within(room):
            simplefilter("ignore")
            return getattr(meshio, kind).read(path), said.getvalue()
    # A broken file can raise any error in the reader.
    except Exception as error:
        if "gmsh:physical" in one_line(error):
            raise MeshError(f"has cells in no group; {SAVE_GROUPS}") from None
        raise MeshError(f"cannot be read as {KINDS_OF_FILE[kind]}: {one_line(error)}") from None


def one_line(error: Exception) -> str:
    """Return an error's message on one line."""
    return " ".join(str(error).split()) or type(error).__name__


def _rock(mesh, names: list[str]) -> tuple[str, np.ndarray]:
    """Return the cell type and the cells of the rock, in gmsh's corner order."""
    if not names:
        raise MeshError("has no group whose name starts with 'rock'")
    types = {block.type for block, inside in _blocks(mesh, names) if inside.any()}
    if not types:
        raise MeshError(f"its group '{names[0]}' has no cells; {SAVE_GROUPS}")
    if len(types) > 1:
        found = " and ".join(sorted(types))
        raise MeshError(f"its rock has {found} cells, must be of one kind: {', '.join(KINDS)}")
    (name,) = types
    if name not in KINDS:
        raise MeshError(f"its rock has {name} cells, must be first-order {', '.join(KINDS)}")
    cells = cells_of_type(mesh, names, name)
    dim = next(block.dim for block in mesh.cells if block.type == name)
    everything = [block for block in mesh.cells if block.dim == dim]
    others = sum(len(block.data) for block in everything if block.type != name)
    others += len(_distinct([b.data for b in everything if b.type == name])) - len(cells)
    if others:
        raise MeshError(f"{others} of its cells are in no group whose name starts with 'rock'")
    return KINDS[name], cells


def cells_of_type(mesh, names: list[str], cell: str) -> np.ndarray:
    """Return the distinct cells of one type in groups of these names, as vertex numbers."""
    found = [block.data[inside] for block, inside in _blocks(mesh, names) if block.type == cell]
    return _distinct(found) if found else np.empty((0, 1), dtype=np.int64)


def _distinct(found: list[np.ndarray]) -> np.ndarray:
    """Return distinct cells: format version 2 lists a cell once per group."""
    cells = np.concatenate(found).astype(np.int64)
    first = np.unique(np.sort(cells, axis=1), axis=0, return_index=True)[1]
    return cells[np.sort(first)]


def _blocks(mesh, names: list[str]):
    """Yield each block of cells and a mask of its cells in any of these groups."""
    for k, block in enumerate(mesh.cells):
        inside = np.zeros(len(block.data), dtype=bool)
        for name in names:
            tag, dim = mesh.field_data[name]
            if name in mesh.cell_sets:
                inside[mesh.cell_sets[name][k]] = True
            elif dim == block.dim and "gmsh:physical" in mesh.cell_data:
                inside |= mesh.cell_data["gmsh:physical"][k] == tag
        yield block, inside
